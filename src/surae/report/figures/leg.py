"""Figures of a leg's page: measured torque over angle, and what the torque is made of."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from surae.measures.curve import TorqueCurve
from surae.measures.measured import HeldPoint, Stretch
from surae.measures.norms import Norm
from surae.report.figures.style import BLUE, GREY, INK, MUTED, dress, new_figure
from surae.units import FloatArray

#: Width of a card's figure, so that its letters are read on a telephone too [inch].
_WIDTH = 5.4
#: A band may reach so many times the measured range beyond it before it is cut off.
_BEYOND = 0.5


def stiffness_figure(
    holds: Sequence[HeldPoint],
    stretches: Sequence[Stretch],
    model: tuple[TorqueCurve, FloatArray] | None,
    norms: Sequence[tuple[Norm, float]],
) -> Figure:
    """Measured torque of a relaxed ankle over its angle, the model over it, a norm behind.

    All torques [Nm] have the session's zero taken off. `model` is the curve and the foot's weight
    at its angles; `norms` are groups, each at an angle [deg].
    """
    figure = new_figure(2.9, width=_WIDTH)
    axes = figure.subplots()
    drawn: list[FloatArray] = []
    for number, (norm, at) in enumerate(norms):
        axes.errorbar(
            [at], [norm.mean], [norm.sd], fmt="s", color=GREY, ms=4, lw=5, alpha=0.6, zorder=1,
            label="_" if number else norm.group,
        )  # fmt: skip
    if model is not None:
        curve, weight = model
        line = curve.passive
        if np.isfinite(line.low).any():
            axes.fill_between(
                curve.angle, line.low + weight, line.high + weight, color=BLUE, alpha=0.15,
                linewidth=0, label="model, 95 %",
            )  # fmt: skip
        axes.plot(curve.angle, line.torque + weight, color=BLUE, linewidth=1.8, label="model")
        drawn.append(line.torque + weight)
    for number, each in enumerate(stretches):
        for torque, dash, label in (
            (each.loading, "-", "stretch"), (each.unloading, "--", "return"),
        ):  # fmt: skip
            if np.isfinite(torque).any():
                axes.plot(
                    each.angle, torque, dash, color=INK, linewidth=1.2, zorder=3,
                    label="_" if number else f"{label}, measured",
                )  # fmt: skip
                drawn.append(torque)
    if holds:
        held = np.array([h.torque for h in holds])
        axes.plot(
            [h.angle for h in holds],
            held,
            "o",
            color=INK,
            ms=5,
            zorder=4,
            label="held still, measured",
        )
        drawn.append(held)
    dress(axes, "Torque [Nm]", "Ankle angle [°], dorsiflexion positive")
    if drawn:
        values = np.concatenate(drawn)
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        room = _BEYOND * max(high - low, 1.0)
        axes.set_ylim(min(low - room, 0.0), high + room)
    axes.axhline(0.0, color=MUTED, linewidth=0.6)
    axes.legend(frameon=False, fontsize=8, labelcolor=INK, loc="upper left", ncols=2)
    return figure


def shares_bar(parts: Sequence[tuple[str, float, tuple[float, float] | None]]) -> Figure:
    """What the torque is made of as one bar [%]; a line above each end that is uncertain."""
    figure = new_figure(0.95, width=_WIDTH)
    axes = figure.subplots()
    begin = 0.0
    for (name, value, interval), colour in zip(
        parts, (INK, BLUE, GREY, "#e3e6ea"), strict=False
    ):  # fmt: skip
        axes.barh(0, value, left=begin, height=0.6, color=colour, edgecolor="white")
        if value > 12.0:
            dark = colour in (INK, BLUE)
            axes.text(
                begin + 0.5 * value, 0, f"{name} {value:.0f} %", ha="center", va="center",
                fontsize=9, color="white" if dark else INK,
            )  # fmt: skip
        if interval is not None:
            ends = [begin + min(max(end, 0.0), 100.0) for end in interval]
            axes.plot(ends, [0.45, 0.45], color=colour if colour == BLUE else INK, linewidth=2.0)
        begin += value
    axes.set_xlim(0.0, 100.0)
    axes.set_ylim(-0.4, 0.6)
    axes.set_axis_off()
    return figure
