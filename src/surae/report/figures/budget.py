"""The uncertainty budget as stacked bars, one for each parameter."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from surae.report.budget import SOURCES, BudgetSection
from surae.report.figures.style import BLUE, GREY, INK, OCHRE, dress, new_figure

#: Looks of the sources, always the same: a shade and a hatch, which tell them apart without hues.
_LOOKS = (
    (GREY, ""), ("#e3e6ea", "xxxx"), (INK, ""), ("#ffffff", "////"), (BLUE, ""),
    ("#ffffff", "----"), ("#cfe0f5", "...."), ("#eec3bb", "||||"), ("#f6d9b8", "\\\\\\\\"),
    (OCHRE, ""), ("#57606a", ""), ("#7d9cc8", "++++"), ("#ffffff", "oooo"),
    ("#b9c4d0", "..."), ("#ffffff", "\\\\\\\\"), ("#d8e8d0", "**"),
)  # fmt: skip


def budget_figure(section: BudgetSection) -> Figure:
    """Shares of the variance of every parameter, from 0 to 100 %, and how well it is known."""
    names = [row.name for row in section.rows]
    shares = 100.0 * np.array([row.shares for row in section.rows])
    figure = new_figure(1.1 + 0.2 * -(-len(section.sources) // 3) + 0.24 * len(names))
    axes = figure.add_subplot()
    dress(axes, "", "Share of the variance [%]", grid=False)
    begins = np.zeros(len(names))
    patches = []
    order = list(SOURCES)
    for number, (key, source) in enumerate(zip(section.keys, section.sources, strict=True)):
        colour, hatch = _LOOKS[order.index(key) if key in order else -1]
        look: dict[str, Any] = {
            "facecolor": colour,
            "hatch": hatch,
            "edgecolor": INK,
            "linewidth": 0.5,
        }
        axes.barh(names, shares[:, number], left=begins, height=0.72, **look)
        patches.append(Patch(label=source, **look))
        begins += shares[:, number]
    axes.set_xlim(0.0, 100.0)
    axes.invert_yaxis()
    axes.tick_params(axis="y", length=0)
    known = axes.secondary_yaxis("right")
    known.set_yticks(range(len(names)), [row.known for row in section.rows], fontsize=8)
    known.tick_params(length=0, labelcolor=INK)
    known.spines["right"].set_visible(False)
    known.set_ylabel("known to (95 %)", fontsize=9, color=INK)
    figure.legend(
        handles=patches, loc="outside upper center", ncols=3, frameon=False, fontsize=8,
        labelcolor=INK, handlelength=2.4, handleheight=1.1, columnspacing=1.6,
    )  # fmt: skip
    return figure
