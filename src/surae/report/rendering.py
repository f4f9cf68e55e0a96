"""Reports of fits, sessions and predictions: their documents with their figures."""

from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from itertools import chain

from surae.assessment import Assessment, Prediction
from surae.estimation import FitResult
from surae.model import GeometryTable
from surae.quality import Quality
from surae.report.budget import BudgetTable, budget_of
from surae.report.content import fit_document
from surae.report.document import Document
from surae.report.figures import (
    Figure,
    correlation_figure,
    prediction_figure,
    residual_figure,
    tendon_figure,
    torque_figure,
)
from surae.report.figures.budget import budget_figure
from surae.report.figures.film import film_figure
from surae.report.figures.geometry import geometry_figure
from surae.report.figures.joint import relabelled
from surae.report.joint import reworded
from surae.report.output import Report
from surae.report.recordings import GROUPS
from surae.report.sections import predictions_section
from surae.report.traces import Traces, traces_of


def fit_report(
    result: FitResult,
    assessment: Assessment,
    predictions: Sequence[Prediction] = (),
    *,
    versions: Mapping[str, str],
    created: datetime,
    quality: Sequence[Quality] = (),
) -> Report:
    """The report of a fit.

    `versions` are those of the programs that made the fit, `created` is when the report is made,
    `predictions` are of other recordings, `quality` is what was found in each recording before it
    was fitted. The same arguments give the same report.
    """
    traces, budget = traces_of(result), budget_of(result, assessment)
    document = fit_document(
        result, assessment, traces, budget, predictions=predictions, versions=versions,
        created=created, quality=quality,
    )  # fmt: skip
    figures = drawings(budget, traces, assessment, predictions)
    joint = result.problem.options.anatomy
    if isinstance(result.problem.options.geometry, GeometryTable):
        figures = chain(figures, [("geometry", geometry_figure(result.problem.options, GROUPS))])
    return Report(reworded(joint, document), relabelled(joint, figures), traces)


def predictions_report(assessment: Assessment, predictions: Sequence[Prediction]) -> Report:
    """How other recordings are predicted, to be a part of a page."""
    drawn = ((f"prediction-{k}", prediction_figure(p)) for k, p in enumerate(predictions))
    return Report(Document("", "", "", "", predictions_section(assessment, predictions)), drawn)


def drawings(
    budget: BudgetTable,
    traces: Sequence[Traces],
    assessment: Assessment,
    predictions: Sequence[Prediction],
) -> Iterator[tuple[str, Figure]]:
    """Name and figure, such as ``"torque-0"``; the same on the page and on paper."""
    for number, (trial, white) in enumerate(zip(traces, assessment.whiteness, strict=True)):
        yield f"torque-{number}", torque_figure(trial)
        residual = residual_figure(trial.time, trial.residual, white, trial.excluded)
        yield f"residual-{number}", residual
        if trial.tendon is not None:
            yield f"tendon-{number}", tendon_figure(trial, trial.tendon)
        for place, film in enumerate(trial.films):
            yield f"film-{number}-{place}", film_figure(trial, film)
    for number, prediction in enumerate(predictions):
        yield f"prediction-{number}", prediction_figure(prediction)
    if budget.rows:
        yield "budget", budget_figure(budget)
    estimated = assessment.covariance
    if len(estimated.names) > 1:
        group = {p.name: p.group for p in assessment.parameters.values()}
        passive, active = (
            [name for name in estimated.names if group[name] == part]
            for part in ("passive", "active")
        )
        yield (
            "correlation",
            correlation_figure(estimated.names, estimated.correlation, passive, active),
        )
