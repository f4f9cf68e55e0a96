"""
Which movement makes the parameters identifiable?
=================================================

The standard errors that a protocol promises follow from the model's derivatives along it, before
anything is measured: here of the thesis's protocols and of one that was designed, over the same
virtual legs, with the same noise of the torque.
"""

import matplotlib.pyplot as plt

import surae
from surae.protocol import Protocol, generate, named_device

achilles = named_device("achilles")
protocols = {
    name: generate(
        Protocol(profile=name, chirp_amplitude=chirp, duration=35.0, rate_hz=128.0, device=achilles)
    )
    for name, chirp in (("multiple-holds", 0.1), ("multi-sine-holds", 0.2))
}
print(f"{'protocol':18} {'largest':>8} {'of':>8} {'mean':>7} {'identified':>11}  torque [Nm]")
for name in (*protocols, "everything-35"):
    told = surae.expect(protocols.get(name, name), "muscle", legs=10)
    print(
        f"{name:18} {100 * told.worst:7.1f}% {told.weakest:>8} {100 * told.geometric_mean:6.2f}% "
        f"{told.identified:8} of {len(told.parameters)}  {told.torque[1]:.0f}"
    )

# %%
# A search begins with what is known to be good and goes on from there; more evaluations buy more.
# The protocol keeps every limit of the device, and the torque that legs ask of it.
made = surae.design(
    20.0,
    model="muscle",
    device="achilles",
    effort="none",
    aim="passive_stiffness@10deg",
    evaluations=200,
    seed=1,
)
print(*made.notes, sep="\n")
print({name: f"{100 * error:.2f} %" for name, error in made.aimed.items()})

motion = made.trajectory
figure, axes = plt.subplots(figsize=(8, 2.8), layout="constrained")
axes.plot(motion.time, [57.2958 * angle for angle in motion.angle], color="black")
axes.set(xlabel="Time [s]", ylabel="Ankle angle [°]", title="The designed motion, at rest")
plt.show()
