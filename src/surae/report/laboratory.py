"""What a fit with model auto says beyond the leg: the laboratory, the models, the trials."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from surae.assessment import Assessment, ParameterEstimate
from surae.assessment.adequacy import Grade
from surae.estimation import Candidate, Family, FitResult
from surae.estimation.each import trial_spread
from surae.formatting import NO_NUMBER, estimate, significant
from surae.model import get_model
from surae.model.laboratory import Belief, group_of
from surae.model.sources import NUISANCES, source_of
from surae.report.document import (
    Block,
    SectionBlock,
    TableBlock,
    TableCell,
    TableRow,
    TextBlock,
    columns,
    rows_of,
)

#: Units as people read them: factor and name.
_UNITS = {"s": (1e3, "ms"), "m": (1e3, "mm"), "rad": (57.29577951308232, "°"), "-": (1.0, "")}
#: Part of the assumed standard deviation up to which the data told a value, or a part of it.
_TOLD, _PARTLY = 0.5, 0.8
#: Standard deviations from what was assumed that are worth a word.
_UNUSUAL = 2.0
#: Probabilities from which a model is supported, and from which it is favoured.


@dataclass(frozen=True, slots=True)
class LaboratoryRow:
    """One imperfection: what was assumed of it, what came out, and who told it."""

    group: str
    name: str
    meaning: str
    unit: str
    prior: str
    value: str
    interval: str
    told: str


@dataclass(frozen=True, slots=True)
class LaboratorySection:
    """The imperfections of the laboratory, and the torque zero of each of several recordings."""

    text: str
    groups: tuple[tuple[str, str], ...]
    rows: tuple[LaboratoryRow, ...]
    zeros: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class FamilySection:
    """The models that were weighed: the two kinds of tendons, and other sets of imperfections."""

    text: str  #: What the evidence says.
    #: `models`, `variants`: model, imperfections in it, and its probability.
    models: tuple[tuple[str, str, str], ...]
    variants: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True, slots=True)
class TrialsRow:
    """One parameter over the recordings of a joint fit."""

    name: str
    unit: str
    value: str  #: Of all together.
    each: tuple[str, ...]  #: By each recording alone, ± its standard error.
    #: Standard deviation from trial to trial beyond those errors, as a part of the value, and what
    #: it is below in 95 %.
    spread: str


@dataclass(frozen=True, slots=True)
class TrialsSection:
    """What each recording of a joint fit says by itself, and how much they differ."""

    text: str
    recordings: tuple[str, ...]
    rows: tuple[TrialsRow, ...]


def laboratory_section(result: FitResult, assessment: Assessment) -> LaboratorySection | None:
    """What is not known of the laboratory; None for a named model, which takes it for perfect."""
    family = result.family
    if family is None:
        return None
    if not family.beliefs:
        return LaboratorySection(
            "The laboratory was taken for perfect, as asked: none of its imperfections is in the "
            "intervals.", (), (), (),
        )  # fmt: skip
    beliefs = {
        name: family.beliefs[name] for name in assessment.nuisances if name in family.beliefs
    }
    present = dict.fromkeys(group_of(name) for name in beliefs)
    several = len(result.problem.inputs) > 1 and len(family.zeros) == len(result.problem.inputs)
    return LaboratorySection(
        text=(
            "No laboratory can rule these out. Each was given what a careful laboratory knows of "
            "it beforehand, mean ± standard deviation, and estimated along with the leg; what "
            "stays unknown of it is in every interval of this report."
        ),
        groups=tuple((s.label, s.meaning) for group, s in NUISANCES.items() if group in present),
        rows=tuple(_row(assessment.nuisances[name], belief) for name, belief in beliefs.items()),
        zeros=tuple(
            (recording.name, f"{significant(zero, 3)} Nm")
            for recording, zero in zip(result.problem.inputs, family.zeros, strict=True)
        )
        if several
        else (),
    )


def _row(p: ParameterEstimate, belief: Belief) -> LaboratoryRow:
    factor, unit = _UNITS.get(p.unit, (1.0, p.unit))
    if p.unit == "-" and group_of(p.name) in ("crosstalk", "drift"):
        factor, unit = 100.0, "%"
    ends = None if p.ci95 is None else (factor * p.ci95[0], factor * p.ci95[1])
    sem = None if p.sem is None else factor * p.sem
    text = estimate(factor * p.value, sem, ends)
    mean, sd = (significant(factor * number, 2) for number in (belief.mean, belief.sd))
    return LaboratoryRow(
        group=source.label if (source := source_of(p.name)) else "",
        name=p.name,
        meaning=p.meaning,
        unit=unit,
        prior=f"{mean} ± {sd}",
        value=text.value,
        interval=text.interval,
        told=_told(p, belief),
    )


def _told(p: ParameterEstimate, belief: Belief) -> str:
    """Whether a value comes from the data or from what was assumed."""
    if p.at_bound:
        none = p.value == belief.off
        return "no sign of this" if none else "at the end of what is allowed: see the set-up"
    if p.sem is None:
        return NO_NUMBER
    part = p.sem / belief.sd
    text = (
        "told by the data" if part <= _TOLD else
        "told by the data in part" if part <= _PARTLY else
        "as assumed: the data say little"
    )  # fmt: skip
    away = abs(p.value - belief.mean) / belief.sd
    if away > _UNUSUAL:
        text += f"; {away:.1f} standard deviations from what was assumed"
    return text


def family_section(result: FitResult, assessment: Assessment) -> FamilySection | None:
    """Which models were weighed and what the evidence says; None for a named model."""
    family = result.family
    if family is None:
        return None
    chosen, *others = family.candidates
    models = [chosen, *(other for other in others if other.model != chosen.model)]
    variants = [other for other in others if other.model == chosen.model]
    return FamilySection(
        text=_support(family, assessment.adequacy.grade),
        models=tuple(map(_candidate, models)),
        variants=tuple(map(_candidate, variants)),
    )


def _candidate(candidate: Candidate) -> tuple[str, str, str]:
    groups = ", ".join(NUISANCES[group].label for group in candidate.groups) or "none"
    return _title(candidate.model), groups, _chance(candidate.weight)


def _support(family: Family, grade: Grade) -> str:
    if grade is Grade.INADEQUATE:
        return "The fit is inadequate: what the data ask for means nothing."
    chosen = family.candidates[0]
    departures = ", ".join(NUISANCES[group].label for group in chosen.groups)
    asked = f"The data ask for {departures}" if departures else "The data ask for no departure"
    return (
        f"{asked} (probability {_chance(chosen.weight)}). What other sets of departures would "
        "change is in the intervals."
    )


def trials_section(result: FitResult, assessment: Assessment) -> TrialsSection | None:
    """How the trials of a joint fit differ; None where that was not looked at."""
    family, problem = result.family, result.problem
    if family is None or not family.recordings:
        return None
    apart, rows = trial_spread(family.recordings), []
    for name, p in assessment.parameters.items():
        if not p.free or any(name not in alone.values for alone in family.recordings):
            continue
        each = [estimate(a.values[name], a.sem[name], (0.0, 0.0)) for a in family.recordings]
        likely, most = (100 * sd / abs(p.value) if p.value else np.inf for sd in apart[name])
        rows.append(
            TrialsRow(
                name=name,
                unit="" if p.unit == "-" else p.unit,
                value=estimate(p.value, p.trusted_sem, p.ci95).value,
                each=tuple(f"{text.value} ± {text.sem}" for text in each),
                spread=f"{significant(likely, 2)} % (< {significant(most, 2)} %)",
            )
        )
    return TrialsSection(
        "What each recording alone says, ± its standard error; what no trial has for itself, such "
        "as crosstalk, is as all together have it. The spread is the standard deviation from trial "
        "to trial beyond those errors, and in brackets what it is below with 95 % certainty: few "
        "recordings tell it badly. What it does to the common value is in its interval.",
        tuple(recording.name for recording in problem.inputs),
        tuple(rows),
    )


def laboratory_blocks(section: LaboratorySection | None) -> tuple[SectionBlock, ...]:
    """The laboratory's imperfections as they are shown."""
    if section is None:
        return ()
    blocks: list[Block] = [TextBlock(section.text)]
    if section.rows:
        groups = "; ".join(f"{group}: {meaning}" for group, meaning in section.groups)
        blocks.append(TextBlock(f"{groups}.", "note"))
        heads = columns("Imperfection", "Assumed", "Estimate", "95 % interval", "Unit",
                        "Source", numbers=(1, 3), wide=(0, 5),
                        looks={2: "number value", 4: "unit"})  # fmt: skip
        rows = (
            (TableCell(row.name, kind="code", meaning=row.meaning), row.prior, row.value,
             row.interval, row.unit or "–", row.told)
            for row in section.rows
        )  # fmt: skip
        title = "Imperfections: what was assumed and what came out"
        blocks.append(TableBlock(title, heads, rows_of(rows), "laboratory"))
    if section.zeros:
        zeros = ", ".join(f"{name} {zero}" for name, zero in section.zeros)
        blocks.append(TextBlock(f"Torque zero of each recording: {zeros}."))
    return (SectionBlock("The laboratory’s imperfections", tuple(blocks), "laboratory", "page"),)


def family_blocks(section: FamilySection | None) -> tuple[SectionBlock, ...]:
    """The models that were weighed as they are shown."""
    if section is None:
        return ()
    heads = columns("Model", "Imperfections in it", "Probability", numbers=(2,), wide=(1,))
    others = "Other sets of imperfections, in the intervals by their probability"
    tables = (
        TableBlock(caption, heads, rows_of(rows), "family", titled=True)
        for caption, rows in (
            ("Models that were weighed", section.models), (others, section.variants)
        )
        if rows
    )  # fmt: skip
    blocks: tuple[Block, ...] = (TextBlock(section.text), *tables)
    return (SectionBlock("Which model the data support", blocks, "family", "together"),)


def trials_blocks(section: TrialsSection | None) -> tuple[SectionBlock, ...]:
    """How trials differ as it is shown."""
    if section is None:
        return ()
    count = len(section.recordings)
    heads = columns("Parameter", "Unit", "Together", *section.recordings, "Spread",
                    numbers=range(2, 4 + count))  # fmt: skip
    rows: Iterator[TableRow] = (
        (TableCell(row.name, kind="code"), row.unit or "–", row.value, *row.each, row.spread)
        for row in section.rows
    )
    title = "Every parameter by recording, and its spread between trials"
    table = TableBlock(title, heads, rows_of(rows), "starts", repeated=2 if count > 6 else 0)
    return (
        SectionBlock("From trial to trial", (TextBlock(section.text), table), "trials", "together"),
    )


def _title(model: str) -> str:
    return get_model(model).title


def _chance(weight: float) -> str:
    """A probability in percent that never claims to be certain."""
    if weight > 0.99:
        return "> 99 %"
    return f"{100 * weight:.0f} %" if weight >= 0.01 else "< 1 %"
