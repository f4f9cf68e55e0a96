"""
What if a few samples are wrong?
================================

A knock on the manipulator is no property of a muscle. A loss that grows more slowly than the square
lets such samples count less.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=5)
protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=125.0)
clean = virtual_trial(subject, generate(protocol))
knocked = np.array(clean.torque)
knocked[np.random.default_rng(0).choice(len(knocked), 40, replace=False)] += 80.0
trial = replace(clean, torque=knocked)

figure, (axes, bars) = plt.subplots(1, 2, figsize=(9, 3), layout="constrained")
axes.plot(trial.time, trial.torque, color="0.6", linewidth=0.7)
axes.set(xlabel="Time [s]", ylabel="Torque with 40 knocks [Nm]")
for loss in (None, "huber", "tukey"):
    fit = surae.fit(trial, "muscle", starts=2, loss=loss)
    off = {n: abs(fit.values[n] / subject.parameters[n] - 1) for n in ("k_tri", "g1", "l0_tri")}
    said = ", ".join(f"{name} {100 * value:.1f} % off" for name, value in off.items())
    print(f"{loss or 'squares':8} {said}")
    bars.bar(loss or "squares", 100 * off["k_tri"], color="black")
bars.set(ylabel="k_tri off its truth [%]")
plt.show()
