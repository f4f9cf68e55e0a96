"""
Do a patient's published numbers come back?
===========================================

Passive torque of 24 spastic ankles after stroke and of 32 healthy ones was measured by Chung and
others (*Arch Phys Med Rehabil* 85, 2004, 1638): at 10° of dorsiflexion 9.5 and 6.2 Nm, stiffness
0.54 and 0.35 Nm/°. Two ankles are made so, turned slowly, and measured.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import surae

rate = 100.0
time = np.arange(0.0, 84.0, 1.0 / rate)
turned = np.maximum(time - 12.0, 0.0) / 24.0
angle = 3.0 - 17.0 * np.cos(2.0 * np.pi * turned)  # degrees
effort = np.exp(-(((time - 7.0) / 1.2) ** 2))  # the calf works once, so that rest shows as rest
draw = np.random.default_rng(2004)


def ankle(torque: float, stiffness: float) -> pd.DataFrame:
    """A recording of an ankle with so much passive torque [Nm] and stiffness [Nm/°] at 10°."""
    elastic = torque * np.exp(stiffness / torque * (angle - 10.0))
    volts = np.abs(draw.normal(0.0, 2e-6, (4, len(time)))) + 1e-6
    volts[1:] += 1e-4 * effort
    measured = elastic + 25.0 * effort + draw.normal(0.0, 0.05, len(time))
    columns = {"time_s": time, "angle_rad": np.radians(angle), "torque_Nm": measured}
    names = ("emg_ta_V", "emg_gl_V", "emg_sol_V", "emg_gm_V")
    frame = pd.DataFrame(columns | dict(zip(names, volts, strict=True)))
    frame.attrs["emg"] = "envelope"
    return frame


published = {"spastic": (9.5, 0.54), "healthy": (6.2, 0.35)}
figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
for place, (group, values) in enumerate(published.items()):
    leg = surae.relaxed(ankle(*values))
    m = leg.measures["passive_stiffness@10deg"]
    low, high = m.ci95_device  # at the angle that the device shows
    print(f"{group}: {m.value:.2f} Nm/° ({low:.2f} to {high:.2f}), published {values[1]:.2f}")
    axes.errorbar([m.value], [place], xerr=[[m.value - low], [high - m.value]], fmt="ko")
    axes.plot([values[1]], [place], "kx", ms=9)
axes.set(yticks=range(2), yticklabels=list(published), ylim=(-0.6, 1.6), xlim=(0.0, None))
axes.set(xlabel="Passive stiffness at 10° [Nm/°]", title="● measured here, 95 %   × published")
plt.show()
