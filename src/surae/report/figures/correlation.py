"""How the estimates depend on one another (thesis Figure 28)."""

from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from surae.report.figures.style import INK, WIDTH, dress, new_figure
from surae.units import FloatArray

#: Negative blue, none white, positive orange; equally dark at both ends.
_COLOURS = LinearSegmentedColormap.from_list("correlation", ["#2b5c9e", "#ffffff", "#b4531b"])
#: Correlation from which a cell is too dark for black figures.
_DARK = 0.8
#: Correlation below which the sign is of no interest.
_SIGNED = 0.095


def correlation_figure(
    names: Sequence[str],
    matrix: FloatArray,
    passive: Sequence[str] = (),
    active: Sequence[str] = (),
) -> Figure:
    """Heat map of the correlations, values in the cells.

    Negative cells carry a dark corner, so the sign is there without hues.

    `passive` and `active` are rows and columns of the block that is outlined; of several blocks,
    where they do not stand side by side in `names`.
    """
    k = len(names)
    side = min(WIDTH, 1.4 + 0.46 * k)
    figure = new_figure(side * 0.93)
    figure.set_figwidth(side)
    axes = figure.add_subplot()
    dress(axes, "", grid=False)
    edges = np.arange(k + 1) - 0.5
    shades = axes.pcolormesh(
        edges, edges, matrix, cmap=_COLOURS, vmin=-1, vmax=1, edgecolors="white", linewidth=0.8
    )
    for row in range(k):
        for column in range(k):
            value = float(matrix[row, column])
            if value <= -_SIGNED:
                corner = [(column - 0.47, row - 0.47), (column - 0.27, row - 0.47),
                          (column - 0.47, row - 0.27)]  # fmt: skip
                axes.add_patch(Polygon(corner, color=_ink(value), linewidth=0, in_layout=False))
            axes.text(
                column, row, _written(value, row == column), ha="center", va="center",
                fontsize=7, color=_ink(value), in_layout=False,  # cells need no room of their own
            )  # fmt: skip
    for rows, columns in product(_runs(names, passive), _runs(names, active)):
        axes.add_patch(
            Rectangle(
                (columns[0] - 0.5, rows[0] - 0.5),
                len(columns),
                len(rows),
                fill=False,
                edgecolor=INK,
                linewidth=2.2,
                joinstyle="miter",
                zorder=5,
            )
        )
    axes.set_xticks(range(k), names, rotation=90, fontsize=8)
    axes.set_yticks(range(k), names, fontsize=8)
    axes.set(xlim=(-0.5, k - 0.5), ylim=(k - 0.5, -0.5), aspect="equal")
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    bar = figure.colorbar(shades, ax=axes, fraction=0.03, pad=0.02, ticks=[-1, -0.5, 0, 0.5, 1])
    bar.set_label("Correlation [-]", fontsize=9, color=INK)
    bar.ax.tick_params(labelsize=8, length=3)
    bar.outline.set_visible(False)
    return figure


def _runs(names: Sequence[str], some: Sequence[str]) -> list[range]:
    """Positions of every run of `some` of the names that stand side by side."""
    edges = [-1, *(index for index, name in enumerate(names) if name not in some), len(names)]
    return [range(a + 1, b) for a, b in pairwise(edges) if b - a > 1]


def _ink(value: float) -> str:
    """Colour of letters that can be read on a cell."""
    return "white" if abs(value) > _DARK else INK


def _written(value: float, diagonal: bool) -> str:
    """A correlation with two decimals, with three where two would make it perfect."""
    text = f"{value:.2f}"
    if abs(float(text)) == 1 and not diagonal:
        text = f"{value:.3f}"
    return text.replace("-0.00", "0.00").replace("-", "−")
