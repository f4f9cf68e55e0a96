"""
What if I know a parameter roughly?
===================================

A prior is a median and a relative spread. It adds what is known beforehand to what the recording
says; fixing a parameter claims to know it exactly.
"""

import matplotlib.pyplot as plt

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=1)
protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=125.0)
trial = virtual_trial(subject, generate(protocol))

known = subject.parameters["k_tib"]
figure, axes = plt.subplots(figsize=(7, 2.6), layout="constrained")
for what, given in (
    ("nothing known", {}),
    ("k_tib known to 10 %", {"priors": {"k_tib": (known, 0.1)}}),
    ("k_tib known exactly", {"fixed": {"k_tib": known}}),
    ("what healthy legs are like", {"priors": "healthy"}),
):
    x0 = surae.fit(trial, "muscle", starts=2, **given).parameters["x0_tib"]
    half = 100 * (x0.ci95[1] - x0.value) / x0.value
    print(f"{what:28} x0_tib {1e3 * x0.value:.1f} mm ± {half:4.1f} %  {x0.verdict}")
    ends = [[1e3 * (x0.value - x0.ci95[0])], [1e3 * (x0.ci95[1] - x0.value)]]
    axes.errorbar([1e3 * x0.value], [what], xerr=ends, fmt="o", color="black", capsize=3)
axes.axvline(1e3 * subject.parameters["x0_tib"], color="0.5", linestyle=":", label="truth")
axes.set(xlabel="Slack length of the tibialis [mm], 95 %")
axes.invert_yaxis()
axes.legend(frameon=False)
plt.show()
