"""
Do two groups of legs differ?
=============================

Six virtual legs, three of them patients', each fitted by itself; a table says whose fit is whose.
Every leg counts as much as its interval allows, and what no leg tells is in no mean.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

folder = Path(tempfile.mkdtemp())
motion = generate(Protocol(profile="multiple-holds", task="active", rate_hz=50.0, duration=25.0))
rows = ["fit,subject,group"]
stiffness: dict[str, list[tuple[float, tuple[float, float]]]] = {}
for seed in range(1, 7):
    group = "patient" if seed > 3 else "healthy"
    trial = virtual_trial(virtual_subject(seed, population=group), motion, seed=seed)
    fit = surae.fit(trial, "muscle", starts=2, seed=1)
    fit.save(folder / f"leg-{seed}.json")
    rows.append(f"leg-{seed}.json,S{seed},{group}")
    m = fit.measures()["end_stiffness"]
    if m.value is not None and m.ci95 is not None:
        stiffness.setdefault(group, []).append((m.value, m.ci95))
(folder / "legs.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")

cohort = surae.cohort(folder / "legs.csv", question=("end_stiffness",))
frame = cohort.to_dataframe()
print(frame.head(12))

figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
for place, (_group, legs) in enumerate(sorted(stiffness.items())):
    for beside, (value, (low, high)) in enumerate(legs):
        x = place + 0.1 * (beside - 1)
        axes.errorbar([x], [value], [[value - low], [high - value]], fmt="o", color="black")
axes.set(xticks=range(len(stiffness)), xticklabels=sorted(stiffness), xlim=(-0.5, 1.5))
axes.set(ylabel="Stiffness at the end [Nm/°]", title="Each leg with its 95 % interval")
plt.show()
