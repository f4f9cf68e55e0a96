"""
What does a film of the muscle show, and what does it add?
==========================================================

Fascicles of a real tibialis, filmed by ultrasound while it pulled, beside its torque; then what a
film adds to a plan, over virtual legs. ``SURAE_DATA`` says where the published recordings are;
where they are missing the plan alone is shown.
"""

import os
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import surae

data = Path(os.environ.get("SURAE_DATA", "../../shared/data")).resolve()
trial = data / "dynamometer" / "PL_50_01.mat"
film = data / "ultrasound" / "PL_50_01_fascicles.csv"
if trial.is_file() and film.is_file():
    mapping = Path(tempfile.mkdtemp(), "filmed.toml")
    lines = [
        'name = "a filmed tibialis"',
        'emg = "raw"',
        "fixed = { g2 = 0.0, g3 = 0.0, g4 = 0.0 }",
    ]
    for role, column, unit in (("angle", "Angle", "deg"), ("torque", "Torque", "Nm")):
        lines += [f"[channels.{role}]", f'file = "{trial.as_posix()}"', f'column = "{column}"']
        lines += [f'unit = "{unit}"', "sign = -1"]
    lines += [
        "[channels.emg_ta]",
        f'file = "{trial.as_posix()}"',
        'column = "EMG_TA"',
        'unit = "V"',
    ]
    lines += ["[channels.fascicle_tib]", f'file = "{film.as_posix()}"', 'unit = "mm"']
    lines += ['column = "fascicle_superficial_mm"']
    mapping.write_text("\n".join(lines), encoding="utf-8")
    recording = surae.read(mapping)
    torque, seen = recording["torque"], recording["fascicle_tib"]
    figure, (above, below) = plt.subplots(2, 1, figsize=(8, 4), sharex=True, layout="constrained")
    above.plot(torque.time, torque.values, color="black", linewidth=0.8)
    above.set(ylabel="Torque [Nm]", title=recording.name)
    below.plot(seen.time, 1e3 * seen.values, color="black", linewidth=0.8)
    below.set(xlabel="Time [s]", ylabel="Fascicle [mm]")
    plt.show()
else:
    print("the recordings are not here")

# %%
# The optimal length of the muscle, with and without a film: 95 % interval, in per cent of it.
for filmed in ("", "tib"):
    told = surae.expect("multiple-holds", film=filmed or (), legs=4)
    error = 196.0 * told.parameters["l0_tib"].relative_sem
    print(f"{'with a film' if filmed else 'without':12} l0_tib to ± {error:.0f} %")
