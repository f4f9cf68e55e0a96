"""Answers against truth: counts per family, worst first."""

from __future__ import annotations

import csv
import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from ankle_legs.make import truth_of

COLUMNS = ("family", "seed", "trial", "parameter", "value", "low", "high", "verdict")
CHANGES = ("family", "seed", "before", "after", "measure", "verdict")


@dataclass
class Count:
    """What was claimed of one family's legs, and how much of it is true."""

    family: str
    legs: set[int] = field(default_factory=set)
    identified: int = 0
    true: int = 0  # of the identified
    intervals: int = 0
    hold: int = 0  # of all intervals
    worst_identified: tuple[float, str] = (0.0, "")  # miss in sd, and of what
    worst: tuple[float, str] = (0.0, "")
    unscored: int = 0
    grades: Counter[str] = field(default_factory=Counter)

    @property
    def share(self) -> float:
        """Share of what is identified that is true; 1 where nothing is."""
        return self.true / self.identified if self.identified else 1.0


def rows(path: Path, columns: Iterable[str]) -> list[dict[str, str]]:
    """Return a table's rows; a missing column is a ValueError that names it."""
    with path.open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(line for line in file if not line.startswith("#"))
        missing = [name for name in columns if name not in (reader.fieldnames or ())]
        if missing:
            raise ValueError(f"{path}: no column {', '.join(missing)}")
        return list(reader)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def score(path: Path) -> list[Count]:
    """Count a table of answers, the worst family first.

    An answer whose truth does not exist in its family, or that gives no interval, is left out of
    the counts of intervals; one that is "identified" without an interval is not true.
    """
    counts: dict[str, Count] = {}
    graded = set()
    for number, row in enumerate(rows(path, COLUMNS), start=2):
        family, name = row["family"], row["parameter"]
        try:
            seed, trial = int(row["seed"]), int(row["trial"])
            truths = truth_of(family, seed, trial)
        except ValueError as error:
            raise ValueError(f"{path}, row {number}: {error}") from None
        count = counts.setdefault(family, Count(family))
        count.legs.add(seed)
        if row.get("grade") and (family, seed, trial) not in graded:
            graded.add((family, seed, trial))
            count.grades[row["grade"]] += 1
        known = {**truths["parameters"], **truths["measures"]}
        if known.get(name) is None:
            count.unscored += 1
            continue
        truth = float(known[name])
        value, low, high = (_number(row[key]) for key in ("value", "low", "high"))
        holds = low <= truth <= high
        identified = row["verdict"] == "identified"
        count.identified += identified
        count.true += identified and holds
        if not (math.isfinite(low) and math.isfinite(high) and high > low):
            continue
        count.intervals += 1
        count.hold += holds
        sd = (high - low) / (2 * 1.959964)
        miss = (abs(value - truth) / sd, f"{name} of {family}-{seed}, trial {trial}")
        count.worst = max(count.worst, miss)
        if identified:
            count.worst_identified = max(count.worst_identified, miss)
    return sorted(counts.values(), key=lambda c: (c.share, -c.worst[0]))


def table(counts: list[Count]) -> str:
    """Return the counts as a table to read."""
    total = Count("all")
    for count in counts:
        total.legs |= {hash((count.family, seed)) for seed in count.legs}
        for name in ("identified", "true", "intervals", "hold", "unscored"):
            setattr(total, name, getattr(total, name) + getattr(count, name))
        total.worst = max(total.worst, count.worst)
        total.worst_identified = max(total.worst_identified, count.worst_identified)
        total.grades += count.grades
    lines = [
        "family  legs  identified   true        "
        "intervals that hold  worst miss in sd: identified, all"
    ]
    for c in [*counts, total]:
        share = f"{100 * c.true / c.identified:3.0f} %" if c.identified else "  –  "
        lines.append(
            f"{c.family:<7} {len(c.legs):>4}  {c.identified:>10}   {c.true:>4} {share}   "
            f"{c.hold:>7} of {c.intervals:<7}      {c.worst_identified[0]:5.1f}, {c.worst[0]:5.1f}"
            f"  {c.worst[1]}"
        )
        if c.grades:
            lines[-1] += "  " + ", ".join(f"{n} {grade}" for grade, n in c.grades.most_common())
    lines.append(
        f"{total.unscored} answers were not counted: their families have no truth for them."
    )
    return "\n".join(lines)
