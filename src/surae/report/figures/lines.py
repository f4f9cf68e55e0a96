"""Lines of many, told apart without their colours: a dash, a marker and its filling."""

from collections.abc import Sequence
from textwrap import wrap
from typing import Any, Literal

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.report.figures.style import BLUE, INK, MUTED, OCHRE, RED

#: Letters of a line of a legend's title.
_LETTERS = 118
#: A colour and a dash each.
_LINES = ((BLUE, "-"), (RED, (0, (4, 1.5))), (OCHRE, (0, (1, 1.2))), (MUTED, (0, (5, 1, 1, 1))))
#: A marker for every round of the lines.
MARKERS = "os^DvPX*"


def line(number: int) -> dict[str, Any]:
    """Look of the line of this number, for `Axes.plot`; all differ up to 32."""
    colour, dash = _LINES[number % len(_LINES)]
    turn = number // len(_LINES)
    return {
        "color": colour, "linestyle": dash, "linewidth": 1.1,
        "marker": MARKERS[turn % len(MARKERS)], "markersize": 4.2,
        "markerfacecolor": colour if turn % 2 == 0 else "white",
    }  # fmt: skip


def shared_legend(
    figure: Figure,
    panels: Sequence[Axes],
    columns: int,
    where: Literal["outside upper center", "outside lower center"] = "outside upper center",
    title: str = "",
) -> bool:
    """One legend of all panels, under a title; whether there is any line to tell of."""
    handles: dict[str, Artist] = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    if handles:
        legend = figure.legend(
            list(handles.values()), list(handles), loc=where, ncols=min(columns, len(handles)),
            frameon=False, fontsize=8, labelcolor=INK, handlelength=3.4, columnspacing=1.3,
            title="\n".join(wrap(title, _LETTERS)) or None, title_fontsize=8,
        )  # fmt: skip
        legend.get_title().set(color=MUTED, multialignment="center")
    return bool(handles)
