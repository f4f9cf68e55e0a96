"""Answers of what is tissue and what is nerve against truth.

An answer is a file ``FAMILY-SEED.json``: of perturbed legs ``{"reflex": {"verdict", "direction"},
"measures": {NAME: {"value", "ci95", "verdict"}}}``, of stretched legs ``{"stretches":
[{"recording", "start_s", "direction", "neural_Nm", "neural_ci95"}], "threshold": {MUSCLE:
{"angle_deg", "ci95"}}}``. Anything else in it is left alone.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ankle_legs import perturbed, stretched
from ankle_legs.stretched import CALF

#: Shares of the torque's variance between which reflexes are counted [%].
SHARES = (0.0, 0.5, 1.0, 2.0, 100.0)
MEASURES = (
    *("intrinsic_stiffness", "intrinsic_viscosity", "inertia"),
    *("reflex_gain", "reflex_delay", "reflex_share"),
)
NEAR = 0.15  # of the true neural torque
NEAR_DEG = 3.0  # of the true threshold
NONE = 0.05  # of the leg's largest elastic torque: so much neural torque is as good as none


@lru_cache(maxsize=2048)
def truth(family: str, seed: int) -> dict[str, Any]:
    """Return what is true of a perturbed or stretched leg."""
    if family in perturbed.families():
        return perturbed.record(family, seed).truth
    if family in stretched.families():
        return stretched.record(family, seed)[1]
    raise ValueError(f"no family {family!r} of perturbed or stretched legs")


@dataclass
class Measured:
    """How near one measure came, over the legs."""

    misses: list[float] = field(default_factory=list)  # relative, of the delay in ms
    intervals: int = 0
    hold: int = 0
    identified: int = 0
    true: int = 0  # of the identified

    def add(self, said: dict[str, Any], true: float, relative: bool) -> bool | None:
        """Count an answer; return whether its interval holds, None where it has none."""
        value, ci = said.get("value"), said.get("ci95")
        if value is not None and (true or not relative):
            self.misses.append(abs(value - true) / (abs(true) if relative else 1))
        holds = None
        if ci and None not in ci:
            holds = bool(ci[0] <= true <= ci[1])
            self.intervals += 1
            self.hold += holds
        if said.get("verdict") == "identified":
            self.identified += 1
            self.true += bool(holds)
        return holds

    def line(self, name: str, unit: str = " %") -> str:
        """Return the counts as a line of a table."""
        scale = 1 if unit != " %" else 100
        middle, high = (
            scale * np.quantile(self.misses, [0.5, 0.9]) if self.misses else (math.nan,) * 2
        )
        share = 100 * self.hold / max(self.intervals, 1)
        return (
            f"{name:<28} {len(self.misses):>4}  {middle:6.1f}{unit:<3} {high:7.1f}{unit:<3}  "
            f"{self.hold:>4} of {self.intervals:<4} {share:4.0f} %   "
            f"{self.true:>4} of {self.identified}"
        )


def answers(folder: Path) -> list[tuple[str, int, dict[str, Any]]]:
    """Return the answers of a folder: family, seed, and what was said."""
    said_of = []
    for path in sorted(folder.glob("*.json")):
        name = re.fullmatch(r"(.+)-(\d+)", path.stem)
        if not name:
            raise ValueError(f"{path}: name it FAMILY-SEED.json")
        said = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(said, dict):
            raise ValueError(f"{path}: not an object")
        said_of.append((name[1], int(name[2]), said))
    if not said_of:
        raise ValueError(f"{folder}: no FAMILY-SEED.json")
    return said_of


HEAD = f"{'':<28} {'n':>4}  {'median':>9} {'90th pc':>10}  {'intervals hold':>19}   identified true"


def perturbed_table(said: Iterable[tuple[str, int, dict[str, Any]]]) -> str:
    """Count answers of perturbed legs; gain and delay of reflexes above 2 % of the variance."""
    measures = {name: Measured() for name in MEASURES}
    weak = Measured()
    by_share = {low: [0, 0, 0, 0] for low in SHARES[:-1]}  # legs, present, cannot tell, wrong way
    nulls, families = [0, 0, 0, 0], dict[str, list[int]]()  # legs, present, cannot tell, bound < 2
    false: list[str] = []
    for family, seed, answer in said:
        true, leg = truth(family, seed), f"{family}-{seed}"
        verdict = answer["reflex"]["verdict"]
        count = families.setdefault(family, [0, 0])
        share = true["measures"]["reflex_share"]
        loud = share > SHARES[-2]
        for name, answered in answer["measures"].items():
            value = true["measures"].get(name)
            if name not in measures or value is None or (name.startswith("reflex") and not share):
                continue
            mine = measures[name] if loud or not name.startswith("reflex") else weak
            holds = mine.add(answered, value, name != "reflex_delay")
            if holds is not None:
                count[0] += 1
                count[1] += holds
            if holds is False and answered.get("verdict") == "identified":
                false.append(f"{name} of {leg}")
        if not share:
            high = (answer["measures"].get("reflex_share", {}).get("ci95") or [None, None])[1]
            nulls[0] += 1
            nulls[1] += verdict == "present"
            nulls[2] += verdict == "cannot tell"
            nulls[3] += high is not None and high < 2
            if verdict == "present":
                false.append(f"a reflex of {leg}, which has none")
            continue
        row = by_share[max(low for low in by_share if share > low)]
        row[0] += 1
        row[1] += verdict == "present"
        row[2] += verdict == "cannot tell"
        way = answer["reflex"].get("direction")
        wrong = verdict == "present" and true["direction"] not in (None, way)
        row[3] += wrong
        if wrong:
            false.append(f"direction of {leg}")
    lines = [HEAD]
    for name, measure in measures.items():
        loud = " (share > 2 %)" if name.startswith("reflex") else ""
        lines.append(measure.line(name + loud, " ms" if name == "reflex_delay" else " %"))
    lines.append(
        f"reflexes of at most 2 %: {weak.hold} of {weak.intervals} intervals hold, "
        f"{weak.true} of {weak.identified} identified are true"
    )
    for low, high in pairwise(SHARES):
        n, there, unsure, wrong = by_share[low]
        lines.append(
            f"reflex of {low:g} to {high:g} % of the variance: {n}, present {there}, "
            f"cannot tell {unsure}, wrong way {wrong}"
        )
    lines.append(
        f"no reflex: {nulls[0]}, present {nulls[1]}, cannot tell {nulls[2]}, "
        f"upper bound of the share below 2 %: {nulls[3]}"
    )
    order = sorted(families.items(), key=lambda item: item[1][1] / max(item[1][0], 1))
    lines.append("intervals that hold: " + ", ".join(f"{f} {h} of {n}" for f, (n, h) in order))
    return "\n".join([*lines, "false: " + ("; ".join(false) or "none")])


def _interval(said: dict[str, Any], *names: str) -> list[float] | None:
    """Return the first of the intervals that is there, with both ends."""
    for name in names:
        if isinstance(ci := said.get(name), list) and None not in ci:
            return ci
    return None


def _matched(true: dict[str, Any], said: list[dict[str, Any]]) -> dict[str, Any] | None:
    """Return the answer that tells of a stretch: in its recording, begun within 0.4 s of it."""
    for one in said:
        same = Path(str(one.get("recording"))).name == true["recording"]
        same = same and one.get("direction") == true["direction"]
        if same and abs(float(one["start_s"]) - true["start_s"]) < 0.4:
            return one
    return None


def stretched_table(said: Iterable[tuple[str, int, dict[str, Any]]]) -> str:
    """Count answers of stretched legs, with EMG and without."""
    rows: dict[str, dict[str, int]] = {}
    misses: dict[str, list[float]] = {}
    families = dict[str, list[int]]()

    def add(kind: str, **counts: bool | int) -> None:
        row = rows.setdefault(kind, {})
        for name, n in counts.items():
            row[name] = row.get(name, 0) + int(n)

    for family, seed, answer in said:
        true = truth(family, seed)
        kind = "EMG" if true["emg"] != "none" else "no EMG"
        tally = families.setdefault(family, [0, 0])
        scale = NONE * max(s["elastic_Nm"] for s in true["stretches"])
        up = [s for s in answer["stretches"] if s.get("direction") == "dorsiflexion"]
        add(kind, extra=len(up))
        for one in true["stretches"]:
            answered = _matched(one, up)
            add(kind, stretches=1, found=answered is not None, extra=-(answered is not None))
            if answered is None:
                continue
            neural, torque = answered.get("neural_Nm"), one["neural_Nm"]
            ci = _interval(answered, "neural_ci95", "neural_Nm_ci95", "ci95")
            holds = ci is not None and ci[0] <= torque <= ci[1]
            if neural is None:
                add(kind, **{"silent_on_some" if torque > scale else "silent_on_none": 1})
            elif torque > scale:
                near = abs(neural - torque) <= NEAR * torque
                add(kind, neural=1, near=near, good=near or holds, hold=holds, bound=ci is not None)
                misses.setdefault(kind, []).append(abs(neural - torque) / torque)
                tally[0] += 1
                tally[1] += near or holds
            else:
                add(kind, none=1, quiet=neural <= scale or holds)
                tally[0] += 1
                tally[1] += neural <= scale or holds
        for muscle in CALF:
            angle, answered = true["threshold"][muscle], answer["threshold"].get(muscle) or {}
            value = answered.get("angle_deg")
            if angle is None:
                add(kind, none_there=1, claimed=value is not None)
                continue
            add(kind, thresholds=1, told=value is not None)
            if value is None:
                continue
            ci = _interval(answered, "ci95")
            holds = ci is not None and ci[0] <= angle <= ci[1]
            near, sure = abs(value - angle) <= NEAR_DEG, answered.get("verdict") == "identified"
            add(kind, within=near, held=holds, either=near or holds)
            add(kind, sure=sure, sure_near=sure and near, sure_held=sure and holds)
            misses.setdefault(kind + " threshold", []).append(abs(value - angle))
    lines = [line for kind, row in sorted(rows.items()) for line in _counted(kind, row, misses)]
    order = sorted(families.items(), key=lambda item: item[1][1] / max(item[1][0], 1))
    lines.append("neural torque right: " + ", ".join(f"{f} {h} of {n}" for f, (n, h) in order))
    return "\n".join(lines)


def _counted(kind: str, row: dict[str, int], misses: dict[str, list[float]]) -> list[str]:
    """Return what was counted of stretched legs of a kind, in words."""
    of = {name: row.get(name, 0) for name in NAMES}
    return [
        f"{kind}: {of['found']} of {of['stretches']} stretches found, {of['extra']} too many",
        f"  neural torque of {of['neural']}: within 15 % {of['near']}, interval holds "
        f"{of['hold']} of {of['bound']}, one of both {of['good']}; median miss "
        f"{100 * _median(misses.get(kind)):.0f} %; not told: {of['silent_on_some']}",
        f"  no neural torque in {of['none']}: said so {of['quiet']}; not told: "
        f"{of['silent_on_none']}",
        f"  threshold of {of['thresholds']}: told {of['told']}, within 3° {of['within']}, "
        f"interval holds {of['held']}, one of both {of['either']}; median miss "
        f"{_median(misses.get(kind + ' threshold')):.1f}°; identified {of['sure']}, within 3° "
        f"{of['sure_near']}, interval holds {of['sure_held']}; none there {of['none_there']}, "
        f"claimed {of['claimed']}",
    ]


NAMES = (
    *("stretches", "found", "extra", "neural", "near", "hold", "bound", "good", "none", "quiet"),
    *("silent_on_some", "silent_on_none", "thresholds", "told", "within", "held", "either"),
    *("sure", "sure_near", "sure_held", "none_there", "claimed"),
)


def _median(values: list[float] | None) -> float:
    return float(np.median(values)) if values else math.nan


def score(folder: Path) -> str:
    """Count a folder of answers."""
    said = answers(folder)
    tables = []
    for key, count in (("measures", perturbed_table), ("stretches", stretched_table)):
        if some := [one for one in said if key in one[2]]:
            tables.append(count(some))
    if not tables:
        raise ValueError(f'{folder}: no answer has "measures" or "stretches"')
    return "\n\n".join(tables)
