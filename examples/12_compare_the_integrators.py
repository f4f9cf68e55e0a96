"""
Why is the tendon integrated implicitly?
========================================

The thesis's explicit scheme divides by the active state and chatters where the muscle is hardly
active. Solved implicitly, the same equations are calm at an eighth of its rate.
"""

import matplotlib.pyplot as plt

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=1)
truth = subject.truth("muscle-tendon")
figure, rows = plt.subplots(2, 1, figsize=(8, 4.5), sharex=True, sharey=True, layout="constrained")
for axes, scheme, rate in zip(rows, ("explicit-euler", "implicit"), (1000.0, 125.0), strict=True):
    trial = virtual_trial(
        subject,
        generate(Protocol(profile="multiple-holds", rate_hz=rate)),
        model="muscle-tendon",
        noise=0.0,
    )
    state = surae.simulate_tendon("muscle-tendon", truth, trial, integrator=scheme)
    axes.plot(trial.time, state.muscle_velocity[0], color="black", linewidth=0.6)
    axes.set_title(f"{scheme}, {rate:g} Hz", loc="left", fontsize=10)
    axes.set_ylabel("Speed [m/s]")
rows[1].set_xlabel("Time [s]")
plt.show()
