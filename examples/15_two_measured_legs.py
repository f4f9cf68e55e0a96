"""
What does a measured leg look like?
===================================

Two recordings of real legs: one moved by a dynamometer, one walking. The files are those of
published data sets; ``SURAE_DATA`` says where they are. Where they are missing nothing is drawn.
"""

import os
from pathlib import Path

import matplotlib.pyplot as plt

import surae

data = Path(os.environ.get("SURAE_DATA", "../../shared/data"))
for name in ("dynamometer/PL_50_01.toml", "gait/walk36.toml"):
    if not (data / name).is_file():
        print(f"{name} is not here")
        continue
    recording = surae.read(data / name)
    angle, torque = recording["angle"], recording["torque"]
    figure, (above, below) = plt.subplots(2, 1, figsize=(8, 4), sharex=True, layout="constrained")
    above.plot(angle.time, [57.2958 * value for value in angle.values], color="black")
    above.set(ylabel="Angle [°]", title=recording.name)
    below.plot(torque.time, torque.values, color="black", linewidth=0.8)
    below.set(xlabel="Time [s]", ylabel="Torque [Nm]")
    plt.show()
    print(recording)
