"""
How far can a parameter go before the data object?
==================================================

A profile holds a parameter at value after value and fits all others again. Its interval need not be
symmetric.
"""

import matplotlib.pyplot as plt

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=64.0, chirp_rate=0.4)
fit = surae.fit(virtual_trial(virtual_subject(seed=1), generate(protocol)), "muscle", starts=2)
found = surae.profile(fit, ("k_tib", "l0_tri"))

figure, axes = plt.subplots(1, 2, figsize=(8, 3.2), layout="constrained")
for panel, (name, profile) in zip(axes, found.profiles.items(), strict=True):
    estimate = fit.parameters[name]
    panel.plot(profile.values, profile.chi2, color="black", marker=".")
    panel.axhline(profile.threshold, color="0.5", linestyle="--")
    panel.axvline(estimate.value, color="0.5", linestyle=":")
    panel.locator_params(axis="x", nbins=4)
    panel.set(xlabel=f"{name} [{estimate.unit}]", ylabel="Rise of the sum of squares, Δχ² [-]")
plt.show()
for name, profile in found.profiles.items():
    print(f"{name}: the profile's interval is {profile.interval}")
    print(f"{' ' * len(name)}  the covariance's {fit.parameters[name].ci95}")
