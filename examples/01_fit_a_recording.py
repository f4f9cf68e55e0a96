"""
How do the muscles of this leg work?
====================================

A subject moves through multiple holds with a chirp on top, relaxed at first and then pulling. The
fit finds fifteen parameters, each with an interval and a verdict.
"""

import matplotlib.pyplot as plt

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=1)
protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=125.0)
trial = virtual_trial(subject, generate(protocol))

fit = surae.fit(trial, "muscle")  # the model that made the trial
print(f"{fit.status}, VAF {fit.vaf:.2f} %")
for p in fit.parameters.values():
    truth = subject.parameters[p.name]
    print(f"{p.name:8} {p.value:11.4g} {p.unit:5} {p.verdict:11} truth {truth:.4g}")

# %%
# The subject is virtual, so its true parameters are known. What the torque is made of:

parts = fit.parts()
figure, axes = plt.subplots(figsize=(8, 3.5), layout="constrained")
axes.plot(trial.time, trial.torque, color="0.7", linewidth=3, label="measured")
axes.plot(trial.time, parts.total, color="black", linewidth=0.8, label="modelled")
axes.plot(trial.time, parts.tissue, linestyle="--", label="passive tissue")
axes.plot(trial.time, parts.neural, linestyle=":", label="active muscle")
axes.set(xlabel="Time [s]", ylabel="Torque [Nm]")
axes.legend(ncols=4, frameon=False, loc="lower left")
plt.show()
