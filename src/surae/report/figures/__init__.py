"""The figures of a report, each from plain data; importing this imports matplotlib."""

from surae.report.figures.correlation import correlation_figure
from surae.report.figures.drawings import drawings
from surae.report.figures.lines import line, shared_legend
from surae.report.figures.prediction import prediction_figure, predictions_figure
from surae.report.figures.residual import residual_figure
from surae.report.figures.style import (
    BLUE,
    GREY,
    INK,
    MUTED,
    OCHRE,
    RED,
    dress,
    figure_bytes,
    footnote,
    heading,
    legend,
    new_figure,
    pdf,
    png,
    svg,
    trace,
    write_figure,
)
from surae.report.figures.tendon import tendon_figure
from surae.report.figures.torque import torque_figure
from surae.report.figures.torques import TorquePanel, fit_figure, torques_figure
from surae.report.traces import traces_of

__all__ = [
    "BLUE",
    "GREY",
    "INK",
    "MUTED",
    "OCHRE",
    "RED",
    "TorquePanel",
    "correlation_figure",
    "drawings",
    "dress",
    "figure_bytes",
    "fit_figure",
    "footnote",
    "heading",
    "legend",
    "line",
    "new_figure",
    "pdf",
    "png",
    "prediction_figure",
    "predictions_figure",
    "residual_figure",
    "shared_legend",
    "svg",
    "tendon_figure",
    "torque_figure",
    "torques_figure",
    "trace",
    "traces_of",
    "write_figure",
]
