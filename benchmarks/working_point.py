"""Where legs work on the force–length curve: how often the interval holds, and how wide it is.

Legs of `legs/`, which share no code with surae, one active trial each, fitted as anybody would:

    .venv/bin/python benchmarks/working_point.py --families a,c,f,va,vd --seeds 501-505

Prints per measure how many intervals hold the truth, and medians of their half-widths and of the
errors; "device" is the interval by the angle that the device shows.
"""

import argparse
import csv
import sys
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

import surae

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.make import leg, make, truth_of
from ankle_legs.muscle import static_force
from ankle_legs.subject import GROUPS

#: What is counted, of each group.
NAMES = (
    "working_point",
    "optimal_angle",
    "optimum_before_end",
    "shortest_length",
    "longest_length",
)
COUNTED = tuple(f"{name}_{group}" for name in NAMES for group in GROUPS)

Row = dict[str, Any]


def numbers(text: str) -> list[int]:
    """Seeds of a text as 11-14 or 3,5,8."""
    pieces = [part.partition("-") for part in text.split(",")]
    return [n for low, _, high in pieces for n in range(int(low), int(high or low) + 1)]


def over_the_range(
    family: str, seed: int, low: float, high: float, optimum: dict[str, float | None]
) -> dict[str, float]:
    """Truth of what needs no zero, over a range [deg], in a leg whose zero is the device's."""
    one = leg(family, seed)
    subject = one.lasting(one.subject)
    paths = subject.geometry.path(np.radians([low, high]))
    found = {}
    for i, (group, muscle) in enumerate(zip(GROUPS, subject.muscles(), strict=True)):
        at = [static_force(muscle, float(path), 0.0)[1] / muscle.l0 for path in paths[i]]
        found[f"shortest_length_{group}"] = 100.0 * min(at)
        found[f"longest_length_{group}"] = 100.0 * max(at)
        if (best := optimum.get(f"optimal_angle_{group}")) is not None:
            before = high - best if group == "tri" else best - low
            found[f"optimum_before_end_{group}"] = before
    return found


def told(family: str, seed: int, trials: int) -> list[Row]:
    """What a leg's fit says of its working points, beside the truth."""
    truth = truth_of(family, seed, 1)["measures"]
    with tempfile.TemporaryDirectory() as folder:
        fit = surae.fit(make(family, seed, Path(folder), range(1, trials + 1)))
        measures = fit.measures()
    ends = measures["optimum_before_end_tri"]
    if ends.from_deg is not None and truth.get("working_point_tri") is not None:
        truth = {**truth, **over_the_range(family, seed, ends.from_deg, ends.to_deg, truth)}
    rows = []
    for name in COUNTED:
        m = measures.get(name)
        if truth.get(name) is None or m is None or m.value is None or m.ci95 is None:
            continue
        row: Row = {"family": family, "seed": seed, "measure": name, "true": truth[name]}
        row |= {"value": m.value, "low": m.ci95[0], "high": m.ci95[1]}
        row |= dict(zip(("device_low", "device_high"), m.ci95_device or m.ci95, strict=True))
        row |= {"verdict": str(m.verdict), "grade": str(fit.adequacy.grade)}
        rows.append(row)
    return rows


def summary(rows: list[Row]) -> str:
    """Counts by measure and interval, of all fits and of adequate ones."""
    lines = []
    for name in COUNTED:
        for which in ("all", "adequate"):
            some = [r for r in rows if r["measure"] == name and which in ("all", r["grade"])]
            for kind in ("", "device_"):
                if some and (not kind or name.startswith(("working_point", "optimal_angle"))):
                    lines.append(f"{name:<22} {which:<9} {kind:<7} {_counted(some, kind)}")
    return "\n".join(lines)


def _counted(some: list[Row], kind: str) -> str:
    """How many of some intervals hold, and their medians."""
    ends = [(r["true"], float(r[f"{kind}low"]), float(r[f"{kind}high"])) for r in some]
    holds = [low <= true <= high for true, low, high in ends]
    half = np.median([0.5 * (high - low) for _, low, high in ends])
    off = np.median([abs(r["value"] - r["true"]) for r in some])
    sure = [hold for hold, r in zip(holds, some, strict=True) if r["verdict"] == "identified"]
    share = f"{sum(holds)} of {len(some)} hold ({100 * np.mean(holds):.0f} %)"
    wide = f"half-width {half:.1f}, error {off:.1f} (medians)"
    return f"{share}; {wide}; identified {len(sure)}, true {sum(sure)}"


def main() -> None:
    """Fit legs and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--families", default="a,c,d,f,j,o,va,vd")
    parser.add_argument("--seeds", type=numbers, default=numbers("501-502"), metavar="501-502")
    parser.add_argument("--trials", type=int, default=1, help="fitted jointly")
    parser.add_argument("--output", type=Path, help="a table of all of them")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    rows: list[Row] = []
    for seed in given.seeds:
        for family in given.families.split(","):
            begin = time.process_time()
            try:
                rows += told(family, seed, given.trials)
            except surae.SuraeError as error:
                print(f"{family}-{seed}: {error}", file=sys.stderr)
            spent = time.process_time() - begin
            print(f"{family}-{seed}: {spent:.1f} s", file=sys.stderr, flush=True)
            if given.output is not None and rows:
                with given.output.open("w", newline="", encoding="utf-8") as file:
                    writer = csv.DictWriter(file, list(rows[0]))
                    writer.writeheader()
                    writer.writerows(rows)
    print(summary(rows))


if __name__ == "__main__":
    main()
