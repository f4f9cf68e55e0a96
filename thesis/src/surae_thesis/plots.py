"""Figures as data: panels of lines with their labels, drawn in the look of surae's reports."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from textwrap import wrap
from typing import Any

import numpy as np

from surae.report.figures import (
    BLUE,
    INK,
    MUTED,
    OCHRE,
    RED,
    Axes,
    Figure,
    dress,
    heading,
    legend,
    new_figure,
    shared_legend,
    trace,
)

#: A look of a line or a marker, in matplotlib's words.
Look = Mapping[str, Any]
#: Letters of a footnote in an inch.
_LETTERS = 14
#: A colour and a dash each.
_LINES = ((BLUE, "-"), (RED, (0, (4, 1.5))), (OCHRE, (0, (1, 1.2))), (MUTED, (0, (5, 1, 1, 1))))
#: A marker for every round of the lines.
_MARKERS = "os^DvPX*"


def line(number: int) -> dict[str, Any]:
    """Look of the line of this number, for `Axes.plot`; all differ up to 32."""
    colour, dash = _LINES[number % len(_LINES)]
    turn = number // len(_LINES)
    return {
        "color": colour,
        "linestyle": dash,
        "linewidth": 1.1,
        "marker": _MARKERS[turn % len(_MARKERS)],
        "markersize": 4.2,
        "markerfacecolor": colour if turn % 2 == 0 else "white",
    }


def footnote(figure: Figure, text: str) -> None:
    """A quiet line below all panels, broken where the figure is too narrow for it."""
    if text:
        lines = wrap(text, int(_LETTERS * figure.get_figwidth()))
        figure.supxlabel("\n".join(lines), fontsize=8, color=MUTED)


@dataclass(frozen=True, slots=True)
class PlotLine:
    """Numbers against others, both of shape (n,), with a look; without a marker it is a trace."""

    x: Any
    y: Any
    label: str = ""
    look: Look = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Panel:
    """Lines on one axis, labels with units.

    `at` is of `matplotlib.axes.Axes.set`; `across` and `down` are quiet lines at these places;
    `legend` has the columns of its own legend, none with 0.
    """

    ylabel: str
    lines: Sequence[PlotLine] = ()
    xlabel: str = ""
    title: str = ""
    at: Look = field(default_factory=dict)
    across: Sequence[float] = ()
    down: Sequence[float] = ()
    legend: int = 0


def draw(
    panels: Sequence[Panel],
    height: float,
    *,
    columns: int = 1,
    shared: int = 0,
    note: str = "",
    **grid: Any,
) -> Figure:
    """Draw panels in the order of reading, in columns, on a figure of a height [inch].

    A legend of all panels together has `shared` columns, none with 0; a note is a line below; the
    rest is for `matplotlib.figure.Figure.subplots`.
    """
    figure = new_figure(height)
    axes = figure.subplots(-(-len(panels) // columns), columns, squeeze=False, **grid).ravel()
    for place, panel in zip(axes, panels, strict=True):
        fill(place, panel)
    if shared:
        shared_legend(figure, list(axes), shared)
    footnote(figure, note)
    return figure


def fill(axes: Axes, panel: Panel) -> None:
    """Draw a panel on an axis."""
    dress(axes, panel.ylabel, panel.xlabel)
    if panel.title:
        heading(axes, panel.title)
    for height in panel.across:
        axes.axhline(height, color=MUTED, linewidth=0.8, zorder=1)
    for place in panel.down:
        axes.axvline(place, color=MUTED, linewidth=0.8, zorder=1)
    for line in panel.lines:
        look: dict[str, Any] = {"color": INK, "linewidth": 1.0, **line.look}
        if "marker" in look:
            axes.plot(line.x, line.y, label=line.label or "_", **look)
        else:
            trace(axes, np.asarray(line.x), np.asarray(line.y), label=line.label, **look)
    axes.set(**panel.at)
    for axis, name in ((axes.xaxis, "xscale"), (axes.yaxis, "yscale")):
        if panel.at.get(name) == "log":
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter("")
    if panel.legend:
        legend(axes, panel.legend)
