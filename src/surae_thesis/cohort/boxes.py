"""Box plots of the cohort, as the thesis's Figures 17, 21 to 23, 26, 27, 29, 30 and 32 to 35."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from surae.report.figures import (
    BLUE,
    INK,
    MUTED,
    RED,
    dress,
    footnote,
    heading,
    new_figure,
)
from surae_thesis.cohort.results import Point

#: Subjects with a remark are drawn with this marker.
_REMARKED, _PLAIN = "x", "o"


@dataclass(frozen=True, slots=True)
class Box:
    """One box: numbers of recordings, and the thesis's mean beside it, where it gives one."""

    label: str
    points: Sequence[Point]
    thesis: float | None = None


@dataclass(frozen=True, slots=True)
class Panel:
    """Boxes on one axis; numbers below `low` are told, not drawn."""

    title: str
    boxes: Sequence[Box]
    low: float
    high: float = 100.5


def vaf_figure(panels: Sequence[Panel], remarked: Sequence[str], ylabel: str = "VAF [%]") -> Figure:
    """Box plots of the variance accounted for.

    Parameters
    ----------
    panels : sequence of Panel
        Side by side.
    remarked : sequence of str
        Subjects whose knee moved or whose ankle was misaligned: crosses among the dots.
    ylabel : str
        What is drawn, with its unit.
    """
    figure = new_figure(3.9)
    widths = [0.6 + len(panel.boxes) for panel in panels]
    grid = figure.subplots(1, len(panels), squeeze=False, width_ratios=widths)[0]
    for axes, panel in zip(grid, panels, strict=True):
        dress(axes, ylabel)
        heading(axes, panel.title)
        axes.grid(visible=False, axis="x")
        for at, box in enumerate(panel.boxes):
            _box(axes, at, np.array([one.value for one in box.points]))
            _dots(axes, at, box, panel, remarked)
        axes.set_ylim(panel.low, panel.high)
        axes.set_xticks(range(len(panel.boxes)), [box.label for box in panel.boxes], fontsize=8)
        axes.set_xlim(-0.6, len(panel.boxes) - 0.4)
    _legend(figure, panels, remarked)
    return figure


def snsem_figure(found: dict[str, list[float]], without: dict[str, int]) -> Figure:
    """Box plots of the standard errors over those of the simulations, on a logarithmic axis.

    Parameters
    ----------
    found : dict of str to list of float
        By parameter, one number for each recording whose fit gives a standard error.
    without : dict of str to int
        Recordings whose fit gives none, by parameter.
    """
    figure = new_figure(4.1)
    axes = figure.subplots()
    dress(axes, "snSEM [-]")
    axes.grid(visible=False, axis="x")
    axes.axhline(1.0, color=RED, linewidth=1.0, linestyle=(0, (5, 2)), zorder=1)
    for at, values in enumerate(found.values()):
        if values:
            _box(axes, at, np.array(values))
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    labels = [f"{n} ({without[n]})" if without.get(n) else n for n in found]
    axes.set_xticks(range(len(found)), labels, rotation=60, ha="right", rotation_mode="anchor")
    axes.set_xlim(-0.7, len(found) - 0.3)
    footnote(
        figure,
        "Dashed: as in the simulations. In brackets: recordings whose fit gives no standard error, "
        "mostly since the estimate is at its bound.",
    )
    return figure


def _box(axes: Axes, at: float, values: Any) -> None:
    if not len(values):
        return
    axes.boxplot(
        [values], positions=[at], widths=0.55, showmeans=True, meanline=True, showfliers=True,
        medianprops={"color": INK, "linewidth": 1.3},
        meanprops={"color": RED, "linewidth": 1.3, "linestyle": (0, (2, 1))},
        boxprops={"color": BLUE, "linewidth": 1.1},
        whiskerprops={"color": INK, "linewidth": 0.9},
        capprops={"color": INK, "linewidth": 0.9},
        flierprops={"marker": "+", "markeredgecolor": RED, "markersize": 5},
    )  # fmt: skip


def _dots(axes: Axes, at: int, box: Box, panel: Panel, remarked: Sequence[str]) -> None:
    """Every recording, those out of the axis as a count, and the thesis's mean."""
    values = [one.value for one in box.points]
    offsets = np.linspace(-0.2, 0.2, max(len(values), 1))
    for marker, chosen in ((_PLAIN, False), (_REMARKED, True)):
        shown = [
            (at + offset, one.value)
            for offset, one in zip(offsets, box.points, strict=False)
            if (one.subject in remarked) == chosen
        ]
        if shown:
            x, y = zip(*shown, strict=True)
            axes.plot(
                x, y, marker=marker, markersize=3.6, markeredgewidth=0.7, linestyle="none",
                markerfacecolor="none", markeredgecolor=INK if chosen else MUTED, zorder=3,
            )  # fmt: skip
    if box.thesis is not None:
        axes.plot([at + 0.38], [box.thesis], marker="<", color=INK, markersize=6, clip_on=False)
    below = sum(value < panel.low for value in values)
    if below:
        axes.annotate(
            f"{below} lower", (at, panel.low), textcoords="offset points", xytext=(0, 3),
            ha="center", fontsize=7, color=INK,
        )  # fmt: skip


def _legend(figure: Figure, panels: Sequence[Panel], remarked: Sequence[str]) -> None:
    handles = [
        Line2D([], [], color=INK, linewidth=1.3, label="median"),
        Line2D([], [], color=RED, linewidth=1.3, linestyle=(0, (2, 1)), label="mean"),
        Line2D([], [], color=MUTED, marker=_PLAIN, markerfacecolor="none", linestyle="none",
               markersize=4, label="a recording"),
    ]  # fmt: skip
    shown = {one.subject for panel in panels for box in panel.boxes for one in box.points}
    if shown & set(remarked):
        handles.append(
            Line2D([], [], color=INK, marker=_REMARKED, linestyle="none", markersize=4,
                   label="knee moves or ankle misaligned")
        )  # fmt: skip
    if any(box.thesis is not None for panel in panels for box in panel.boxes):
        handles.append(
            Line2D([], [], color=INK, marker="<", linestyle="none", label="thesis's mean")
        )
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, fontsize=8,
        labelcolor=INK,
    )  # fmt: skip
