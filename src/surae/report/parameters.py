"""The parameter table: every number as text, and where in its bounds an estimate lies."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from surae.assessment import Assessment, ParameterEstimate, Verdict
from surae.estimation import Prior
from surae.model.laboratory import group_of
from surae.report.formatting import NO_NUMBER, estimate, short, standard_error
from surae.report.provenance import prior_note, prior_span

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
    Verdict.UNDETERMINED: "undetermined",
    Verdict.AT_BOUND: "at bound",
    Verdict.FIXED: "fixed",
}


@dataclass(frozen=True, slots=True)
class Bar:
    """An estimate and its interval between the bounds, as parts from 0 to 1."""

    value: float  #: The estimate.
    #: `low`, `high`: ends of the interval, cut off at the bounds; None without an interval.
    low: float | None
    high: float | None
    #: `beyond_low`, `beyond_high`: whether the interval was cut off at that end.
    beyond_low: bool
    beyond_high: bool
    #: Lower end, median and upper end of the prior, cut off at the bounds.
    prior: tuple[float, float, float] | None
    alt: str  #: The bar in words.


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One row of the table."""

    #: `name`, `meaning`, `unit`, `value`, `interval`, `sem`, `sem_robust`, `bounds`, `verdict`,
    #: `verdict_text`, `note`: the cells; a dash where there is no number.
    name: str
    meaning: str
    unit: str
    value: str
    interval: str
    sem: str
    sem_robust: str
    bounds: str
    verdict: str
    verdict_text: str
    note: str
    #: `repeatable`, `repeat_interval`: whether another trial of the leg would give the same value,
    #: ``"yes"``, ``"no"`` or a dash, and the 95 % interval of what it would give; empty where that
    #: is the parameter's own.
    repeatable: str
    repeat_interval: str
    prior: str  #: The prior in words; empty without one.
    determined: bool  #: False when the torque leaves the value open, which then says nothing.
    bar: Bar | None  #: None for a parameter that was not estimated.


@dataclass(frozen=True, slots=True)
class ParameterGroup:
    """The rows that act on one part of the torque."""

    title: str
    rows: tuple[ParameterRow, ...]


def parameter_groups(
    assessment: Assessment, priors: Mapping[str, Prior]
) -> tuple[ParameterGroup, ...]:
    """All parameters of a fit, by the part of the torque they act on."""
    rows: dict[str, list[ParameterRow]] = {}
    for p in shown_parameters(assessment):
        rows.setdefault(p.group, []).append(_row(p, priors.get(p.name)))
    return tuple(ParameterGroup(_GROUPS.get(g, g), tuple(some)) for g, some in rows.items())


def shown_parameters(assessment: Assessment) -> list[ParameterEstimate]:
    """The leg's parameters, without imperfections of the laboratory that have nothing to act on."""
    held = bool(assessment.nuisances)
    return [p for p in assessment.parameters.values() if p.free or not (held and group_of(p.name))]


def repeatable(p: ParameterEstimate) -> str:
    """Whether another trial of the leg would give the same; a dash where nobody can tell."""
    return NO_NUMBER if p.ci95_repeat is None else "yes" if p.repeatable else "no"


def _row(p: ParameterEstimate, prior: Prior | None) -> ParameterRow:
    written = estimate(p.value, p.trusted_sem, p.ci95) if p.free else None
    return ParameterRow(
        name=p.name,
        meaning=p.meaning,
        unit="" if p.unit == "-" else p.unit,
        value=written.value if written else short(p.value),
        interval=written.interval if written else NO_NUMBER,
        sem=standard_error(p.sem),
        sem_robust=standard_error(p.sem_robust),
        bounds=f"{short(p.lower)} … {short(p.upper)}" if p.free else NO_NUMBER,
        verdict=str(p.verdict),
        verdict_text=_VERDICTS[p.verdict],
        note=p.note,
        repeatable=repeatable(p),
        repeat_interval=""
        if p.ci95_repeat in (None, p.ci95)
        else estimate(p.value, p.trusted_sem, p.ci95_repeat).interval,
        prior=prior_note(prior, p.value, p.trusted_sem) if prior else "",
        determined=p.verdict is not Verdict.UNDETERMINED or p.ci95 is not None,
        bar=_bar(p, prior) if p.free and math.isfinite(p.value) else None,
    )


def _bar(p: ParameterEstimate, prior: Prior | None) -> Bar:
    def place(value: float) -> float:
        return min(max((value - p.lower) / (p.upper - p.lower), 0.0), 1.0)

    value = place(p.value)
    alt = f"at {100 * value:.0f} % of the way from the lower to the upper bound"
    known = None
    if prior is not None:
        low, median, high = map(place, prior_span(prior))
        known = low, median, high
        alt += f", prior from {100 * low:.0f} to {100 * high:.0f} %"
    if p.ci95 is None:
        return Bar(value, None, None, False, False, known, f"{alt}, no interval")
    low, high = p.ci95
    return Bar(
        value,
        place(low),
        place(high),
        low < p.lower,
        high > p.upper,
        known,
        f"{alt}, interval from {100 * place(low):.0f} to {100 * place(high):.0f} %",
    )
