"""Tissue and nerve of one leg between two visits, from the files of both."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from scipy.special import ndtri

from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.base.formatting import NO_NUMBER
from surae.base.normal import NORMAL
from surae.base.records import Saved, read_json
from surae.base.tables import Tabular, TextTable

#: Mean torque by which recordings may differ and still be of one effort [Nm].
ALIKE_NM = 2.0
#: Speed by which stretches may differ and still be of one speed [part].
ALIKE = 0.15


@dataclass(frozen=True, slots=True)
class NerveDifference:
    """One number before and after."""

    name: str  #: Of the measure; of stretches with direction and speed.
    before: float | None  #: None where there is none.
    after: float | None
    difference: float | None  #: After less before.
    ci95: tuple[float, float] | None  #: Widened for all that is compared (Bonferroni).
    smallest: float | None  #: Smallest change that would be detected.
    verdict: Literal["changed", "no change shown", "not comparable"]


@dataclass(frozen=True, slots=True, repr=False)
class NerveChange(Tabular, Saved):
    """What differs between two visits."""

    differences: tuple[NerveDifference, ...]
    notes: tuple[str, ...]  #: What to know, a sentence each.

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each number.
        """
        rows = []
        for d in self.differences:
            numbers = (d.before, d.after, d.difference, d.smallest)
            cells = [NO_NUMBER if v is None else f"{v:.3g}" for v in numbers]
            interval = NO_NUMBER if d.ci95 is None else f"{d.ci95[0]:.3g} to {d.ci95[1]:.3g}"
            rows.append((d.name, *cells[:3], interval, cells[3], d.verdict))
        numbers_ = ("before", "after", "difference", "95 % interval", "smallest detectable")
        return TextTable(
            ("measure", *numbers_, "verdict"), tuple(rows), below=self.notes, numbers=numbers_
        )


#: Of each number: value or None, and half of its interval.
_Side = Mapping[str, tuple[float | None, float]]


def of_files(before: PathLike, after: PathLike) -> NerveChange | None:
    """What differs between two files; None where one is not of `surae impedance` or `stretches`."""
    saved = []
    for path in (before, after):
        if not str(path).endswith(".json") or not Path(path).is_file():
            return None
        saved.append(read_json(path))
        keys = {*saved[-1]}
        if not ({"recordings", "reflex"} <= keys or {"stretches", "threshold"} <= keys):
            return None
    return nerve_change(*saved)


def nerve_change(before: Mapping[str, Any], after: Mapping[str, Any]) -> NerveChange:
    """Compare what `surae impedance`, or `surae stretches`, saved at two visits.

    Raises
    ------
    InputError
        They are of different commands, or no such files.
    """
    kinds = ["stretches" if "stretches" in each else "measures" for each in (before, after)]
    if kinds[0] != kinds[1]:
        raise InputError("one file is of surae impedance, the other of surae stretches")
    try:
        sides = [
            _of_stretches(e) if kinds[0] == "stretches" else _of_measures(e)
            for e in (before, after)
        ]
        efforts = [
            np.mean([r["mean_torque"] for r in e.get("recordings", ())] or [0.0])
            for e in (before, after)
        ]
    except (KeyError, TypeError, ValueError, AttributeError):
        raise InputError("a file is none that surae impedance or surae stretches saved") from None
    notes = [
        "Each interval is widened for all that is compared. What mounting the foot anew does is "
        "not in it: visits between which nothing was done show that."
    ]
    if abs(efforts[1] - efforts[0]) > ALIKE_NM:
        notes.append(
            f"The mean torque differs ({efforts[0]:.2g} and {efforts[1]:.2g} Nm): stiffness grows "
            "with effort, so the leg itself need not have changed."
        )
    return NerveChange(_differences(*sides), tuple(notes))


def _differences(before: _Side, after: _Side) -> tuple[NerveDifference, ...]:
    names = [*before, *(name for name in after if name not in before)]
    pairs = [(n, before.get(n, (None, 0.0)), after.get(n, (None, 0.0))) for n in names]
    compared = [1 for _, (a, _), (b, _) in pairs if a is not None and b is not None]
    wider = float(-ndtri(0.025 / max(len(compared), 1))) / NORMAL
    differences = []
    for name, (a, half_a), (b, half_b) in pairs:
        half = wider * float(np.hypot(half_a, half_b))
        if a is None or b is None or not 0.0 < half < np.inf:
            differences.append(NerveDifference(name, a, b, None, None, None, "not comparable"))
            continue
        d = b - a
        differences.append(
            NerveDifference(
                name,
                a,
                b,
                d,
                (d - half, d + half),
                half,
                "changed" if abs(d) > half else "no change shown",
            )
        )
    return tuple(differences)


def _of_measures(saved: Mapping[str, Any]) -> _Side:
    """Measures of perturbations, the wider side of each interval."""
    return {n: _one(m["value"], m["ci95"]) for n, m in saved["measures"].items()}


def _of_stretches(saved: Mapping[str, Any]) -> _Side:
    """Thresholds, and means over repeats of one speed with what repeats differ by."""
    values_of = {
        f"threshold {m} [deg]": _one(t["angle_deg"], t["ci95"])
        for m, t in saved["threshold"].items()
    }
    groups: dict[str, list[Mapping[str, Any]]] = {}
    for s in sorted(saved["stretches"], key=lambda s: s["speed_deg_s"]):
        speed = ALIKE * round(np.log(s["speed_deg_s"]) / ALIKE)
        groups.setdefault(f"{s['direction']} {np.exp(speed):.0f} deg/s", []).append(s)
    for name, change in saved["smallest_detectable_change"].items():
        for group, repeats in groups.items():
            values = [s[name] for s in repeats if s[name] is not None]
            mean = float(np.mean(values)) if len(values) == len(repeats) else None
            # 1.96·√2·SD is of two single stretches; the mean of n is surer by √n
            half = change / np.sqrt(2.0 * len(repeats)) if change else 0.0
            values_of[f"{name}, {group}"] = mean, float(half)
    return values_of


def _one(value: float | None, ci95: Sequence[float | None] | None) -> tuple[float | None, float]:
    if value is None or ci95 is None or ci95[0] is None or ci95[1] is None:
        return None, 0.0
    return value, max(ci95[1] - value, value - ci95[0])
