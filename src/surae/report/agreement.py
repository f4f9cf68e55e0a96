"""Every parameter over the trials of a session: where fits agree, and where they do not."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from surae.assessment import Assessment, ParameterEstimate, Verdict
from surae.formatting import NO_NUMBER, estimate, significant
from surae.report.document import (
    Block,
    PictureBlock,
    SectionBlock,
    TableBlock,
    TableCell,
    TableRow,
    TextBlock,
    columns,
    paragraphs,
    rows_of,
)
from surae.report.figures import Figure
from surae.report.figures.session import trials_figure
from surae.report.parameters import shown_parameters

#: Of a parameter that trials leave anywhere within its bounds.
NOT_INFORMED = "not informed"


def agreement_section(
    alone: Mapping[str, Assessment],
    joint: Assessment | None,
    contradicted: Mapping[str, list[str]],
) -> SectionBlock:
    """Every parameter in every fit; none that is contradicted stands as identified."""
    rows: list[TableRow] = []
    for name, p in _estimated(alone, joint).items():
        cell = _disputed if name in contradicted else trial_cell
        own = [assessment.parameters.get(name) for assessment in alone.values()]
        rows.append((
            TableCell(name, kind="code", meaning=p.meaning),
            "" if p.unit == "-" else p.unit,
            *([] if joint is None else [cell(joint.parameters.get(name))]),
            *map(cell, own),
            spread([each for each in own if each is not None]),
        ))  # fmt: skip
    names = (*([] if joint is None else ["All together"]), *alone)
    heads = columns("Parameter", "Unit", *names, "Spread", numbers=(len(names) + 2,),
                    looks={1: "unit"} | {k + 2: "number column" for k in range(len(names))},
                    )  # fmt: skip
    note = (
        "Value and 95 % interval; bold is identified, and no trial contradicts it. Spread: "
        "standard deviation between the trials that inform a value, as a part of their mean. "
        "Agreement between trials does not exclude a shared bias."
    )
    table = TableBlock("Every parameter in every fit", heads, rows_of(rows), "small", repeated=2)
    picture = PictureBlock(
        "trials",
        "Each parameter by trial with its 95 % interval; the band is that of all together.",
        "Each parameter by trial, with its 95 % interval: dark where it is identified, open where "
        "there is no interval. Blue: all together. Intervals end at the bounds of the search.",
    )
    warnings = paragraphs(
        (
            f"{parameter}: {', '.join(apart)} and all together contradict each other; their 95 % "
            "intervals do not touch. Neither value can be trusted."
            for parameter, apart in contradicted.items()
        ),
        "warning",
    )
    blocks: tuple[Block, ...] = (*warnings, TextBlock(note, "note"), table, picture)
    return SectionBlock("Parameters by trial", blocks, "by-trial", "page")


def _estimated(
    alone: Mapping[str, Assessment], joint: Assessment | None
) -> dict[str, ParameterEstimate]:
    """The parameters that any fit estimated, each as the first one has it."""
    shown: dict[str, ParameterEstimate] = {}
    for assessment in (*([] if joint is None else [joint]), *alone.values()):
        shown |= {p.name: p for p in shown_parameters(assessment) if p.name not in shown and p.free}
    return shown


def agreement_figure(
    alone: Mapping[str, Assessment], joint: Assessment | None, *, width: float
) -> Figure:
    """Every parameter by trial, with its interval; that of all together as a band."""
    names = list(_estimated(alone, joint))
    return trials_figure(names, alone, joint, disputed=contradictions(alone, joint), width=width)


def contradictions(
    alone: Mapping[str, Assessment], joint: Assessment | None
) -> dict[str, list[str]]:
    """Trials whose 95 % interval and that of all together do not even touch, by parameter.

    An interval cannot say by itself that it is too narrow; another trial of the leg can.
    """
    contradicted = {}
    for p in () if joint is None else joint.parameters.values():
        if p.ci95 is None or not p.free:
            continue
        low, high = p.ci95
        apart = [
            name
            for name, assessment in alone.items()
            if (own := assessment.parameters.get(p.name)) is not None
            and own.ci95 is not None
            and (own.ci95[0] > high or own.ci95[1] < low)
        ]
        if apart:
            contradicted[p.name] = apart
    return contradicted


def trial_cell(p: ParameterEstimate | None) -> TableCell:
    """An estimate of one fit with its interval."""
    if p is None:
        return TableCell(NO_NUMBER)
    if p.ci95 is not None and not p.is_informed:
        return TableCell(NO_NUMBER, NOT_INFORMED, str(p.verdict))
    text = estimate(p.value, p.trusted_sem, p.ci95)
    under = text.interval if p.ci95 is not None else str(p.verdict)
    return TableCell(text.value, under, str(p.verdict))


def _disputed(p: ParameterEstimate | None) -> TableCell:
    cell = trial_cell(p)
    return replace(cell, kind="disputed" if cell.kind == Verdict.IDENTIFIED else cell.kind)


def spread(estimates: Sequence[ParameterEstimate]) -> str:
    """Standard deviation of the trials that say anything of it, as a part of their mean."""
    values = [p.value for p in estimates if p.is_informed]
    if not values and any(p.free and not p.at_bound for p in estimates):
        return NOT_INFORMED
    if len(values) < 2 or not np.mean(values):
        return NO_NUMBER
    part = float(np.std(values, ddof=1)) / abs(float(np.mean(values)))
    return f"{significant(100 * part, 2)} % of {len(values)}"
