"""
What do muscle and tendon do?
=============================

In the muscle-tendon models the muscle's length is a state: the tendon takes a part of every
movement.
"""

import matplotlib.pyplot as plt

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=1)
trial = virtual_trial(
    subject,
    generate(Protocol(profile="multiple-holds", rate_hz=125.0)),
    model="muscle-tendon",
    noise=0.0,
)
state = surae.simulate_tendon("muscle-tendon", subject.truth("muscle-tendon"), trial)

figure, (above, below) = plt.subplots(2, 1, figsize=(8, 4.5), sharex=True, layout="constrained")
above.plot(trial.time, 1e3 * state.muscle_length[0], color="black", label="muscle")
rigid = state.muscle_length[0] + state.elongation[0]
above.plot(trial.time, 1e3 * rigid, color="0.6", linestyle="--", label="on a rigid tendon")
above.set_ylabel("Triceps length [mm]")
above.legend(frameon=False, ncols=2)
below.plot(trial.time, state.tendon_force[0], color="black")
below.set(xlabel="Time [s]", ylabel="Tendon force [N]")
plt.show()
