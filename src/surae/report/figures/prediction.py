"""Measured torque beside the one predicted from other recordings, like Figure 31 of the thesis."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from surae.assessment import Prediction
from surae.report.excluded import excluded_spans
from surae.report.figures.style import (
    BLUE,
    GREY,
    INK,
    WIDTH,
    dress,
    heading,
    legend,
    new_figure,
    shade_excluded,
    trace,
)
from surae.report.figures.torques import TorquePanel, torques_figure
from surae.report.formatting import percentage


def predictions_figure(predictions: Sequence[Prediction], *, width: float = WIDTH) -> Figure:
    """The figure of a validation: of one recording also what is left over, of several a panel each.

    Parameters
    ----------
    predictions : sequence of Prediction
        At least one.
    width : float
        Width of the figure [inch].
    """
    if len(predictions) == 1:
        return prediction_figure(predictions[0], width=width)
    panels = [
        TorquePanel(
            each.name, each.time, each.measured, each.torque, f"VAF {percentage(each.vaf)} %",
            excluded_spans(each.weight),
        )
        for each in predictions
    ]  # fmt: skip
    return torques_figure(panels, "predicted", width=width)


def prediction_figure(prediction: Prediction, *, width: float = WIDTH) -> Figure:
    """Two panels against time: both torques, and measured minus predicted."""
    figure = new_figure(4.2, width=width)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    time, spans = prediction.time, excluded_spans(prediction.weight)
    dress(above, "Torque [Nm]")
    heading(above, "Torque, triceps positive")
    trace(above, time, prediction.measured, label="measured", color=GREY, linewidth=3.0)
    trace(above, time, prediction.torque, label="predicted", color=BLUE, linewidth=1.0)
    shade_excluded(above, time, spans)
    legend(above, 3)
    dress(below, "Torque [Nm]", "Time [s]")
    heading(below, "Measured minus predicted")
    trace(below, time, prediction.measured - prediction.torque, color=INK, linewidth=0.7)
    shade_excluded(below, time, spans)
    below.set_xlim(float(time[0]), float(time[-1]))
    figure.align_ylabels()
    return figure
