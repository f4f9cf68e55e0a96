"""The report of a fit: what it is worth, its numbers, its recordings, and how it came about."""

from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from itertools import chain

import numpy as np

from surae.base.formatting import NO_NUMBER, estimate, percentage, short, significant
from surae.inference import AssessedFit, Assessment, Interval, Prediction, Verdict
from surae.inference.judging.parameter import percent
from surae.inference.judging.verdict import IDENTIFIED
from surae.model import GeometryTable
from surae.report import block
from surae.report.budget import NEXT, BudgetTable, budget_of, budget_section
from surae.report.figures import Figure
from surae.report.figures.holds import are_holds, holds_figure, holds_section
from surae.report.figures.research import (
    budget_figure,
    correlation_figure,
    geometry_figure,
    residual_figure,
)
from surae.report.figures.tendon import film_figure, tendon_figure
from surae.report.figures.torque import predictions_figure, torque_figure
from surae.report.first import asked, first_screen, grade_line
from surae.report.invariants import invariants_section, is_invariant
from surae.report.laboratory import (
    family_section,
    known_section,
    laboratory_section,
    trials_section,
)
from surae.report.output import Report
from surae.report.parameters import parameters_section, shown_parameters
from surae.report.provenance import provenance_section
from surae.report.recordings import recording_section
from surae.report.sections import (
    correlation_section,
    geometry_section,
    identifiability_section,
    predictions_section,
)
from surae.report.traces import Traces, traces_of
from surae.report.trials import findings_section
from surae.report.wording import adequacy_words, summary

_BOUNDS = "converged, with parameters at a bound"


def fit_report(
    fit: AssessedFit,
    predictions: Sequence[Prediction] = (),
    *,
    versions: Mapping[str, str],
    created: datetime,
) -> Report:
    """The report of a fit; the same arguments give the same report.

    `predictions` are of other recordings.
    """
    result = fit.result
    assessment = fit.assessment
    traces = traces_of(result)
    budget = budget_of(fit)
    joint = result.problem.options.anatomy
    kicker = joint.worded("Ankle muscle parameters")
    first = first_screen(fit, traces)
    names = [recording.name for recording in assessment.recordings]
    recordings = (
        recording_section(number, *each)
        for number, each in enumerate(
            zip(assessment.recordings, traces, assessment.whiteness, strict=True)
        )
    )
    findings = {checked.recording: checked for checked in fit.quality}
    details = (
        invariants_section([m for m in first.measures if is_invariant(m)]),
        parameters_section(fit, next_anchor=NEXT if budget.helps else ""),
        *([findings_section(findings)] if findings else []),
        *([holds_section(traces)] if are_holds(traces) else []),
        *recordings,
    )
    research = (
        budget_section(budget),
        *known_section(result),
        *laboratory_section(fit),
        *family_section(fit),
        *trials_section(fit),
        correlation_section(assessment),
        identifiability_section(fit),
        *geometry_section(result),
        provenance_section(result, versions),
    )
    document = block.Document(
        kicker=kicker,
        heading=" + ".join(names),
        under=f"{asked(result)} {created.strftime('%Y-%m-%d %H:%M %Z').strip()}.",
        title=f"{kicker}: {', '.join(names)}",
        blocks=(
            grade_line(fit),
            first.section,
            _summary(fit, traces),
            *predictions_section(assessment, predictions, joint),
            block.Section("Details", details, "details", "more"),
            block.Section("Research", research, "research", "more"),
        ),
        footer=(
            "Made by surae for research. VAF is the part of the torque’s mean square that the "
            "model accounts for, equation (31); the mean is not subtracted. Equation numbers are "
            "those of the thesis Estimating ankle muscle parameters (van de Poll, 2015)."
        ),
    )
    figures = chain(first.figures.items(), _figures(fit, budget, traces, predictions))
    return Report(document, figures, traces)


def predictions_report(assessment: Assessment, predictions: Sequence[Prediction]) -> Report:
    """How other recordings are predicted, to be a part of a page."""
    page = block.Document("", "", "", "", predictions_section(assessment, predictions))
    return Report(page, [("predictions", predictions_figure(predictions))])


def _figures(
    fit: AssessedFit,
    budget: BudgetTable,
    traces: Sequence[Traces],
    predictions: Sequence[Prediction],
) -> Iterator[tuple[str, Figure]]:
    """Name and figure, such as ``"torque-0"``; the same on the page and on paper."""
    options = fit.result.problem.options
    for number, (trial, white) in enumerate(zip(traces, fit.assessment.whiteness, strict=True)):
        yield f"torque-{number}", torque_figure(trial)
        residual = residual_figure(trial.time, trial.residual, white, trial.excluded)
        yield f"residual-{number}", residual
        if trial.tendon is not None:
            yield f"tendon-{number}", tendon_figure(trial, trial.tendon)
        for place, film in enumerate(trial.films):
            yield f"film-{number}-{place}", film_figure(trial, film)
    if are_holds(traces):
        yield "holds", holds_figure(traces)
    if predictions:
        yield "predictions", predictions_figure(predictions)
    if budget.rows:
        yield "budget", budget_figure(budget)
    estimated = fit.assessment.covariance
    if len(estimated.names) > 1:
        yield "correlation", correlation_figure(estimated.names, estimated.correlation)
    if isinstance(options.geometry, GeometryTable):
        yield "geometry", geometry_figure(options, options.anatomy.headings)


def _summary(fit: AssessedFit, traces: Sequence[Traces]) -> block.Section:
    """What a reader sees first: what the fit is worth, a few numbers, and its parameters."""
    result = fit.result
    assessment = fit.assessment
    torque = np.concatenate([trial.measured[trial.counted] for trial in traces])
    rms = float(np.sqrt(np.mean(torque**2)))
    message = result.message if result.message.endswith(".") else f"{result.message}."
    count = len(traces)
    several = f", {count} recordings in one joint fit" if count > 1 else ""
    status = block.Text(
        f"{message[:1].upper()}{message[1:]}",
        f"status {result.status}",
        lead=f"Fit {_BOUNDS if result.status == 'at-bounds' else result.status}.",
    )
    blocks: tuple[block.Block, ...] = (
        adequacy_words(assessment.adequacy, fit.quality),
        status,
        block.Text(f"Fitted with the {result.problem.spec.title}{several}."),
        _key(fit, rms),
        *block.paragraphs(summary(fit)),
        _glance(assessment),
    )
    return block.Section("Summary", blocks, "summary")


def _key(fit: AssessedFit, rms: float) -> block.KeyFigures:
    result = fit.result
    assessment = fit.assessment
    parameters = assessment.parameters.values()
    free = sum(p.free for p in parameters)
    identified = sum(p.verdict is Verdict.IDENTIFIED for p in parameters)
    failed = result.status == "failed"
    vaf = f"of the whole torque, VAF {percentage(assessment.vaf)} %"
    if assessment.interval is Interval.MARGINAL:
        repeatable = sum(p.repeatable for p in parameters)
        last = (
            "Parameters repeatable",
            NO_NUMBER if failed else f"{repeatable} of {free}",
            "another trial would give the same",
        )
    else:
        agreeing = f"{result.solution.agreeing} of {len(result.solution.starts)}"
        last = ("Starts that agree", agreeing, "on the best minimum")
    r2 = percentage(assessment.adequacy.r2)
    rmse = significant(assessment.rmse, 3)
    return block.KeyFigures(
        (
            ("Torque’s changes followed, R²", f"{r2} %", "no minimum reached" if failed else vaf),
            ("Root mean square error", f"{rmse} Nm", f"torque itself {significant(rms, 3)} Nm"),
            (
                "Parameters identified",
                NO_NUMBER if failed else f"{identified} of {free}",
                f"95 % interval within ±{percent(IDENTIFIED)}",
            ),
            last,
        )
    )


def _glance(assessment: Assessment) -> block.Grid:
    """The parameters by verdict, each with its value and unit."""
    by_verdict: dict[Verdict, list[tuple[str, str]]] = {}
    for p in shown_parameters(assessment):
        text = "undetermined"
        if p.verdict is not Verdict.UNDETERMINED or p.ci95 is not None:
            value = estimate(p.value, p.trusted_sem, p.ci95).value if p.free else short(p.value)
            text = value if p.unit == "-" else f"{value} {p.unit}"
        by_verdict.setdefault(p.verdict, []).append((p.name, text))
    rows = (
        (block.verdict(each), block.Cell(pairs=tuple(by_verdict[each])))
        for each in Verdict
        if each in by_verdict
    )
    heads = block.columns("", "", wide=(1,))
    return block.Grid("Parameters by verdict", heads, block.rows(rows), "glance", titled=True)
