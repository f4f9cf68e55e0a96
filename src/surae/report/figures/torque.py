"""What went in, what came out and what it is made of: beside time, and over the cycle."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.base.formatting import percentage, significant
from surae.base.units import FloatArray, on_page
from surae.inference import FitResult, Prediction
from surae.recording import MUSCLES
from surae.report import figures
from surae.report.figures import BLUE, GREY, INK, MUTED, OCHRE, RED, WIDTH
from surae.report.provenance import excluded_spans
from surae.report.traces import PARTS, Traces, traces_of
from surae.signals.cycles import Cycles, find_cycles

__all__ = [
    "draw_angle",
    "draw_parts",
    "draw_torque",
    "fit_figure",
    "predictions_figure",
    "shown_span",
    "torque_figure",
]

#: Heights [inch] of a strip of EMG, the angle, a panel of torque, and of what surrounds them.
_STRIP = 0.52
_ANGLE = 1.35
_TORQUE = 2.2
_ROOM = 0.7
#: Of more cycles than this, the panels against time show as many from the middle: all are a smudge.
_SHOWN = 8
#: Width [inch] from which there is room for two columns.
_BOTH = 5.5

_Row: TypeAlias = tuple[Axes, ...]
_Look: TypeAlias = dict[str, Any]
# A wide pale line below a thin dark one: where they part is visible without any hue.
_MEASURED: _Look = {"color": GREY, "linewidth": 3.0}
_MODELLED: _Look = {"color": BLUE, "linewidth": 1.0}


def torque_figure(traces: Traces, *, width: float = WIDTH, figure: Figure | None = None) -> Figure:
    """Figure like 18–20 of the thesis: what went in, what came out, and what it is made of.

    A movement that repeats itself has a second column, where there is room (`width` [inch]): mean
    and standard deviation over the cycle.
    """
    cycles = find_cycles(traces.angle, traces.rate_hz, traces.counted)
    muscles = [muscle for muscle in MUSCLES if muscle not in traces.missing_emg]
    heights = [_STRIP * len(muscles)] * bool(muscles) + [_ANGLE, _TORQUE, _TORQUE]
    both = cycles is not None and width > _BOTH
    height = (_ROOM + sum(heights)) * (0.6 * WIDTH + 0.4 * width) / WIDTH  # narrower, if less so
    wide = width >= WIDTH and not both  # legends stand beside their headings
    layout: Literal["constrained"] | None = None if wide else "constrained"
    figure = figures.new_figure(height, width=width, layout=layout) if figure is None else figure
    figure.set_size_inches(width, height)
    grid = figure.subplots(
        len(heights),
        2 if both else 1,
        squeeze=False,
        sharex="col",
        sharey="row",
        gridspec_kw={"height_ratios": heights, "width_ratios": (3, 2) if both else (1,)},
    )
    if wide:
        figures.space(figure, len(heights))
    rows: list[_Row] = [tuple(row) for row in grid]
    if muscles:
        _emg(rows[0], traces, muscles, cycles)
    draw_angle(rows[-3], traces, cycles)
    draw_torque(rows[-2], traces, cycles)
    draw_parts(rows[-1], traces, cycles)
    rows[-1][0].set_xlim(*shown_span(traces, cycles))
    if cycles is not None and len(cycles.spans) > _SHOWN:
        rows[-1][0].set_xlabel(f"Time [s], {_SHOWN} of {len(cycles.spans)} cycles")
    if both and cycles is not None:
        count = len(cycles.spans)
        rows[0][1].set_title(f"Mean ± SD of {count} cycles", loc="left", fontsize=9, color=INK)
        rows[-1][1].set_xlabel(f"Cycle of {cycles.seconds:.2f} s [%]", fontsize=9, color=INK)
        rows[-1][1].set_xlim(0.0, 100.0)
    if not wide:
        figures.align(figure)
    return figure


def shown_span(traces: Traces, cycles: Cycles | None) -> tuple[float, float]:
    """From when to when [s] to show: some cycles from the middle where there are many."""
    if cycles is None or len(cycles.spans) <= _SHOWN:
        return float(traces.time[0]), float(traces.time[-1])
    first = (len(cycles.spans) - _SHOWN) // 2
    some = cycles.spans[first : first + _SHOWN]
    return float(traces.time[some[0][0]]), float(traces.time[some[-1][1] - 1])


def _draw(
    row: _Row,
    traces: Traces,
    cycles: Cycles | None,
    values: FloatArray,
    look: _Look,
    name: str = "",
) -> None:
    """A signal against time, and over the cycle."""
    figures.trace(row[0], traces.time, values, label=name, **look)
    if cycles is not None and len(row) > 1:
        share, mean, spread = cycles.over(values)
        row[1].fill_between(
            share, mean - spread, mean + spread, color=look["color"], alpha=0.22, linewidth=0
        )
        row[1].plot(share, mean, **look)


def _dress(row: _Row, ylabel: str, xlabel: str = "") -> None:
    figures.dress(row[0], ylabel, xlabel)
    for axes in row[1:]:
        figures.dress(axes, "")


def _emg(row: _Row, traces: Traces, muscles: Sequence[str], cycles: Cycles | None) -> None:
    """Envelopes one above the other, on one scale."""
    unit, factor = on_page(traces.emg_unit)
    signals = traces.emg * factor
    height = 1.08 * (float(signals.max()) or 1.0)
    _dress(row, f"EMG [{unit}]" if unit == "mV" else "EMG")
    look = {"color": INK, "linewidth": 0.7}
    at = height * np.arange(len(muscles))[::-1]
    for level, muscle in zip(at, muscles, strict=True):
        _draw(row, traces, cycles, signals[:, MUSCLES.index(muscle)] + level, look)
    row[0].set_ylim(0.0, height * len(muscles))
    row[0].set_yticks(at, [muscle.upper() for muscle in muscles], va="bottom")
    figures.heading(row[0], f"EMG, each from 0 to {significant(height, 2)}")


def draw_angle(row: _Row, traces: Traces, cycles: Cycles | None = None) -> None:
    """The angle [°] against time, and over the cycle where there is a column."""
    _dress(row, "Angle [°]")
    figures.heading(row[0], traces.joint.worded("Ankle angle, dorsiflexion positive"))
    _draw(row, traces, cycles, np.degrees(traces.angle), {"color": INK, "linewidth": 1.1})


def draw_torque(row: _Row, traces: Traces, cycles: Cycles | None = None) -> None:
    """Measured and modelled torque against time, and over the cycle where there is a column."""
    _dress(row, "Torque [Nm]")
    figures.heading(row[0], traces.joint.worded("Torque, triceps positive"))
    _draw(row, traces, cycles, traces.measured, _MEASURED, "measured")
    _draw(row, traces, cycles, traces.modelled, _MODELLED, "modelled")
    figures.shade_excluded(row[0], traces.time, traces.excluded)
    figures.legend(row[0], 3)


def draw_parts(row: _Row, traces: Traces, cycles: Cycles | None = None) -> None:
    """What the modelled torque is made of, likewise."""
    _dress(row, "Torque [Nm]", "Time [s]")
    figures.heading(row[0], "Parts of the modelled torque")
    parts = traces.parts
    looks: list[tuple[str, _Look]] = [
        ("tissue", {"color": RED, "linewidth": 2.0, "linestyle": "solid"}),
        ("neural", {"color": BLUE, "linewidth": 1.0, "linestyle": "solid"}),
        ("inertial", {"color": INK, "linewidth": 1.0, "linestyle": (0, (1, 1.2))}),
        ("gravitational", {"color": OCHRE, "linewidth": 1.5, "linestyle": (0, (5, 2))}),
    ]
    if parts.reflex is not None:  # within what the muscles add, not beside it
        looks.append(("reflex", {"color": INK, "linewidth": 1.2, "linestyle": (0, (4, 1, 1, 1))}))
    if parts.zero is not None:
        looks.append(("zero", {"color": MUTED, "linewidth": 2.0, "linestyle": (0, (2, 3))}))
    for name, look in looks:
        _draw(row, traces, cycles, getattr(parts, name), look, PARTS.get(name, name))
    figures.legend(row[0], len(looks))


#: Panels side by side, and height of a row [inch].
_COLUMNS = 2
_ROW = 1.55
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
    """A panel for each recording on one scale; `who` is what the thin dark line is."""
    columns = min(_COLUMNS, len(panels)) if width > 0.6 * WIDTH else 1
    rows = -(-len(panels) // columns)
    figure = figures.new_figure(_ROW * rows + 0.5, width=width)
    grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
    for number, panel in enumerate(panels):
        row, column = divmod(number, columns)
        axes = grid[row, column]
        last = number + columns >= len(panels)
        figures.dress(axes, "Torque [Nm]" if column == 0 else "", "Time [s]" if last else "")
        room = int(_LETTERS * width / columns)
        name = panel.name if len(panel.name) <= room else panel.name[: room - 1] + "…"
        axes.set_title(name, loc="left", fontsize=8, color=INK, weight="bold")
        axes.set_title(panel.note, loc="right", fontsize=8, color=MUTED)
        figures.trace(axes, panel.time, panel.measured, label="measured", color=GREY, linewidth=3.0)
        figures.trace(axes, panel.time, panel.other, label=who, color=BLUE, linewidth=1.0)
        figures.shade_excluded(axes, panel.time, panel.excluded)
        axes.set_xlim(float(panel.time[0]), float(panel.time[-1]))
    for axes in grid.ravel()[len(panels) :]:
        axes.set_visible(False)
    figures.shared_legend(figure, list(grid.ravel()[: len(panels)]), 3)
    return figure


def fit_figure(result: FitResult, notes: Sequence[str] = (), *, width: float = WIDTH) -> Figure:
    """The figure of a fit: of one recording all its signals, of several torque with `notes`."""
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
            each.name,
            each.time,
            each.measured,
            each.torque,
            f"VAF {percentage(each.vaf)} %",
            excluded_spans(each.weight),
        )
        for each in predictions
    ]
    return torques_figure(panels, "predicted", width=width)
