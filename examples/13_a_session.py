"""
How do I get from a folder to a figure?
=======================================

A leg's trials in one folder are a session: each is fitted, then all together, and each predicts the
others. A trial that holds still is recognised, and is used for what it can tell.
"""

import tempfile
from dataclasses import replace
from pathlib import Path

from matplotlib import pyplot

import surae
from surae.protocol import Protocol, generate
from surae.recording import write_csv
from surae.studies import virtual_subject, virtual_trial

# Trials as a laboratory would leave them: two that move, and one that holds still.
folder = Path(tempfile.mkdtemp()) / "leg"
folder.mkdir()
subject = virtual_subject(seed=2)
for number, profile in enumerate(("multiple-holds", "multi-sine")):
    trial = virtual_trial(subject, generate(Protocol(profile=profile, rate_hz=125.0)), seed=number)
    emg = {f"emg_{name}_V": trial.emg[:, i] for i, name in enumerate(("ta", "gl", "sol", "gm"))}
    columns = {"time_s": trial.time, "angle_rad": trial.angle, "torque_Nm": trial.torque, **emg}
    write_csv(folder / f"{profile}.csv", columns, ["emg: envelope"])
still = 0.0 * trial.angle
hold = replace(trial, angle=still + 0.2, velocity=still, acceleration=still)
torque = surae.simulate("muscle", subject.parameters, hold)
held = {**columns, "angle_rad": hold.angle, "torque_Nm": torque}
write_csv(folder / "hold.csv", held, ["emg: envelope"])

session = surae.session(folder)
print(session)

# %%
# One run: each, all together, and who predicts whom.
result = session.run(model="muscle", prepared=True, starts=2)
print(result)
for name, predicted in result.joint_predictions.items():
    kind = "fitted" if predicted.fitted else "predicted"
    print(f"{name:15} {kind}, RMS error {predicted.rmse:.2f} Nm")

# %%
# The parameters are a table, and plots are Matplotlib's own axes.
table = result.to_dataframe().set_index("trial")
print(table[["k_tri", "k_tri_low", "k_tri_high", "k_tri_verdict"]])

figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 4), layout="constrained")
result.joint.plot.torque(0, ax=left)
result.joint.plot.parts(0, ax=right)
