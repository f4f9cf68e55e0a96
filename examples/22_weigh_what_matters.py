"""
Can a fit follow what matters more closely?
===========================================

Peaks are a small part of a trial's samples. ``--weight-peaks 9`` lets a sample at a peak count ten
times one at rest; ``--weight 0:11:0`` leaves the first eleven seconds out.
"""

import matplotlib.pyplot as plt
import numpy as np

import surae
from surae.protocol import Protocol, generate
from surae.signals import Weighting
from surae.studies import virtual_subject, virtual_trial

# A leg on compliant tendons, fitted by a model without any: what is left is the model's.
subject = virtual_subject(seed=2, tendons=True)
motion = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=125.0))
trial = virtual_trial(subject, motion, model="muscle-tendon-strain")

high = np.abs(trial.torque) > np.quantile(np.abs(trial.torque), 0.95)
figure, axes = plt.subplots(figsize=(8, 3), layout="constrained")
axes.plot(trial.time, trial.torque, color="0.7", linewidth=3, label="measured")
for what, weights in (("every sample alike", None), ("peaks ten times", Weighting(peaks=9))):
    fit = surae.fit(trial, "muscle", starts=2, seed=1, weights=weights)
    values = {name: p.value for name, p in fit.parameters.items()}
    left = trial.torque - surae.simulate("muscle", values, trial)
    at_peaks, elsewhere = (float(np.sqrt(np.mean(left[of] ** 2))) for of in (high, ~high))
    print(f"{what:20} {at_peaks:.2f} Nm at peaks, {elsewhere:.2f} Nm elsewhere")
    axes.plot(trial.time, trial.torque - left, label=what)
axes.set(xlabel="Time [s]", ylabel="Torque [Nm]")
axes.legend(frameon=False)
plt.show()
