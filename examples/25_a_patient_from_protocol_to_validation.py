"""
How does a patient go from protocol to validation?
==================================================

The thesis's chain on a virtual patient: a ramp and hold at rest (its protocol 1), an active trial
and a repetition of it. The EMG comes from behind an amplifier, so that the files hold its output.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import surae
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES, write_csv
from surae.studies import virtual_subject, virtual_trial

GAIN = 1000.0  # of the amplifier: 0.4 mV at the skin are 0.4 V in the file
folder = Path(tempfile.mkdtemp())
patient = virtual_subject(seed=5, population="patient")
trials = {
    "passive": Protocol(profile="ramp-and-hold", task="passive", rate_hz=125.0),
    "active": Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=125.0),
    "again": Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=125.0),
}
for number, (name, protocol) in enumerate(trials.items()):
    trial = virtual_trial(patient, generate(protocol), seed=number)
    columns = {"Time": trial.time, "Angle": trial.angle, "Torque": trial.torque}
    columns |= {m.upper(): GAIN * trial.emg[:, i] for i, m in enumerate(MUSCLES)}
    write_csv(folder / f"{name}.csv", columns)

# %%
# One mapping describes all files: which column is which, and the amplifier.
lines = ['emg = "envelope"', 'time = "Time"']
lines += ['[channels.angle]\ncolumn = "Angle"\nunit = "rad"']
lines += ['[channels.torque]\ncolumn = "Torque"\nunit = "Nm"']
lines += [
    f'[channels.emg_{m}]\ncolumn = "{m.upper()}"\nunit = "V"\nscale = {1 / GAIN}' for m in MUSCLES
]
mapping = folder / "patient.toml"
mapping.write_text("\n".join(lines), encoding="utf-8")
passive, active, again = (surae.read(folder / f"{n}.csv", mapping=mapping) for n in trials)
for recording in (passive, active):
    print(surae.check(recording))

# %%
# The relaxed ankle first, without a model of muscles.
rest = surae.relaxed([passive])
print(rest)

# %%
# Then passive and active together; the repetition is predicted, not fitted.
fit = surae.fit([passive, active], "muscle", starts=2, seed=1)
print(fit)
predicted = fit.predict(again)
print(f"VAF of the fit {fit.vaf:.1f} %, of the repetition {predicted.vaf:.1f} %")
measures = fit.measures(angles=[10])
for name in ("passive_stiffness@10deg", "longest_length_tri", "working_point_tri"):
    print(measures[name])

figure, axes = plt.subplots(figsize=(8, 3), layout="constrained")
fit.plot.torque(1, ax=axes)
plt.show()
