"""Answers against truth: counts per family, worst first."""

from __future__ import annotations

import csv
import math
from collections import Counter
from collections.abc import Container, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from ankle_legs.make import RELAXED as VISITED
from ankle_legs.make import truth_of
from ankle_legs.relaxed import VISIT
from ankle_legs.subject import PARAMETERS

COLUMNS = ("family", "seed", "trial", "parameter", "value", "low", "high", "verdict")
ELECTRODES = (
    *("g1", "g2", "g3", "g4", "torque_per_emg_tri", "torque_per_emg_tib"),
    *("torque_gain_ta", "torque_gain_gl", "torque_gain_sol", "torque_gain_gm"),
)
#: What a trial's movement and effort make, beside the leg.
MOVED = (
    "end_",
    "torque_rise",
    "slack_before",
    "optimum_before",
    "active_torque_max",
    "maximal_torque",
)
MOUNTED_ANEW = range(4, 7)
CHANGES = ("family", "seed", "before", "after", "measure", "verdict")


@dataclass
class Count:
    """What was claimed of one family's legs, and how much of it is true."""

    family: str
    legs: set[str] = field(default_factory=set)
    identified: int = 0
    true: int = 0  # of the identified
    intervals: int = 0
    hold: int = 0  # of all intervals
    worst_identified: tuple[float, str] = (0.0, "")  # miss in sd, and of what
    worst: tuple[float, str] = (0.0, "")
    unscored: int = 0
    repeatable: int = 0
    repeated: int = 0  # of the repeatable, in the leg's next trial
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


def _number(text: str | None) -> float:
    try:
        return float(text or "")
    except ValueError:
        return math.nan


def _leg(row: dict[str, str]) -> tuple[str, str]:
    return row["family"], row["seed"]


def _truth(row: dict[str, str], trial: str) -> dict[str, float | None]:
    kinds = tuple(filter(None, (row.get("visit") or "").split("+")))
    truth = truth_of(row["family"], int(row["seed"]), int(row[trial]), kinds)
    if row.get("angle") == "device":
        return dict(truth.get("device", {}))
    return {**truth["parameters"], **truth["measures"]}


def score(path: Path, only: Container[str] | None = None) -> list[Count]:
    """Count a table of answers: families, the worst first, then all together.

    ``only`` these names are counted, all of them if None.

    An answer whose truth does not exist in its family, or that gives no interval, is left out of
    the counts of intervals; one that is "identified" without an interval is not true.
    """
    total, counts = Count("all"), dict[str, Count]()
    answers, graded = rows(path, COLUMNS), set()
    values = {
        (*_leg(row), row["trial"], row["parameter"], row.get("angle")): _number(row["value"])
        for row in answers
    }
    for number, row in enumerate(answers, start=2):
        if only is not None and row["parameter"] not in only:
            continue
        try:
            truth = _truth(row, "trial").get(row["parameter"])
        except ValueError as error:
            raise ValueError(f"{path}, row {number}: {error}") from None
        family, trial, leg = row["family"], row["trial"], f"{row['family']}-{row['seed']}"
        value, low, high = (_number(row[key]) for key in ("value", "low", "high"))
        holds = truth is not None and low <= truth <= high
        bounded = math.isfinite(low) and math.isfinite(high) and high > low
        identified = row["verdict"] == "identified"
        again = values.get((*_leg(row), str(int(trial) + 1), row["parameter"], row.get("angle")))
        claimed = (row.get("repeatable") or "").lower() == "true" and trial in ("1", "2")
        for count in (counts.setdefault(family, Count(family)), total):
            count.legs.add(leg)
            if row.get("grade") and (count.family, leg, trial) not in graded:
                graded.add((count.family, leg, trial))
                count.grades[row["grade"]] += 1
            if claimed and again is not None:
                count.repeatable += 1
                between = _number(row.get("repeat_low")) <= again
                count.repeated += between and again <= _number(row.get("repeat_high"))
            if truth is None:
                count.unscored += 1
                continue
            count.identified += identified
            count.true += identified and holds
            if bounded:
                count.intervals += 1
                count.hold += holds
                sd = (high - low) / (2 * 1.959964)
                miss = (abs(value - truth) / sd, f"{row['parameter']} of {leg}, trial {trial}")
                count.worst = max(count.worst, miss)
                if identified:
                    count.worst_identified = max(count.worst_identified, miss)
    return [*sorted(counts.values(), key=lambda c: (c.share, -c.worst[0])), total]


def measures_of(path: Path) -> set[str]:
    """Return the names of a table of answers that are no parameters."""
    return {row["parameter"] for row in rows(path, COLUMNS)} - set(PARAMETERS)


def names(path: Path, only: Container[str]) -> str:
    """Return, per name, how often it is identified, true, and how many intervals hold."""
    counts: dict[str, list[int]] = {}
    for row in rows(path, COLUMNS):
        truth = _truth(row, "trial").get(row["parameter"]) if row["parameter"] in only else None
        low, high = _number(row["low"]), _number(row["high"])
        if truth is None or not high > low:
            continue
        holds, claimed = low <= truth <= high, row["verdict"] == "identified"
        shown = " (device)" if row.get("angle") == "device" else ""
        count = counts.setdefault(row["parameter"] + shown, [0, 0, 0, 0])
        for i, one in enumerate((1, holds, claimed, claimed and holds)):
            count[i] += one
    return "\n".join(
        f"{name:<42} {hold:>4} of {n:<4} hold, {claimed:>4} identified, {true:>4} true"
        for name, (n, hold, claimed, true) in sorted(counts.items())
    )


def table(counts: list[Count]) -> str:
    """Return the counts as a table to read."""
    lines = [
        "family  legs  identified   true        intervals that hold  repeated    "
        "worst miss in sd: identified, all"
    ]
    for c in counts:
        share = f"{100 * c.true / c.identified:3.0f} %" if c.identified else "  –  "
        lines.append(
            f"{c.family:<7} {len(c.legs):>4}  {c.identified:>10}   {c.true:>4} {share}   "
            f"{c.hold:>7} of {c.intervals:<8} {c.repeated:>4} of {c.repeatable:<4} "
            f"{c.worst_identified[0]:5.1f}, {c.worst[0]:5.1f}  {c.worst[1]}"
        )
        if c.grades:
            lines[-1] += "  " + ", ".join(f"{n} {grade}" for grade, n in c.grades.most_common())
    left = counts[-1].unscored
    return "\n".join(
        [*lines, f"{left} answers were not counted: their families have no truth for them."]
    )


@dataclass
class Pairs:
    """What was said of pairs of trials, or of visits, of one family."""

    movement: dict[tuple[str, ...], bool] = field(default_factory=dict)  # unchanged: any claim?
    mounting: dict[tuple[str, ...], bool] = field(default_factory=dict)
    changed: int = 0
    found: int = 0
    same: int = 0  # quantities of treated legs that did not change
    false: int = 0
    differences: int = 0  # that have an interval
    hold: int = 0


def _placed(row: dict[str, str], trial: int) -> int:
    """Return the number of the mounting that a trial of a leg has."""
    if row["family"] in VISITED:
        return (trial - 1) // VISIT
    return int(trial in MOUNTED_ANEW)


def _count_pair(row: dict[str, str], pairs: Pairs) -> None:
    """Count a row: what it says of a measure before and after, and what is true."""
    first, second = int(row["before"]), int(row["after"])
    before, after = (_truth(row, key).get(row["measure"], 0.0) for key in ("before", "after"))
    anew = _placed(row, first) != _placed(row, second)
    if before is None or after is None or (anew and row["measure"] in ELECTRODES):
        return
    low, high = (_number(row.get(key)) for key in ("low", "high"))
    if high > low:
        pairs.differences += 1
        pairs.hold += low <= after - before <= high
    said = row["verdict"] == "changed"
    if (first > 6) == (second > 6):
        pair = (row["seed"], row["before"], row["after"])
        same = pairs.mounting if anew else pairs.movement
        same[pair] = same.get(pair, False) or said
        return
    difference = abs(after / before - 1) if before else 0.0
    if not before or row["measure"].startswith(MOVED) or 1e-9 <= difference <= 0.1:
        return
    if difference > 0.1:
        pairs.changed += 1
        pairs.found += said
    else:
        pairs.same += 1
        pairs.false += said


def change_table(path: Path) -> str:
    """Count pairs of trials: what is called changed, and what is.

    A quantity has changed where its truth differs by more than 10 %, and has not where it is the
    same; what lies between, or depends on the electrodes, is not counted. A measure whose truth is
    not known counts in unchanged pairs alone. Columns ``low`` and ``high`` may give an interval of
    the difference, after less before.
    """
    families: dict[str, Pairs] = {}
    for row in rows(path, CHANGES):
        _count_pair(row, families.setdefault(row["family"], Pairs()))
    lines = [
        "family  unchanged pairs called changed: other movement, other mounting    treated: found"
    ]
    for family, one in families.items():
        moved, mounted = (
            f"{sum(pairs.values())} of {len(pairs)}" for pairs in (one.movement, one.mounting)
        )
        lines.append(
            f"{family:<7} {moved:>45}, {mounted:<20} {one.found} of {one.changed} that changed, "
            f"{one.false} of {one.same} that did not"
        )
        if one.differences:
            lines[-1] += f"; {one.hold} of {one.differences} differences hold"
    return "\n".join(lines)
