"""
How stiff is a measured leg while it walks?
===========================================

A minute on a treadmill: no rest in it, so nothing is said of the relaxed ankle. What the page of
the leg answers is how stiff the ankle is while its muscles work, and what its torque is made of.
``SURAE_DATA`` says where the published recording is; where it is missing nothing is drawn.
"""

import os
from pathlib import Path

import matplotlib.pyplot as plt

import surae

data = Path(os.environ.get("SURAE_DATA", "../../shared/data"))
walk = data / "gait" / "walk36.toml"
if walk.is_file():
    leg = surae.session([walk]).run()
    for question, answer in leg.answers().items():
        print(f"{question}\n    {answer}")
    recording = surae.read(walk)
    angle, torque = recording["angle"], recording["torque"]
    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    axes.plot(57.2958 * angle.values, torque.values, color="black", linewidth=0.4)
    axes.set(xlabel="Ankle angle [°]", ylabel="Torque [Nm]", title=recording.name)
    plt.show()
else:
    print("the recording is not here")
