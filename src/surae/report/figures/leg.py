"""Figures of a leg's page: measured torque over angle, and what the torque is made of."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.base.units import FloatArray
from surae.measures.measure import Measure
from surae.measures.norms import Norm
from surae.measures.torque_curve import HeldPoint, Stretch, TorqueCurve
from surae.report.figures import BLUE, GREY, INK, MUTED, card_legend, dress, new_figure
from surae.report.language import Words

#: Width of a card's figure, so that its letters are read on a telephone too [inch].
CARD_WIDTH = 4.6
#: A band may reach so many times the measured range beyond it; width of a letter in a bar [%].
_BEYOND = 0.5
_LETTER = 1.7
#: Height from the line of one interval to the next, of the bar's.
_LINE = 0.07


def stiffness_figure(
    holds: Sequence[HeldPoint],
    stretches: Sequence[Stretch],
    model: TorqueCurve | None,
    norms: Sequence[tuple[Norm, float]],
    own: Sequence[tuple[float, Measure]],
    _: Words,
    *,
    width: float = CARD_WIDTH,
    height: float = 2.9,
) -> Figure:
    """Measured torque [Nm] of a relaxed ankle over its angle, the model over it, norms behind.

    `own` is the leg's measure at the angle of each norm, the same quantity.
    """
    figure = new_figure(height, width=width)
    axes = figure.subplots()
    drawn: list[FloatArray] = []
    for number, (norm, at) in enumerate(norms):
        axes.errorbar(
            [at],
            [norm.mean],
            [norm.sd],
            fmt="s",
            color=GREY,
            ms=4,
            lw=5,
            alpha=0.6,
            zorder=1,
            label="_" if number else _("{group}, slow stretch", group=_(norm.group)),
        )
    known = [(at, m.value, m.ci95) for at, m in own if m.value is not None and m.ci95 is not None]
    for number, (at, value, (low, high)) in enumerate(known):
        axes.errorbar(
            [at + 1.5],
            [value],
            [[value - low], [high - value]],
            fmt="D",
            color=BLUE,
            ms=4,
            lw=1.2,
            capsize=2,
            zorder=3,
            label="_" if number else _("this leg, slow stretch"),
        )
    if model is not None:
        _curve(axes, model, BLUE, "-", _("model, relaxed"))
        drawn.append(model.torque)
    for number, each in enumerate(stretches):
        for torque, dash, label in (
            (each.loading, "-", _("stretch, measured")),
            (each.unloading, "--", _("return, measured")),
        ):
            if np.isfinite(torque).any():
                axes.plot(
                    each.angle,
                    torque,
                    dash,
                    color=INK,
                    linewidth=1.2,
                    zorder=3,
                    label="_" if number else label,
                )
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
            label=_("held still, measured"),
        )
        drawn.append(held)
    _dressed(axes, drawn, _)
    return figure


def visits_figure(visits: Sequence[tuple[str, TorqueCurve]], _: Words) -> Figure:
    """The relaxed ankle's torque over its angle at two visits, or of two legs, by their names."""
    figure = new_figure(2.9, width=CARD_WIDTH)
    axes = figure.subplots()
    for (name, curve), colour, dash in zip(visits, (INK, BLUE), ("-", "--"), strict=False):
        _curve(axes, curve, colour, dash, name)
    _dressed(axes, [curve.torque for _name, curve in visits], _)
    return figure


def _curve(axes: Axes, curve: TorqueCurve, colour: str, dash: str, label: str) -> None:
    """A curve with its band."""
    if np.isfinite(curve.low).any():
        axes.fill_between(
            curve.angle,
            curve.low,
            curve.high,
            color=colour,
            alpha=0.15,
            linewidth=0,
            label=f"{label}, 95 %",
        )
    axes.plot(curve.angle, curve.torque, dash, color=colour, linewidth=1.8, label=label)


def _dressed(axes: Axes, drawn: Sequence[FloatArray], _: Words) -> None:
    """Axes about what is drawn: a wide band must not flatten it."""
    dress(axes, _("Torque [Nm]"), _("Ankle angle [°], dorsiflexion positive"))
    if drawn:
        values = np.concatenate(drawn)
        low = float(np.nanmin(values))
        high = float(np.nanmax(values))
        room = _BEYOND * max(high - low, 1.0)
        axes.set_ylim(min(low - room, 0.0), high + room)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda tick, _place: _.number(f"{tick:g}".replace("-", "−")))
    axes.axhline(0.0, color=MUTED, linewidth=0.6)
    card_legend(axes)


def shares_bar(parts: Sequence[tuple[str, float, tuple[float, float] | None]]) -> Figure:
    """What the torque is made of as one bar [%]; a line above each end that is uncertain."""
    figure = new_figure(0.95, width=CARD_WIDTH)
    axes = figure.subplots()
    begin = 0.0
    for number, ((name, value, interval), colour) in enumerate(
        zip(parts, (INK, BLUE, GREY, "#e3e6ea"), strict=False)
    ):
        axes.barh(0, value, left=begin, height=0.6, color=colour, edgecolor="white")
        text = f"{name} {value:.0f} %"
        if value > _LETTER * len(text):
            axes.text(
                begin + 0.5 * value,
                0,
                text,
                ha="center",
                va="center",
                fontsize=9,
                color="white" if colour in (INK, BLUE) else INK,
            )
        if interval is not None:
            ends = [begin + min(max(end, 0.0), 100.0) for end in interval]
            level = 0.42 + _LINE * number  # one above the other, so that none hides another in grey
            axes.plot(ends, [level, level], color=colour, linewidth=2.0)
        begin += value
    axes.set(xlim=(0.0, 100.0), ylim=(-0.4, 0.7))
    axes.set_axis_off()
    return figure
