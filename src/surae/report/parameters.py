"""The parameter table: every number as text, and where in its bounds an estimate lies."""

import math

from surae.base.formatting import NO_NUMBER, estimate, short, standard_error
from surae.inference import AssessedFit, Assessment, Interval, ParameterEstimate, Prior, Verdict
from surae.model.laboratory import group_of
from surae.report import block
from surae.report.provenance import prior_note, prior_span
from surae.report.wording import FAILED, intervals

#: Titles of the groups of parameters.
_GROUPS = {
    "limb": "Limb",
    "passive": "Passive: muscle tissue",
    "active": "Active: contraction",
    "tendon": "Tendon",
}


def parameters_section(fit: AssessedFit, *, next_anchor: str) -> block.Section:
    """All parameters by the part of the torque they act on; weak ones lead to `next_anchor`."""
    result = fit.result
    assessment = fit.assessment
    priors = result.problem.priors
    interval = assessment.interval
    marginal = interval is Interval.MARGINAL
    groups: dict[str, list[tuple[block.AnyCell, ...]]] = {}
    for p in shown_parameters(assessment):
        row = _row(p, priors.get(p.name), next_anchor)
        groups.setdefault(p.group, []).append(row[:3] + row[5:] if marginal else row)
    if marginal:
        note = result.problem.options.anatomy.worded(
            "Repeatable: another trial of this leg would give the same within 10 %; below it, "
            "where its value would lie (95 %). What all trials of the leg share, such as "
            "crosstalk, is not in that."
        )
    else:
        sem = "robust SEM" if interval is Interval.ROBUST else "SEM (34)"
        note = (
            "SEM (34): standard error of the mean, equation (34), which assumes a white residual. "
            "Robust SEM: the same for a residual that is correlated as this one is. The 95 % "
            f"interval is Student’s t times the {sem} on either side. Repeatable: it is within "
            "10 % of the value."
        )
    note += (
        " Bar: the estimate (dark mark) and its interval (band) between the bounds; an arrow says "
        "that the interval goes on beyond the bound."
    )
    if priors:
        note += " Thin line below: the prior, one standard deviation to either side."
    heads = [
        block.Heading("Parameter"),
        block.Heading("Value", "number value"),
        block.Heading("95 % interval", "number"),
        block.Heading("SEM (34)", "number value" if interval is Interval.THESIS else "number"),
        block.Heading("Robust SEM", "number value" if interval is Interval.ROBUST else "number"),
        block.Heading("Unit", "unit"),
        block.Heading("Between its bounds", "where"),
        block.Heading("Repeatable", "repeat"),
        block.Heading("Verdict", "judgement", wide=True),
    ]
    table = block.Grid(
        "Estimates of all parameters with their uncertainty",
        tuple(heads[:3] + heads[5:] if marginal else heads),
        tuple((_GROUPS.get(group, group), tuple(rows)) for group, rows in groups.items()),
        "parameters",
    )
    failed = result.status == "failed"
    allowed = block.Text(FAILED, "warning") if failed else block.Text(intervals(assessment), "note")
    blocks: tuple[block.Block, ...] = (
        block.Text(note, "note"),
        *([allowed] * bool(allowed.text)),
        table,
    )
    return block.Section("Parameters", blocks, "parameters", "page")


def shown_parameters(assessment: Assessment) -> list[ParameterEstimate]:
    """The leg's parameters, without imperfections of the laboratory that have nothing to act on."""
    has_laboratory = bool(assessment.nuisances)
    return [
        p
        for p in assessment.parameters.values()
        if p.free or not (has_laboratory and group_of(p.name))
    ]


def repeatable(p: ParameterEstimate) -> str:
    """Whether another trial of the leg would give the same; a dash where nobody can tell."""
    return NO_NUMBER if p.ci95_repeat is None else "yes" if p.repeatable else "no"


def _row(p: ParameterEstimate, prior: Prior | None, next_anchor: str) -> tuple[block.AnyCell, ...]:
    text = estimate(p.value, p.trusted_sem, p.ci95) if p.free else None
    again = ""
    if p.ci95_repeat not in (None, p.ci95):
        again = estimate(p.value, p.trusted_sem, p.ci95_repeat).interval
    why = "; ".join(
        filter(None, (p.note, prior_note(prior, p.value, p.trusted_sem) if prior else ""))
    )
    unsure = p.verdict in (Verdict.WEAK, Verdict.UNDETERMINED)
    bar = _bar(p, prior) if p.free and math.isfinite(p.value) else None
    return (
        block.Cell(p.name, kind="code", meaning=p.meaning),
        text.value if text else short(p.value),
        text.interval if text else NO_NUMBER,
        standard_error(p.sem),
        standard_error(p.sem_robust),
        "–" if p.unit == "-" else p.unit,
        block.Cell(
            NO_NUMBER if bar is None else "",
            bar=bar,
            under=f"{short(p.lower)} … {short(p.upper)}" if bar else "",
        ),
        block.Cell(repeatable(p), under=again),
        block.verdict(p.verdict, why=why, link=next_anchor if unsure else ""),
    )


def _bar(p: ParameterEstimate, prior: Prior | None) -> block.IntervalBar:
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
        return block.IntervalBar(value, None, None, False, False, known, f"{alt}, no interval")
    low, high = p.ci95
    alt += f", interval from {100 * place(low):.0f} to {100 * place(high):.0f} %"
    return block.IntervalBar(
        value, place(low), place(high), low < p.lower, high > p.upper, known, alt
    )
