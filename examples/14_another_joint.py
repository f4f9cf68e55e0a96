"""
Can another joint be fitted, such as a wrist?
=============================================

Yes: a joint is a file with two groups of muscles, constants and words. With a geometry it is
fitted as the ankle is. This wrist is virtual, so that its truth is known.
"""

from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import surae

wrist = {"joint": "wrist/joint.toml", "geometry": "wrist/geometry.csv"}
truth = {
    "m": 0.5,
    "k_tri": 160.0,
    "k_tib": 140.0,
    "x0_tri": 0.043,
    "x0_tib": 0.046,
    "tau_rel": 2.0,
    "k_rel": 0.3,
    "g1": 5e5,
    "g2": 3e5,
    "g3": 6e5,
    "g4": 0.0,
    "l0_tri": 0.062,
    "l0_tib": 0.064,
    "f0": 2.2,
    "beta": 1.0,
}

# Forty seconds: slow and quick turns within 40° to either side, the muscles in turn.
random = np.random.default_rng(1)
t = np.arange(0.0, 40.0, 0.008)
angle = np.radians(22.0 * np.sin(0.6 * t) + 12.0 * np.sin(2.3 * t + 1.0) + 5.0 * np.sin(5.1 * t))
columns = {"time_s": t, "angle_rad": angle}
for muscle, period, begin in (("ta", 5.0, 0.0), ("gl", 7.0, 2.0), ("sol", 6.0, 3.5)):
    burst = np.clip(np.sin(2.0 * np.pi * (t - begin) / period), 0.0, None) ** 2
    columns[f"emg_{muscle}_V"] = 2e-4 * burst * (0.4 + 0.6 * np.sin(0.11 * t + begin) ** 2)
still = pd.DataFrame(columns).assign(torque_Nm=0.0, emg_gm_V=0.0)
torque = surae.simulate("muscle", truth, still, **wrist)
trial = pd.DataFrame(columns).assign(torque_Nm=torque + 0.02 * random.standard_normal(len(t)))
folder = Path(mkdtemp())
trial.to_csv(folder / "wrist.csv", index=False)

# In a shell: surae fit wrist.csv --joint wrist/joint.toml --geometry wrist/geometry.csv …
fit = surae.fit(folder / "wrist.csv", "muscle", prepared=True, starts=2, **wrist)
fit.report(folder / "wrist.html")
print(f"VAF {fit.vaf:.2f} %, {(folder / 'wrist.html').stat().st_size // 1000} kB of report")
for name, p in fit.parameters.items():
    print(f"{name:8} {p.value:10.4g} {p.unit:4} truth {truth[name]:8.4g}, {p.verdict}: {p.meaning}")

figure, axes = plt.subplots(figsize=(8, 2.8), layout="constrained")
fit.plot.torque(0, ax=axes)
plt.show()
