"""Figures of the clinical page: torque against angle with bands, and what a torque is made of."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.measures.curve import CurveLine, TorqueCurve
from surae.measures.norms import Placed
from surae.report.figures.style import BLUE, GREY, INK, MUTED, dress, new_figure
from surae.units import FloatArray

#: Of relaxed ankle, calf and tibialis: line, and pattern of its band; told apart in grey too.
_LOOKS = ((INK, "-"), (BLUE, "--"), (MUTED, ":"))
#: A figure that is narrower has no room for two panels side by side [inch].
_NARROW = 5.0
#: The axes reach at most this many times the curves' own range beyond them: a band without an end
#: would leave a flat line.
_BEYOND = 2.0
#: Label of the edge of a band, which a legend leaves out.
_EDGE = "_edge"
#: Marks of groups, told apart in grey.
_GROUPS = ("s", "D", "^")
#: Fill and hatch of the shares.
_FILLS = ((INK, ""), (BLUE, "////"), (GREY, ""), ("#ffffff", "...."))


def curve_figure(
    curves: Sequence[tuple[str, TorqueCurve]],
    beside: Sequence[tuple[Placed, str]],
    words: Mapping[str, str],
    *,
    width: float = 7.2,
) -> Figure:
    """Torque against angle: of one session at rest and active, or of two at rest.

    `beside` are the leg's torque in a slow stretch among groups, by name; both are drawn at its
    angle, of groups mean and spread. `words` are the labels in the reader's language: ``angle
    torque relaxed slow calf tibialis``. A narrow figure (`width` [inch]) has its panels below each
    other.
    """
    narrow = width < _NARROW and len(curves) == 1
    figure = new_figure(2.75 * (2 if narrow else 1), width=width)
    panels: tuple[Axes, ...]
    if len(curves) == 1:
        rest, active = figure.subplots(*((2, 1) if narrow else (1, 2)), sharex=narrow)
        (_, curve) = curves[0]
        _band(rest, curve.angle, curve.passive, 0, words["relaxed"])
        _band(active, curve.angle, curve.active_tri, 1, words["calf"])
        _band(active, curve.angle, curve.active_tib, 2, words["tibialis"])
        panels = (rest, active)
    else:
        rest = figure.subplots()
        for look, (name, curve) in enumerate(curves):
            _band(rest, curve.angle, curve.passive, look, f"{name}, {words['relaxed']}")
        panels = (rest,)
    own: set[float] = set()
    for number, (placed, group) in enumerate(beside, 1):
        norm, at = placed.norm, float(placed.norm.measure.partition("@")[2].removesuffix("deg"))
        if at not in own:  # a slow stretch is not the relaxed line: like is shown beside like
            label = "_" if own else words["slow"]
            rest.plot([at], [placed.value], "o", color=INK, mfc="white", ms=4.5, label=label)
            own.add(at)
        rest.errorbar(
            [at + 1.5 * number], [norm.mean], [norm.sd], fmt=_GROUPS[number % len(_GROUPS)],
            color=MUTED, mfc="white" if number % 2 else MUTED, ms=4.0, lw=1.0, capsize=3,
            label=group,
        )  # fmt: skip
    for axes in panels:
        dress(axes, words["torque"], words["angle"])
        axes.legend(frameon=False, fontsize=7.5, labelcolor=INK, loc="upper left")
        low, high = _limits(axes)
        axes.set_ylim(low, high + 0.18 * (high - low))
        axes.axhline(0.0, color=MUTED, linewidth=0.6)
    return figure


def shares_figure(shares: Sequence[tuple[str, Sequence[tuple[str, float]]]]) -> Figure:
    """Parts of the torque as stacked bars [%], one for each session.

    `shares` are the names of the sessions, and the parts of each by name.
    """
    figure = new_figure(0.42 + 0.26 * len(shares), width=7.2)
    axes = figure.subplots()
    for row, (_, parts) in enumerate(shares):
        begin = 0.0
        for (part, value), (colour, hatch) in zip(parts, _FILLS, strict=False):
            axes.barh(
                row, value, left=begin, height=0.7, color=colour, hatch=hatch, edgecolor=INK,
                linewidth=0.6, label=f"{part}" if row == 0 else "_",
            )  # fmt: skip
            if value > 6.0:
                axes.text(
                    begin + 0.5 * value, row, f"{value:.0f} %", ha="center", va="center",
                    fontsize=8, color=INK, bbox={"facecolor": "white", "edgecolor": "none",
                                                 "pad": 1.2},
                )  # fmt: skip
            begin += value
    axes.set_xlim(0.0, 100.0)
    axes.set_yticks(range(len(shares)), [name for name, _ in shares], fontsize=8)
    axes.invert_yaxis()
    axes.set_xticks([])
    axes.tick_params(length=0, labelcolor=INK)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.legend(
        frameon=False, fontsize=8, labelcolor=INK, ncols=4, loc="lower left",
        bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1, handleheight=1.0,
    )  # fmt: skip
    return figure


def _band(axes: Axes, angle: FloatArray, line: CurveLine, look: int, label: str) -> None:
    if not np.isfinite(line.torque).any():
        return
    colour, dash = _LOOKS[look]
    axes.fill_between(angle, line.low, line.high, color=colour, alpha=0.16, linewidth=0)
    axes.plot(angle, line.torque, dash, color=colour, linewidth=1.6, label=label)
    for edge in (line.low, line.high):
        axes.plot(angle, edge, color=colour, linewidth=0.5, label=_EDGE)


def _limits(axes: Axes) -> tuple[float, float]:
    """Torque from and to [Nm]: all that is drawn, but of bands only what leaves curves readable."""
    low, high = axes.get_ylim()
    drawn = [np.asarray(line.get_ydata()) for line in axes.lines if line.get_label() != _EDGE]
    torque = np.concatenate([*drawn, np.zeros(1)])
    least, most = float(np.nanmin(torque)), float(np.nanmax(torque))
    beyond = _BEYOND * (most - least)
    if beyond > 0.0:
        low, high = max(low, least - beyond), min(high, most + beyond)
    return low, high
