"""
Do the parameters predict another recording?
============================================

The hardest test of a fit, and the one that counts: the same leg, another movement.
"""

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=4)


def recorded(profile: str, seed: int):
    """A trial of the subject."""
    protocol = Protocol(profile=profile, chirp_amplitude=0.1, rate_hz=125.0)
    return virtual_trial(subject, generate(protocol), seed=seed)


fit = surae.fit(recorded("multiple-holds", 1), "muscle", starts=2)
print(f"fitted: VAF {fit.vaf:.2f} %")
for profile in ("multiple-holds", "multi-sine-holds", "scaled-chirp"):
    prediction = fit.predict(recorded(profile, 2))
    print(f"predicts {profile}: VAF {prediction.vaf:.2f} %, RMSE {prediction.rmse:.2f} Nm")
