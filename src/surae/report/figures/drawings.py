"""All figures of a report, one after another."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure

from surae.assessment import Assessment, Prediction
from surae.report.content import Content
from surae.report.figures.budget import budget_figure
from surae.report.figures.correlation import correlation_figure
from surae.report.figures.residual import residual_figure
from surae.report.figures.tendon import tendon_figure
from surae.report.figures.torque import torque_figure
from surae.report.figures.torques import prediction_figure
from surae.report.traces import Traces


def drawings(
    content: Content,
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
    for number, prediction in enumerate(predictions):
        yield f"prediction-{number}", prediction_figure(prediction)
    if content.budget.rows:
        yield "budget", budget_figure(content.budget)
    section = content.correlation
    if len(section.names) > 1:
        matrix = np.array(section.matrix)
        yield (
            "correlation",
            correlation_figure(section.names, matrix, section.passive, section.active),
        )
