"""The torque of several recordings, a small panel each."""

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from surae.assessment import Prediction
from surae.estimation import FitResult
from surae.formatting import percentage
from surae.report.figures.style import (
    BLUE,
    GREY,
    INK,
    MUTED,
    WIDTH,
    dress,
    new_figure,
    shade_excluded,
    shared_legend,
    trace,
)
from surae.report.figures.torque import torque_figure
from surae.report.provenance import excluded_spans
from surae.report.traces import traces_of
from surae.units import FloatArray

#: Panels side by side, and height of a row [inch].
_COLUMNS, _ROW = 2, 1.55
#: Letters of a name that a panel has room for, an inch.
_LETTERS = 9


@dataclass(frozen=True, slots=True)
class TorquePanel:
    """Measured torque of a recording beside the one that `who` made of it, with a number to it."""

    name: str
    time: FloatArray
    measured: FloatArray
    other: FloatArray
    note: str = ""
    excluded: Sequence[tuple[int, int]] = ()


def torques_figure(
    panels: Sequence[TorquePanel], who: str = "modelled", *, width: float = WIDTH
) -> Figure:
    """A panel for each recording, all on one scale of torque.

    `who` is what the thin dark line is: ``"modelled"`` or ``"predicted"``; `width` is in inches.
    """
    columns = min(_COLUMNS, len(panels)) if width > 0.6 * WIDTH else 1
    rows = -(-len(panels) // columns)
    figure = new_figure(_ROW * rows + 0.5, width=width)
    grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
    for number, panel in enumerate(panels):
        row, column = divmod(number, columns)
        axes = grid[row, column]
        last = number + columns >= len(panels)
        dress(axes, "Torque [Nm]" if column == 0 else "", "Time [s]" if last else "")
        room = int(_LETTERS * width / columns)
        name = panel.name if len(panel.name) <= room else panel.name[: room - 1] + "…"
        axes.set_title(name, loc="left", fontsize=8, color=INK, weight="bold")
        axes.set_title(panel.note, loc="right", fontsize=8, color=MUTED)
        trace(axes, panel.time, panel.measured, label="measured", color=GREY, linewidth=3.0)
        trace(axes, panel.time, panel.other, label=who, color=BLUE, linewidth=1.0)
        shade_excluded(axes, panel.time, panel.excluded)
        axes.set_xlim(float(panel.time[0]), float(panel.time[-1]))
    for axes in grid.ravel()[len(panels) :]:
        axes.set_visible(False)
    shared_legend(figure, list(grid.ravel()[: len(panels)]), 3)
    return figure


def fit_figure(result: FitResult, notes: Sequence[str] = (), *, width: float = WIDTH) -> Figure:
    """The figure of a fit: of one recording all its signals, of several their torque.

    `notes` are a few letters on each recording, such as its R²; `width` is in inches.
    """
    traces = traces_of(result)
    if len(traces) == 1:
        return torque_figure(traces[0], width=width)
    panels = [
        TorquePanel(each.name, each.time, each.measured, each.modelled, note, each.excluded)
        for each, note in zip(traces, notes or [""] * len(traces), strict=True)
    ]
    return torques_figure(panels, width=width)


def predictions_figure(predictions: Sequence[Prediction], *, width: float = WIDTH) -> Figure:
    """The figure of a validation: measured and predicted torque, a panel for each recording."""
    panels = [
        TorquePanel(
            each.name, each.time, each.measured, each.torque, f"VAF {percentage(each.vaf)} %",
            excluded_spans(each.weight),
        )
        for each in predictions
    ]  # fmt: skip
    return torques_figure(panels, "predicted", width=width)
