"""The uncertainty budget as stacked bars, one for each parameter."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from surae.model.sources import SOURCES
from surae.report.budget import BudgetTable
from surae.report.figures.style import BLUE, GREY, INK, MUTED, OCHRE, RED, dress, new_figure

#: The palette's colours on paper.
_COLOURS = {
    "surface": "#ffffff", "measured": GREY, "ink": INK, "series-1": BLUE, "series-2": RED,
    "series-3": OCHRE, "series-6": MUTED,
}  # fmt: skip


def budget_figure(budget: BudgetTable) -> Figure:
    """Shares of the variance of every parameter, from 0 to 100 %, and how well it is known."""
    names = list(budget.rows)
    shares = 100.0 * np.array([shares for _, shares in budget.rows.values()])
    figure = new_figure(1.1 + 0.2 * -(-len(budget.sources) // 3) + 0.24 * len(names))
    axes = figure.add_subplot()
    dress(axes, "", "Share of the variance [%]", grid=False)
    begins = np.zeros(len(names))
    patches = []
    for number, source in enumerate(budget.sources):
        colour, hatch = SOURCES[source].look
        look: dict[str, Any] = {
            "facecolor": _COLOURS[colour],
            "hatch": 4 * hatch,
            "edgecolor": INK,
            "linewidth": 0.5,
        }
        axes.barh(names, shares[:, number], left=begins, height=0.72, **look)
        patches.append(Patch(label=SOURCES[source].label, **look))
        begins += shares[:, number]
    axes.set_xlim(0.0, 100.0)
    axes.invert_yaxis()
    axes.tick_params(axis="y", length=0)
    known = axes.secondary_yaxis("right")
    known.set_yticks(range(len(names)), [known for known, _ in budget.rows.values()], fontsize=8)
    known.tick_params(length=0, labelcolor=INK)
    known.spines["right"].set_visible(False)
    known.set_ylabel("known to (95 %)", fontsize=9, color=INK)
    figure.legend(
        handles=patches, loc="outside upper center", ncols=3, frameon=False, fontsize=8,
        labelcolor=INK, handlelength=2.4, handleheight=1.1, columnspacing=1.6,
    )  # fmt: skip
    return figure
