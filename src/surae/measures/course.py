"""A leg over several visits: a straight line through each measure, judged as a difference is.

What visits share shifts all of them alike and not the line's slope, so that each weighs by what it
draws anew alone: v = a + b·t + e, e ~ N(0, SEM²). Where they scatter more than that, the slope is
as much less sure (R. T. Birge, 1932, Phys. Rev. 40:207-227).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.base.normal import NORMAL
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.measure import Measure
from surae.measures.relaxed_change import doubt_between, with_detectable_changes
from surae.measures.rest.judged import measures_of_rest
from surae.measures.strength import STRENGTH, strength_meaning, strength_of
from surae.trials.strength import Effort

#: A line needs so many visits to say that it fits; two are a difference.
FEWEST = 3


@dataclass(frozen=True, slots=True)
class Series:
    """A measure at every visit."""

    name: str
    unit: str
    meaning: str
    basis: str
    values: tuple[float | None, ...]  #: In the order of the visits; None where there is none.
    #: Standard error of measurement between visits of each; None where there is no value.
    sems: tuple[float | None, ...]
    from_deg: float | None = None
    to_deg: float | None = None


@dataclass(frozen=True, slots=True)
class Trend:
    """A straight line through a series."""

    difference: float  #: From the first visit to the last, along the line.
    sd: float  #: Its standard deviation.
    ci95: tuple[float, float]
    ratio: float  #: How much more visits scatter about the line than they should; 1 where not.


def trend_of(times: Sequence[float], series: Series) -> Trend | None:
    """The weighted line through the visits that have a value; None of fewer than three.

    Parameters
    ----------
    times : sequence of float
        Of every visit, in any unit.
    series : Series
        Values and their standard errors.

    Returns
    -------
    Trend or None
        b = Σw(t − t̄)v/Σw(t − t̄)² with w = 1/SEM², over the whole time from first to last visit.
    """
    rows = [
        (t, v, sem)
        for t, v, sem in zip(times, series.values, series.sems, strict=True)
        if v is not None and sem is not None and sem > 0.0
    ]
    if len(rows) < FEWEST:
        return None
    t, v, sem = map(np.array, zip(*rows, strict=True))
    w = sem**-2.0
    away = t - np.average(t, weights=w)
    across = float((w * away**2).sum())
    if not across > 0.0:
        return None
    slope = float((w * away * v).sum()) / across
    left = v - np.average(v, weights=w) - slope * away
    ratio = math.sqrt(max(float((w * left**2).sum()) / (len(rows) - 2), 1.0))
    span = max(times) - min(times)
    difference = slope * span
    sd = ratio * span / math.sqrt(across)
    return Trend(difference, sd, (difference - NORMAL * sd, difference + NORMAL * sd), ratio)


def rest_series(
    curves: Sequence[RelaxedCurve], angles: Sequence[float]
) -> tuple[dict[str, Series], str]:
    """What rest tells at every visit, over the range that all moved through; and why to doubt it.

    Parameters
    ----------
    curves : sequence of RelaxedCurve
        Of every visit.
    angles : sequence of float
        Where torque and stiffness are compared [deg].
    """
    moved = (max(c.moved[0] for c in curves), min(c.moved[1] for c in curves))
    sides: list[dict[str, Measure]] = []
    for curve in curves:
        common = replace(curve, moved=moved)
        measures = with_detectable_changes(
            measures_of_rest(common, angles), common, angles, laid=False
        )
        sides.append({m.name: m for m in measures})
    made = {}
    for name, first in sides[0].items():
        each = [side[name] for side in sides]
        made[name] = Series(
            name,
            first.unit,
            first.meaning,
            "rest",
            tuple(m.value if m.sdc is not None else None for m in each),
            tuple(None if m.sdc is None else m.sdc / (NORMAL * math.sqrt(2.0)) for m in each),
            first.from_deg,
            first.to_deg,
        )
    doubts = (doubt_between(curves[0], other) for other in curves[1:])
    return made, next((doubt for doubt in doubts if doubt), "")


def strength_series(visits: Sequence[Sequence[Effort]]) -> Mapping[str, Series]:
    """Strength at every visit; empty where no visit has a maximal effort."""
    if not any(visits):
        return {}
    made = {}
    for name, group in STRENGTH.items():
        strengths = [strength_of(efforts, group) for efforts in visits]
        made[name] = Series(
            name,
            "Nm",
            strength_meaning(group),
            "rest",
            tuple(None if each is None else each.torque for each in strengths),
            tuple(None if each is None else each.sd for each in strengths),
        )
    return made
