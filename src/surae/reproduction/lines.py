"""Lines of many, told apart without their colours: a dash, a marker and its filling."""

from collections.abc import Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.report.figures.style import BLUE, INK, MUTED, OCHRE, RED

_LINES = ((BLUE, "-"), (RED, (0, (4, 1.5))), (OCHRE, (0, (1, 1.2))), (MUTED, (0, (5, 1, 1, 1))))
_MARKERS = "os^DvPX*"


def line(number: int) -> dict[str, Any]:
    """Look of the line of this number, for `Axes.plot`; all differ up to 32."""
    colour, dash = _LINES[number % len(_LINES)]
    turn = number // len(_LINES)
    return {
        "color": colour, "linestyle": dash, "linewidth": 1.1,
        "marker": _MARKERS[turn % len(_MARKERS)], "markersize": 4.2,
        "markerfacecolor": colour if turn % 2 == 0 else "white",
    }  # fmt: skip


def legend_above(figure: Figure, panels: Sequence[Axes], columns: int) -> None:
    """One legend of all panels above them."""
    handles: dict[str, Artist] = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    figure.legend(
        list(handles.values()), list(handles), loc="outside upper center",
        ncols=min(columns, len(handles)), frameon=False, fontsize=8, labelcolor=INK,
        handlelength=3.4, columnspacing=1.3,
    )  # fmt: skip
