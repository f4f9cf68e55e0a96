"""Figures behind a fit: residual, correlation, uncertainty budget, and its own geometry."""

import math
from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from surae.base.units import FloatArray
from surae.inference import Whiteness
from surae.model import GeometryTable, ModelOptions
from surae.model.geometry import paths
from surae.model.joint import ANKLE
from surae.model.source_table import SOURCES
from surae.report import figures
from surae.report.budget import BudgetTable
from surae.report.figures import BLUE, GREY, INK, MUTED, OCHRE, RED, WIDTH

__all__ = ["budget_figure", "correlation_figure", "geometry_figure", "residual_figure"]


def residual_figure(
    time: FloatArray,
    residual: FloatArray,
    whiteness: Whiteness,
    excluded: Sequence[tuple[int, int]] = (),
) -> Figure:
    """Residual [Nm] against time, hatched where a fit left it out, and its autocorrelation."""
    figure = figures.new_figure(4.2)
    axes, correlated = figure.subplots(2)
    figures.dress(axes, "Residual [Nm]", "Time [s]")
    axes.axhline(0.0, color=MUTED, linewidth=0.7)
    figures.trace(axes, time, residual, color=INK, linewidth=0.7)
    axes.set_xlim(float(time[0]), float(time[-1]))
    if excluded:
        figures.shade_excluded(axes, time, excluded)
        figures.legend(axes, 1)

    figures.dress(correlated, "Autocorrelation [-]", "Lag [s]")
    lags = np.arange(len(whiteness.correlation)) / whiteness.rate_hz
    correlated.axhspan(
        -whiteness.band,
        whiteness.band,
        color=GREY,
        alpha=0.45,
        linewidth=0,
        label="95 % band of white noise (±1.96/√n)",
    )
    correlated.axhline(0.0, color=MUTED, linewidth=0.7)
    correlated.plot(
        lags,
        whiteness.correlation,
        color=BLUE,
        linewidth=1.1,
        marker="." if len(lags) < 100 else "",
        markersize=3,
    )
    correlated.set_xlim(0.0, float(lags[-1]))
    correlated.set_ylim(top=1.05)
    figures.legend(correlated, 1)
    return figure


#: Negative blue, none white, positive orange; equally dark at both ends.
_MAP = LinearSegmentedColormap.from_list("correlation", ["#2b5c9e", "#ffffff", "#b4531b"])
#: Correlation from which a cell is too dark for black figures.
_DARK = 0.8


def correlation_figure(
    names: Sequence[str], matrix: FloatArray, figure: Figure | None = None
) -> Figure:
    """Heat map of the correlations, on a new figure, or the one given.

    Values stand in the cells below the diagonal; those above it are the same.
    """
    k = len(names)
    side = min(WIDTH, 1.4 + 0.46 * k)
    figure = figures.new_figure(side) if figure is None else figure
    figure.set_size_inches(side, 0.93 * side)
    axes = figure.add_subplot()
    figures.dress(axes, "", grid=False)
    edges = np.arange(k + 1) - 0.5
    shades = axes.pcolormesh(
        edges, edges, matrix, cmap=_MAP, vmin=-1, vmax=1, edgecolors="white", linewidth=0.8
    )
    for column, row in combinations(range(k), 2):
        value = float(matrix[row, column])
        axes.text(
            column,
            row,
            _written(value),
            ha="center",
            va="center",
            fontsize=7,
            color="white" if abs(value) > _DARK else INK,
            in_layout=False,  # cells need no room of their own
        )
    axes.set_xticks(range(k), names, rotation=90, fontsize=8)
    axes.set_yticks(range(k), names, fontsize=8)
    axes.set(xlim=(-0.5, k - 0.5), ylim=(k - 0.5, -0.5), aspect="equal")
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    bar = figure.colorbar(shades, ax=axes, fraction=0.03, pad=0.02, ticks=[-1, -0.5, 0, 0.5, 1])
    bar.set_label("Correlation [-]", fontsize=9, color=INK)
    bar.ax.tick_params(labelsize=8, length=3)
    bar.outline.set_visible(False)
    return figure


def _written(value: float) -> str:
    """A correlation with two decimals, with three where two would make it perfect."""
    text = f"{value:.2f}"
    if abs(float(text)) == 1:
        text = f"{value:.3f}"
    return text.replace("-0.00", "0.00").replace("-", "−")


#: The palette's colours on paper.
_COLOURS = {
    "surface": "#ffffff",
    "measured": GREY,
    "ink": INK,
    "series-1": BLUE,
    "series-2": RED,
    "series-3": OCHRE,
    "series-6": MUTED,
}


def budget_figure(budget: BudgetTable) -> Figure:
    """Shares of the variance of every parameter, from 0 to 100 %, and how well it is known."""
    names = list(budget.rows)
    shares = 100.0 * np.array([shares for _, shares in budget.rows.values()])
    figure = figures.new_figure(1.1 + 0.2 * -(-len(budget.sources) // 3) + 0.24 * len(names))
    axes = figure.add_subplot()
    figures.dress(axes, "", "Share of the variance [%]", grid=False)
    begins = np.zeros(len(names))
    y = np.add.outer(range(len(names)), (-0.36, -0.36, 0.36, 0.36))
    for number, (source, label) in enumerate(zip(budget.sources, budget.labels, strict=True)):
        colour, hatch = SOURCES[source].look
        look: dict[str, Any] = {
            "facecolor": _COLOURS[colour],
            "hatch": 4 * hatch,
            "edgecolor": INK,
            "linewidth": 0.5,
        }
        ends = begins + shares[:, number]
        boxes = np.dstack((np.stack((begins, ends, ends, begins), axis=1), y))[ends > begins]
        axes.add_collection(PolyCollection(list(boxes), label=label, **look), autolim=False)
        begins = ends
    axes.set_yticks(range(len(names)), names)
    axes.set(xlim=(0.0, 100.0), ylim=(len(names) - 0.3, -0.7))
    axes.tick_params(axis="y", length=0)
    known = axes.secondary_yaxis("right")
    known.set_yticks(range(len(names)), [known for known, _ in budget.rows.values()], fontsize=8)
    known.tick_params(length=0, labelcolor=INK)
    known.spines["right"].set_visible(False)
    known.set_ylabel("known to (95 %)", fontsize=9, color=INK)
    figures.shared_legend(figure, [axes], 3)
    return figure


#: Points of a curve.
_POINTS = 200


def geometry_figure(options: ModelOptions, names: tuple[str, ...]) -> Figure:
    """Moment arm and change of length of both groups over the angle, and over a second one."""
    table = options.geometry
    assert isinstance(table, GeometryTable)
    angle = np.linspace(*table.range, _POINTS)
    still = np.zeros_like(angle)
    rest = int(np.argmin(np.abs(angle)))
    drawn: list[tuple[str, str, str, ModelOptions, tuple[FloatArray, ...]]] = [
        ("thesis, arms and printed lengths", MUTED, "-", ModelOptions(), ()),
        ("integral of the thesis’s arms", MUTED, "--", ModelOptions(geometry="virtual-work"), ()),
    ]
    if options.anatomy != ANKLE:  # the thesis has no other joint
        drawn = []
    drawn.append((table.name, BLUE, "-", options, ()))
    for second, line in zip(table.second[:: len(table.second) - 1 or 1], (":", "--"), strict=False):
        how = f"second angle {math.degrees(second):.0f}°"
        drawn.append((how, BLUE, line, options, (still + second, still)))
    figure = figures.new_figure(4.6)
    for group, name in enumerate(names):
        arm, length = (figure.add_subplot(2, 2, 1 + group + row) for row in (0, 2))
        figures.heading(arm, name)
        figures.dress(arm, "Moment arm\n[mm]")
        figures.dress(length, "Change of length\n[mm]", "Angle [°]")
        middle = 0.0
        for how, colour, style, of, at in drawn:
            path = paths(angle=angle, velocity=still, options=of, second=at)[group]
            if not at:
                middle = float(path.length[rest])
            look: dict[str, Any] = {"linewidth": 1.2, "color": colour, "linestyle": style}
            arm.plot(np.degrees(angle), 1e3 * np.abs(path.arm), label=how, **look)
            length.plot(np.degrees(angle), 1e3 * (path.length - middle), **look)
        if group == 0:
            figures.legend(arm, 1)
    return figure
