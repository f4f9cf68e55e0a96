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
    footnote,
    heading,
    new_figure,
    shared_legend,
)
from surae_thesis.cohort.results import Point

#: A line for what is claimed or expected.
EXPECTED: dict[str, Any] = {"color": RED, "linewidth": 1.0, "linestyle": (0, (5, 2)), "zorder": 1}
_MEDIAN = {"color": INK, "linewidth": 1.3}
_MEAN = {"color": RED, "linewidth": 1.3, "linestyle": (0, (2, 1))}


@dataclass(frozen=True, slots=True)
class Box:
    """One box: numbers of recordings, and the thesis's mean beside it, where it gives one."""

    label: str
    points: Sequence[Point]
    thesis: float | None = None


@dataclass(frozen=True, slots=True)
class BoxPanel:
    """Boxes on one axis; numbers below `low` are told, not drawn."""

    title: str
    boxes: Sequence[Box]
    low: float


def vaf_figure(
    panels: Sequence[BoxPanel], remarked: Sequence[str] = (), ylabel: str = "VAF [%]"
) -> Figure:
    """Box plots of the variance accounted for, side by side.

    Those of remarked subjects, whose knee moved or whose ankle was misaligned, are crosses.
    """
    figure = new_figure(3.9)
    widths = [0.6 + len(panel.boxes) for panel in panels]
    several = figure.subplots(1, len(panels), squeeze=False, width_ratios=widths)[0]
    for axes, panel in zip(several, panels, strict=True):
        dress(axes, ylabel)
        heading(axes, panel.title)
        for at, box in enumerate(panel.boxes):
            _box(axes, at, [point.value for point in box.points])
            _dots(axes, at, box, panel.low, remarked)
        axes.plot([], [], label="median", **_MEDIAN)
        axes.plot([], [], label="mean", **_MEAN)
        axes.set_ylim(panel.low, 100.5)
        _name(axes, [box.label for box in panel.boxes])
    shared_legend(figure, list(several), 5, "outside lower center")
    return figure


def snsem_figure(ratios: Mapping[str, Sequence[float]], without: Mapping[str, int]) -> Figure:
    """Box plots of the standard errors over those of the simulations, on a logarithmic axis.

    By parameter, one number for each recording whose fit gives one; and how many are without.
    """
    figure = new_figure(4.1)
    axes = figure.subplots()
    dress(axes, "snSEM [-]")
    axes.axhline(1.0, **EXPECTED)
    for at, values in enumerate(ratios.values()):
        _box(axes, at, values)
    logarithmic(axes)
    _name(axes, [f"{n} ({without[n]})" if without.get(n) else n for n in ratios], rotation=60)
    footnote(
        figure,
        "Dashed: as in the simulations. In brackets: recordings whose fit gives no standard error, "
        "mostly since the estimate is at its bound.",
    )
    return figure


def error_figure(errors: Mapping[str, Mapping[str, Any]], looks: Sequence[Any]) -> Figure:
    """Box plots of relative errors [%] by way and parameter, on a logarithmic axis."""
    figure = new_figure(4.4)
    axes = figure.subplots()
    dress(axes, "Error against the truth [%]")
    axes.axhline(10.0, **EXPECTED)
    width = 0.8 / len(errors)
    for number, ((way, by_name), look) in enumerate(zip(errors.items(), looks, strict=False)):
        shift = (number - 0.5 * (len(errors) - 1)) * width
        for at, values in enumerate(by_name.values()):
            if len(values):
                axes.boxplot(
                    [np.maximum(values, 0.1)], positions=[at + shift], widths=0.85 * width,
                    patch_artist=True, showfliers=False, boxprops={**look, "linewidth": 0.7},
                    medianprops={"color": RED, "linewidth": 1.6},
                    whiskerprops={"linewidth": 0.7}, capprops={"linewidth": 0.7},
                )  # fmt: skip
        axes.bar(0, 0, label=way, **look)
    logarithmic(axes)
    _name(axes, list(by_name), rotation=45)
    shared_legend(figure, [axes], len(errors), "outside lower center")
    return figure


def logarithmic(axes: Axes) -> None:
    """A logarithmic axis with plain numbers."""
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")


def _name(axes: Axes, labels: Sequence[str], rotation: int = 0) -> None:
    turned: dict[str, Any] = {"ha": "right", "rotation_mode": "anchor"} if rotation else {}
    axes.grid(visible=False, axis="x")
    axes.set_xticks(range(len(labels)), labels, fontsize=8, rotation=rotation, **turned)
    axes.set_xlim(-0.7, len(labels) - 0.3)


def _box(axes: Axes, at: float, values: Sequence[float]) -> None:
    if len(values):
        axes.boxplot(
            [values], positions=[at], widths=0.55, showmeans=True, meanline=True,
            medianprops=_MEDIAN, meanprops=_MEAN, boxprops={"color": BLUE, "linewidth": 1.1},
            whiskerprops={"color": INK, "linewidth": 0.9},
            capprops={"color": INK, "linewidth": 0.9},
            flierprops={"marker": "+", "markeredgecolor": RED, "markersize": 5},
        )  # fmt: skip


def _dots(axes: Axes, at: int, box: Box, low: float, remarked: Sequence[str]) -> None:
    """Every recording, those out of the axis as a count, and the thesis's mean."""
    offsets = np.linspace(-0.2, 0.2, max(len(box.points), 1))
    for noted, marker, colour, label in (
        (False, "o", MUTED, "a recording"), (True, "x", INK, "knee moves or ankle misaligned"),
    ):  # fmt: skip
        shown = [
            (at + offset, point.value)
            for offset, point in zip(offsets, box.points, strict=False)
            if (point.subject in remarked) == noted
        ]
        if shown:
            axes.plot(
                *zip(*shown, strict=True), marker=marker, markersize=3.6, markeredgewidth=0.7,
                linestyle="none", markerfacecolor="none", markeredgecolor=colour, zorder=3,
                label=label,
            )  # fmt: skip
    if box.thesis is not None:
        axes.plot([at + 0.38], [box.thesis], marker="<", color=INK, markersize=6, clip_on=False,
                  linestyle="none", label="thesis's mean")  # fmt: skip
    below = sum(point.value < low for point in box.points)
    if below:
        axes.annotate(
            f"{below} lower", (at, low), textcoords="offset points", xytext=(0, 3), ha="center",
            fontsize=7, color=INK,
        )  # fmt: skip
