"""Box plots of the cohort, as the thesis's Figures 17, 21 to 23, 26, 27, 29, 30 and 32 to 35."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.report.figures import (
    BLUE,
    INK,
    MUTED,
    RED,
    Axes,
    Figure,
    dress,
    heading,
    new_figure,
    shared_legend,
)
from surae_thesis.cohort.results import Points
from surae_thesis.plots import footnote

_LINE: dict[str, Any] = {"color": RED, "linewidth": 1.0, "linestyle": (0, (5, 2)), "zorder": 1}
_MEDIAN: dict[str, Any] = {"color": INK, "linewidth": 1.3}
_MEAN: dict[str, Any] = {"color": RED, "linewidth": 1.3, "linestyle": (0, (2, 1))}


@dataclass(frozen=True, slots=True)
class Box:
    """One box: numbers of recordings, and the thesis's mean beside it, where it gives one."""

    label: str
    points: Points
    thesis: float | None = None


def vaf_figure(
    boxes: Sequence[Box], low: float, remarked: Sequence[str] = (), title: str = ""
) -> Figure:
    """Box plots of VAF, side by side; numbers below `low` are counted, not drawn.

    Those of remarked subjects, whose knee moved or whose ankle was misaligned, are crosses.
    """
    figure = new_figure(3.9)
    axes = figure.subplots()
    dress(axes, "VAF [%]")
    heading(axes, title)
    for at, box in enumerate(boxes):
        _box(axes, at, list(box.points.values()))
        for noted, marker, label in (
            (False, "o", "a recording"),
            (True, "x", "knee moves or ankle misaligned"),
        ):
            if noted and not remarked:
                continue
            values = [v for (who, _), v in box.points.items() if (who in remarked) == noted]
            places = at + np.linspace(-0.2, 0.2, max(len(values), 1))[: len(values)]
            axes.plot(
                places,
                values,
                marker,
                color=MUTED,
                markersize=3.6,
                label=label,
                markerfacecolor="none",
                markeredgewidth=0.7,
                zorder=3,
            )
        if box.thesis is not None:
            axes.plot([at + 0.38], [box.thesis], "<", color=INK, label="thesis's mean")
        below = sum(value < low for value in box.points.values())
        if below:
            axes.text(at, low, f"{below} lower", ha="center", va="bottom", fontsize=7, color=INK)
    axes.plot([], [], label="median", **_MEDIAN)
    axes.plot([], [], label="mean", **_MEAN)
    axes.set_ylim(low, 100.5)
    _name(axes, [box.label for box in boxes])
    shared_legend(figure, [axes], 5, "outside lower center")
    return figure


def snsem_figure(ratios: Mapping[str, Sequence[float]], without: Mapping[str, int]) -> Figure:
    """Box plots of the standard errors over those of the simulations, on a logarithmic axis.

    By parameter, one number for each recording whose fit gives one; and how many are without.
    """
    figure = new_figure(4.1)
    axes = figure.subplots()
    dress(axes, "snSEM [-]")
    axes.axhline(1.0, **_LINE)
    for at, values in enumerate(ratios.values()):
        _box(axes, at, values)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    _name(axes, [f"{n} ({without[n]})" if without.get(n) else n for n in ratios], rotation=60)
    footnote(
        figure,
        "Dashed: as in the simulations. In brackets: recordings whose fit gives no standard error, "
        "mostly since the estimate is at its bound.",
    )
    return figure


def _name(axes: Axes, labels: Sequence[str], rotation: int = 0) -> None:
    turned: dict[str, Any] = {"ha": "right", "rotation_mode": "anchor"} if rotation else {}
    axes.grid(visible=False, axis="x")
    axes.set_xticks(range(len(labels)), labels, fontsize=8, rotation=rotation, **turned)
    axes.set_xlim(-0.7, len(labels) - 0.3)


def _box(axes: Axes, at: float, values: Sequence[float]) -> None:
    if len(values):
        axes.boxplot(
            [values],
            positions=[at],
            widths=0.55,
            showmeans=True,
            meanline=True,
            medianprops=_MEDIAN,
            meanprops=_MEAN,
            boxprops={"color": BLUE, "linewidth": 1.1},
            flierprops={"marker": "+", "markeredgecolor": RED, "markersize": 5},
        )
