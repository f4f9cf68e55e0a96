"""What a report of a fit says, section by section."""

from collections.abc import Mapping, Sequence
from datetime import datetime

import numpy as np

from surae.assessment import Assessment, Interval, Prediction, Verdict
from surae.estimation import FitResult
from surae.formatting import NO_NUMBER, estimate, percentage, short, significant
from surae.quality import Quality
from surae.report.budget import NEXT, BudgetTable, budget_section
from surae.report.document import (
    Block,
    Document,
    KeyFigures,
    SectionBlock,
    TableBlock,
    TableCell,
    TextBlock,
    columns,
    paragraphs,
    rows_of,
    verdict,
)
from surae.report.identifiability import identifiability_section
from surae.report.laboratory import family_section, laboratory_section, trials_section
from surae.report.parameters import parameters_section, shown_parameters
from surae.report.provenance import provenance_section
from surae.report.recordings import recording_section
from surae.report.sections import (
    correlation_section,
    geometry_section,
    predictions_section,
    quality_section,
    starts_section,
)
from surae.report.traces import Traces
from surae.report.wording import adequacy_words, closeness, summary

_STATUS = {
    "converged": "converged",
    "at-bounds": "converged, with parameters at a bound",
    "failed": "failed",
}


def fit_document(
    result: FitResult,
    assessment: Assessment,
    traces: tuple[Traces, ...],
    budget: BudgetTable,
    *,
    versions: Mapping[str, str],
    created: datetime,
    predictions: Sequence[Prediction] = (),
    quality: Sequence[Quality] = (),
) -> Document:
    """Put a fit and its assessment into words.

    `versions` are those of the programs that made the fit; `predictions` are of other recordings;
    `quality` is what was found in each recording before the fit.
    """
    names = [recording.name for recording in assessment.recordings]
    several = f", {len(names)} recordings in one joint fit" if len(names) > 1 else ""
    recordings = (
        recording_section(number, *each)
        for number, each in enumerate(
            zip(assessment.recordings, traces, assessment.whiteness, strict=True)
        )
    )
    return Document(
        kicker="Ankle muscle parameters",
        heading=" + ".join(names),
        under=(
            f"Fitted with the {result.problem.spec.title}{several}. Report of "
            f"{created.strftime('%Y-%m-%d %H:%M %Z').strip()}."
        ),
        title=f"Ankle muscle parameters: {', '.join(names)}",
        blocks=(
            _summary(result, assessment, traces),
            *predictions_section(assessment, predictions),
            SectionBlock(
                "Details",
                (
                    parameters_section(
                        result, assessment, next_anchor=NEXT if budget.helps else ""
                    ),
                    *quality_section(quality, traces),
                    *recordings,
                ),
                "details",
                "more",
            ),
            SectionBlock(
                "Research",
                (
                    budget_section(budget),
                    *laboratory_section(result, assessment),
                    *family_section(result, assessment),
                    *trials_section(result, assessment),
                    correlation_section(assessment),
                    identifiability_section(result, assessment),
                    *geometry_section(result),
                    starts_section(result),
                    provenance_section(result, assessment, versions),
                ),
                "research",
                "more",
            ),
        ),
        footer=(
            "Made by surae for research. VAF is the part of the torque’s mean square that the "
            "model accounts for, equation (31); the mean is not subtracted. Equation numbers are "
            "those of the thesis Estimating ankle muscle parameters (van de Poll, 2015)."
        ),
    )


def _summary(result: FitResult, assessment: Assessment, traces: Sequence[Traces]) -> SectionBlock:
    """What a reader sees first: what the fit is worth, a few numbers, and its parameters."""
    torque = np.concatenate([trial.measured[trial.counted] for trial in traces])
    rms = float(np.sqrt(np.mean(torque**2)))
    message = result.message if result.message.endswith(".") else f"{result.message}."
    status = TextBlock(
        f"{message[:1].upper()}{message[1:]}",
        f"status {result.status}",
        lead=f"Fit {_STATUS.get(result.status, result.status)}.",
    )
    blocks: tuple[Block, ...] = (
        adequacy_words(assessment.adequacy),
        status,
        _key(result, assessment, rms),
        *paragraphs(summary(result, assessment, rms)),
        _glance(assessment),
    )
    return SectionBlock("Summary", blocks, "summary")


def _key(result: FitResult, assessment: Assessment, rms: float) -> KeyFigures:
    parameters = assessment.parameters.values()
    free = sum(p.free for p in parameters)
    identified = sum(p.verdict is Verdict.IDENTIFIED for p in parameters)
    failed = result.status == "failed"
    robust = assessment.interval is Interval.ROBUST and not failed
    coloured = not all(whiteness.white for whiteness in assessment.whiteness)
    followed = f"{closeness(assessment.adequacy.r2)}; with its mean, VAF "
    followed = "no minimum reached" if failed else f"{followed}{percentage(assessment.vaf)} %"
    allowed = ""
    if result.family is not None:
        allowed = "measurement errors accounted for"
    elif robust:
        allowed = "correlation of the residual allowed for" if coloured else "robust errors"
    if result.family is not None:
        repeatable = sum(p.repeatable for p in parameters)
        last = (
            "Parameters repeatable",
            NO_NUMBER if failed else f"{repeatable} of {free}",
            "another trial would give the same",
        )
    else:
        agreeing = f"{result.agreeing} of {len(result.starts)}"
        last = ("Starts that agree", agreeing, "on the best minimum")
    r2, rmse = percentage(assessment.adequacy.r2), significant(assessment.rmse, 3)
    return KeyFigures((
        ("Torque’s changes followed, R²", f"{r2} %", followed),
        ("Root mean square error", f"{rmse} Nm", f"torque itself {significant(rms, 3)} Nm"),
        ("Parameters identified", NO_NUMBER if failed else f"{identified} of {free}", allowed),
        last,
    ))  # fmt: skip


def _glance(assessment: Assessment) -> TableBlock:
    """The parameters by verdict, each with its value and unit."""
    by_verdict: dict[Verdict, list[tuple[str, str]]] = {}
    for p in shown_parameters(assessment):
        text = "undetermined"
        if p.verdict is not Verdict.UNDETERMINED or p.ci95 is not None:
            value = estimate(p.value, p.trusted_sem, p.ci95).value if p.free else short(p.value)
            text = value if p.unit == "-" else f"{value} {p.unit}"
        by_verdict.setdefault(p.verdict, []).append((p.name, text))
    rows = (
        (verdict(each), TableCell(pairs=tuple(by_verdict[each])))
        for each in Verdict
        if each in by_verdict
    )
    heads = columns("", "", wide=(1,))
    return TableBlock("Parameters by verdict", heads, rows_of(rows), "glance", titled=True)
