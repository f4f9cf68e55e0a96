"""
What is the torque now?
=======================

A fit as a predictor: each sample's angle and EMG in, the torque out, without looking ahead.
"""

import time

import matplotlib.pyplot as plt
import numpy as np

import surae

fit = surae.fit(surae.example(), "muscle", starts=1)
p = fit.predictor(2048)
print(p)

# %%
# Another trial of the leg, as its samples come in; `follow` takes the steps.

trial = surae.example(trial=2)
now = p.follow(trial)
print(f"VAF {now.vaf:.2f} % now, {fit.predict(trial).vaf:.2f} % by filters that look ahead")
held = np.abs(now.inputs.torque - now.torque) <= 1.96 * now.sd
print(f"{100 * held.mean():.0f} % of the samples lie within the 95 % interval")

figure, axes = plt.subplots(figsize=(8, 3), layout="constrained")
axes.plot(now.time, now.inputs.torque, color="0.7", linewidth=3, label="measured")
axes.plot(now.time, now.torque, color="black", linewidth=0.8, label="predicted, sample by sample")
axes.set(xlabel="Time [s]", ylabel="Torque [Nm]")
axes.legend(frameon=False)
plt.show()

# %%
# How long a step takes, and the same in C.

taken = []
for angle in trial["angle"].values[:5000]:
    begun = time.perf_counter()
    p.step(angle, (0.0, 1e-5, 1e-5, 1e-5))
    taken.append(1e6 * (time.perf_counter() - begun))
late = np.percentile(taken, 99)
print(f"a step takes {np.median(taken):.1f} µs (median), {late:.1f} µs (99th percentile)")
print(p.to_c("leg").h.splitlines()[0])
