"""
Do the parameters predict another recording?
============================================

The hardest test of a fit, and the one that counts: the same leg, another movement.
"""

import matplotlib.pyplot as plt

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
profiles = ("multiple-holds", "multi-sine-holds", "scaled-chirp")
figure, rows = plt.subplots(3, 1, figsize=(8, 5), sharex=True, layout="constrained")
for axes, profile in zip(rows, profiles, strict=True):
    trial = recorded(profile, 2)
    prediction = fit.predict(trial)
    print(f"predicts {profile}: VAF {prediction.vaf:.2f} %, RMSE {prediction.rmse:.2f} Nm")
    axes.plot(trial.time, trial.torque, color="0.7", linewidth=3, label="measured")
    axes.plot(trial.time, prediction.torque, color="black", linewidth=0.8, label="predicted")
    axes.set_title(profile, loc="left", fontsize=10)
    axes.set_ylabel("Torque [Nm]")
rows[0].legend(ncols=2, frameon=False, loc="upper right")
rows[-1].set_xlabel("Time [s]")
plt.show()
