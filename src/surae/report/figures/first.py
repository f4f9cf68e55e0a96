"""The first picture of a fit: torque measured and modelled over time with its parts."""

from collections.abc import Sequence
from dataclasses import fields, replace
from functools import reduce

import numpy as np

from surae.base.units import FloatArray
from surae.model.simulator import TorqueParts
from surae.report import figures
from surae.report.figures import INK, MUTED, Figure
from surae.report.figures.torque import draw_angle, draw_parts, draw_torque, shown_span
from surae.report.traces import Traces
from surae.signals.cycles import find_cycles

#: Recordings that stand beside each other at most; all others are below.
SHOWN = 8
#: Width and height of the figure, and of its panels [inch].
_WIDTH = 6.6
_HEIGHT = 5.0
_PANELS = (1.0, 2.0, 1.9)
#: Between two panels [inch]: a heading, and a legend below it.
_BETWEEN = 0.46
#: Part of the time that is left empty between recordings, and letters that an inch has room for.
_GAP = 0.02
_LETTERS = 11


def first_figure(traces: Sequence[Traces]) -> Figure:
    """Angle, torque measured and modelled, and its parts; recordings stand beside each other."""
    shown = traces[:SHOWN]
    whole = reduce(_beside, [_begun(each) for each in shown])
    figure = figures.new_figure(_HEIGHT, width=_WIDTH, layout=None)
    grid = figure.subplots(3, 1, sharex=True, gridspec_kw={"height_ratios": _PANELS})
    figures.space(figure, len(grid), between=_BETWEEN)
    rows = [(axes,) for axes in grid]
    draw_angle(rows[0], whole)
    draw_torque(rows[1], whole)
    draw_parts(rows[2], whole)
    if len(shown) == 1:
        cycles = find_cycles(whole.angle, whole.rate_hz, whole.counted)
        grid[-1].set_xlim(*shown_span(whole, cycles))
    else:
        grid[-1].set_xlim(float(whole.time[0]), float(whole.time[-1]))
        _name(grid, shown, whole)
    return figure


def _name(grid: Sequence[figures.Axes], shown: Sequence[Traces], whole: Traces) -> None:
    """Say which recording stands where: its name above, a line where another begins."""
    seconds = [float(each.time[-1] - each.time[0]) for each in shown]
    gap = _GAP * sum(seconds)
    begins = np.cumsum([0.0, *(length + gap for length in seconds)])
    for axes in grid:
        for begin in begins[1:-1]:
            axes.axvline(begin - 0.5 * gap, color=MUTED, linewidth=0.8)
    span = float(whole.time[-1] - whole.time[0])
    for number, (each, begin, length) in enumerate(zip(shown, begins, seconds, strict=False), 1):
        room = int(_LETTERS * (_WIDTH - 1.0) * length / span)
        name = each.name if len(each.name) <= room else f"{number}"
        grid[0].text(
            begin + 0.5 * length,
            0.97,
            name,
            transform=grid[0].get_xaxis_transform(),
            ha="center",
            va="top",
            fontsize=7,
            color=INK,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5},
        )
    grid[-1].set_xlabel("Time [s], one recording after the other", fontsize=9, color=INK)


def _begun(traces: Traces) -> Traces:
    """A recording whose time begins at nought."""
    return replace(traces, time=traces.time - traces.time[0])


def _beside(first: Traces, second: Traces) -> Traces:
    """Two recordings one after the other, a sample of nothing between them."""
    gap = _GAP * float(first.time[-1] + second.time[-1])
    begin = float(first.time[-1]) + gap
    time = np.concatenate([first.time, [begin - 0.5 * gap], begin + second.time])
    return replace(
        first,
        time=time,
        angle=_after(first.angle, second.angle),
        measured=_after(first.measured, second.measured),
        modelled=_after(first.modelled, second.modelled),
        parts=_parts(first, second),
        weight=np.concatenate([_weight(first), [1.0], _weight(second)]),
    )


def _weight(traces: Traces) -> FloatArray:
    return np.ones(len(traces.time)) if traces.weight is None else traces.weight


def _after(first: FloatArray, second: FloatArray) -> FloatArray:
    return np.concatenate([first, [np.nan], second])


def _parts(first: Traces, second: Traces) -> TorqueParts:
    """Parts of both; what one of them lacks is nought there."""
    joined: dict[str, FloatArray | None] = {}
    for each in fields(TorqueParts):
        one, other = (getattr(of.parts, each.name) for of in (first, second))
        if one is None and other is None:
            joined[each.name] = None
            continue
        one = np.zeros(len(first.time)) if one is None else one
        other = np.zeros(len(second.time)) if other is None else other
        joined[each.name] = _after(one, other)
    return TorqueParts(**joined)  # type: ignore[arg-type]
