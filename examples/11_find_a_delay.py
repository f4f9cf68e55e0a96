"""
Does the EMG lead the torque?
=============================

Between a muscle's electrical activity and its force lies an electromechanical delay. It can be
estimated with the other parameters.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=1)
protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=125.0)
trial = virtual_trial(subject, generate(protocol))
samples = 5  # 40 ms: what was recorded earlier than it acts
early = replace(trial, emg=np.vstack([trial.emg[samples:], np.repeat(trial.emg[-1:], samples, 0)]))

without, found = (
    surae.fit(early, "muscle", starts=2),
    surae.fit(early, "muscle", free=("emd",), starts=2),
)
delay = found.parameters["emd"]
print(f"without a delay: VAF {without.vaf:.2f} %, f0 {without.values['f0']:.2f} Hz")
print(f"with one: VAF {found.vaf:.2f} %, f0 {found.values['f0']:.2f} Hz")
print(f"truth: f0 {subject.parameters['f0']:.2f} Hz, delay 40 ms")
low, high = delay.ci95
print(f"delay {1e3 * delay.value:.1f} ms ({1e3 * low:.1f} … {1e3 * high:.1f} ms), {delay.verdict}")

missed = {"without a delay": without, "with one": found}
figure, axes = plt.subplots(figsize=(8, 2.8), layout="constrained")
for (label, fit), colour in zip(missed.items(), ("0.6", "black"), strict=True):
    residual = early.torque - fit.predict(early).torque
    axes.plot(early.time, residual, color=colour, linewidth=0.8, label=label)
axes.set(xlabel="Time [s]", ylabel="What the model misses [Nm]")
axes.legend(frameon=False, ncols=2)
plt.show()
