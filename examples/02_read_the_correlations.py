"""
Which parameters trade off with one another?
============================================

Two parameters that change the torque alike cannot be separated by it. The correlation of their
estimates says how alike.
"""

import matplotlib.pyplot as plt

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=125.0)
fit = surae.fit(virtual_trial(virtual_subject(seed=1), generate(protocol)), "muscle", starts=2)

names = fit.covariance.names
figure, axes = plt.subplots(figsize=(6, 5), layout="constrained")
image = axes.imshow(fit.covariance.correlation, cmap="PuOr", vmin=-1, vmax=1)
axes.set_xticks(range(len(names)), names, rotation=90)
axes.set_yticks(range(len(names)), names)
figure.colorbar(image, label="Correlation [-]")
plt.show()

# %%
# The strongest pairs:

pairs = [
    (abs(fit.correlation.loc[a, b]), a, b) for i, a in enumerate(names) for b in names[i + 1 :]
]
for size, a, b in sorted(pairs, reverse=True)[:4]:
    print(f"{a} and {b}: {size:.2f}")
print(f"IPDE, all of them in one number: {fit.ipde:.2f}")
