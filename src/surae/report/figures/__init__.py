"""The figures of a report, each from plain data; importing this imports matplotlib.

Nothing else imports it, so that no ``matplotlibrc`` of the current folder is obeyed.
"""

from surae.working_folder import ignoring

with ignoring("matplotlibrc"):
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

from surae.report.figures.correlation import correlation_figure
from surae.report.figures.residual import residual_figure
from surae.report.figures.style import (
    BLUE,
    GREY,
    INK,
    MUTED,
    OCHRE,
    RED,
    data_url,
    dress,
    footnote,
    heading,
    legend,
    line,
    new_figure,
    pdf,
    png,
    shared_legend,
    svg,
    trace,
    write_figure,
)
from surae.report.figures.tendon import tendon_figure
from surae.report.figures.torque import torque_figure
from surae.report.figures.torques import (
    TorquePanel,
    fit_figure,
    predictions_figure,
    torques_figure,
)
from surae.report.traces import traces_of

__all__ = [
    "BLUE",
    "GREY",
    "INK",
    "MUTED",
    "OCHRE",
    "RED",
    "Axes",
    "Figure",
    "TorquePanel",
    "correlation_figure",
    "data_url",
    "dress",
    "fit_figure",
    "footnote",
    "heading",
    "legend",
    "line",
    "new_figure",
    "pdf",
    "png",
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
