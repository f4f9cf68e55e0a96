"""The parameter table: every number as text, and where in its bounds an estimate lies."""

import math
from dataclasses import dataclass

from surae.assessment import Assessment, ParameterEstimate, Verdict
from surae.report.digits import NONE, estimate, short

#: Titles of the groups of parameters.
_GROUPS = {
    "limb": "Limb",
    "passive": "Passive: muscle tissue",
    "active": "Active: contraction",
    "tendon": "Tendon",
}
_VERDICTS = {
    Verdict.IDENTIFIED: "identified",
    Verdict.WEAK: "weak",
    Verdict.AT_BOUND: "at bound",
    Verdict.FIXED: "fixed",
}


@dataclass(frozen=True, slots=True)
class Bar:
    """Where an estimate and its interval lie between the bounds, as parts from 0 to 1.

    Attributes
    ----------
    value : float
        The estimate.
    low, high : float or None
        Ends of the interval, cut off at the bounds; None without an interval.
    beyond_low, beyond_high : bool
        Whether the interval was cut off at that end.
    alt : str
        The bar in words.
    """

    value: float
    low: float | None
    high: float | None
    beyond_low: bool
    beyond_high: bool
    alt: str


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One row of the table.

    Attributes
    ----------
    name, meaning, unit, value, interval, sem, bounds, verdict, verdict_text, note : str
        The cells; a dash where there is no number.
    determined : bool
        False when the torque leaves the value open, which then says nothing.
    bar : Bar or None
        None for a parameter that was not estimated.
    """

    name: str
    meaning: str
    unit: str
    value: str
    interval: str
    sem: str
    bounds: str
    verdict: str
    verdict_text: str
    note: str
    determined: bool
    bar: Bar | None


@dataclass(frozen=True, slots=True)
class ParameterGroup:
    """The rows that act on one part of the torque."""

    title: str
    rows: tuple[ParameterRow, ...]


def parameter_groups(assessment: Assessment) -> tuple[ParameterGroup, ...]:
    """All parameters of a fit, by the part of the torque they act on."""
    rows: dict[str, list[ParameterRow]] = {}
    for p in assessment.parameters.values():
        rows.setdefault(p.group, []).append(_row(p))
    return tuple(ParameterGroup(_GROUPS.get(g, g), tuple(some)) for g, some in rows.items())


def _row(p: ParameterEstimate) -> ParameterRow:
    written = estimate(p.value, p.sem, p.ci95) if p.free else None
    return ParameterRow(
        name=p.name,
        meaning=p.meaning,
        unit="" if p.unit == "-" else p.unit,
        value=written.value if written else short(p.value),
        interval=written.interval if written else NONE,
        sem=written.sem if written else NONE,
        bounds=f"{short(p.lower)} … {short(p.upper)}" if p.free else NONE,
        verdict=str(p.verdict),
        verdict_text=_VERDICTS[p.verdict],
        note=p.note,
        determined=p.verdict is not Verdict.WEAK or p.ci95 is not None,
        bar=_bar(p) if p.free and math.isfinite(p.value) else None,
    )


def _bar(p: ParameterEstimate) -> Bar:
    def place(value: float) -> float:
        return min(max((value - p.lower) / (p.upper - p.lower), 0.0), 1.0)

    value = place(p.value)
    alt = f"at {100 * value:.0f} % of the way from the lower to the upper bound"
    if p.ci95 is None:
        return Bar(value, None, None, False, False, f"{alt}, no interval")
    low, high = p.ci95
    return Bar(
        value,
        place(low),
        place(high),
        low < p.lower,
        high > p.upper,
        f"{alt}, interval from {100 * place(low):.0f} to {100 * place(high):.0f} %",
    )
