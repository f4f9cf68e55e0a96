"""The figures of a report, each from plain data; importing this imports matplotlib."""

from surae.report.figures.correlation import correlation_figure
from surae.report.figures.prediction import prediction_figure
from surae.report.figures.residual import residual_figure
from surae.report.figures.style import png, svg
from surae.report.figures.tendon import tendon_figure
from surae.report.figures.torque import torque_figure

__all__ = [
    "correlation_figure",
    "png",
    "prediction_figure",
    "residual_figure",
    "svg",
    "tendon_figure",
    "torque_figure",
]
