"""
Has a leg changed?
==================

Two visits of one virtual leg, whose calf is stiffer at the second. A difference is called *changed*
only if it is larger than two measurements of an unchanged leg differ.
"""

from dataclasses import replace

from matplotlib import pyplot

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

slow = generate(Protocol(profile="ramp-and-hold", task="passive", duration=40.0, rate_hz=64.0))
leg = virtual_subject(seed=4)
stiffer = replace(leg, parameters={**leg.parameters, "k_tri": 1.3 * leg.parameters["k_tri"]})
visits = [
    surae.fit(virtual_trial(person, slow, seed=seed), "muscle", prepared=True, starts=2)
    for seed, person in enumerate((leg, stiffer))
]

change = surae.change(*visits, question=("end_stiffness",))
print(change)
print(change.measures["end_stiffness"].verdict)

# %%
# The torque of the relaxed ankle at both visits.
figure, axes = pyplot.subplots(figsize=(7, 4), layout="constrained")
for name, fit in zip(("before", "after"), visits, strict=True):
    inputs = fit.result.problem.inputs[0]
    axes.plot([57.2958 * angle for angle in inputs.angle], inputs.torque, label=name, linewidth=0.8)
axes.set(xlabel="Angle [°], dorsiflexion positive", ylabel="Torque [Nm]")
axes.legend(frameon=False)
