"""
Does this recording ask for tendons that give way?
==================================================

Rigid and compliant tendons are fitted to everything, and again without each quarter of the
recording, which they have to predict.
"""

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=3)
trajectory = generate(
    Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=64.0, chirp_rate=0.4)
)
for truth in ("muscle", "muscle-tendon"):
    trial = virtual_trial(subject, trajectory, model=truth)
    comparison = surae.compare(trial, ("muscle", "muscle-tendon"), starts=1)
    print(f"A leg of model {truth!r}: {comparison.finding}")
