"""The relaxed leg as a figure: torque over angle as measured, the curve over it, stated angles."""

from collections.abc import Mapping, Sequence

import numpy as np

from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.measure import Measure
from surae.measures.norms import Norm
from surae.report.figures import (
    BLUE,
    GREY,
    INK,
    MUTED,
    Axes,
    Figure,
    card_legend,
    dress,
    new_figure,
)
from surae.report.language import Words

#: Half of a 95 % band in standard deviations.
_HALF = 1.96
#: Slower than this nothing moves [deg/s].
_STILL = 0.3


def relaxed_figure(
    curve: RelaxedCurve,
    measures: Mapping[str, Measure],
    _: Words,
    *,
    behind: Sequence[Norm] = (),
    width: float = 6.4,
    height: float = 3.6,
) -> Figure:
    """The figure of a relaxed leg, groups `behind` it by their torque in a slow stretch."""
    figure = new_figure(height, width=width)
    axes = figure.subplots()
    _draw_norms(axes, curve, measures, behind, _)
    draw_relaxed(axes, curve, measures, _)
    return figure


def _draw_norms(
    axes: Axes,
    curve: RelaxedCurve,
    measures: Mapping[str, Measure],
    behind: Sequence[Norm],
    _: Words,
) -> None:
    """Draw groups where this leg has the same measure, and the leg's own beside them."""
    pairs = [(norm, m) for norm in behind if (m := measures.get(norm.measure)) is not None]
    for number, (norm, m) in enumerate(each for each in pairs if each[1].basis == "rest"):
        if m.value is None or m.ci95 is None:
            continue
        at = _angle_of(norm.measure) - curve.zero_deg
        low, high = m.ci95
        axes.errorbar(
            [at + 1.0],
            [norm.mean],
            [norm.sd],
            fmt="s",
            color=GREY,
            ms=4,
            lw=5,
            alpha=0.6,
            zorder=0,
            label="_" if number else _("{group}, slow stretch", group=_(norm.group)),
        )
        axes.errorbar(
            [at + 2.0],
            [m.value],
            [[m.value - low], [high - m.value]],
            fmt="o",
            color=BLUE,
            ms=4,
            lw=1.2,
            capsize=2,
            zorder=3,
            label="_" if number else _("this leg, slow stretch"),
        )


def draw_relaxed(
    axes: Axes, curve: RelaxedCurve, measures: Mapping[str, Measure], _: Words
) -> None:
    """Draw what was measured at rest, its curve with a 95 % band, and torque at stated angles.

    Foot, plate and the sensor's zero are taken off what was measured; angles are the device's.
    Loading and unloading differ in their marks, so that they are told apart in grey too.
    """
    samples = curve.samples
    for chosen, mark, colour, label in (
        (samples.velocity > _STILL, "^", GREY, _("towards dorsiflexion, measured")),
        (samples.velocity < -_STILL, "v", MUTED, _("back, measured")),
        (np.abs(samples.velocity) <= _STILL, ".", GREY, _("held still, measured")),
    ):
        if chosen.any():
            axes.plot(
                samples.angle[chosen],
                samples.torque[chosen],
                mark,
                color=colour,
                ms=2.5,
                mew=0.0,
                alpha=0.7,
                zorder=1,
                label=label,
            )
    degrees = np.linspace(curve.low, curve.high, 121)
    mean, covariance = curve.torque(degrees)
    half = _HALF * np.sqrt(np.diag(covariance))
    axes.fill_between(
        degrees,
        mean - half,
        mean + half,
        color=BLUE,
        alpha=0.2,
        linewidth=0,
        zorder=2,
        label=_("relaxed, 95 %"),
    )
    middle = len(degrees) // 2
    # of the rise from the middle of the range, in which no zero of the torque is
    apart = np.diag(covariance) + covariance[middle, middle] - 2.0 * covariance[middle]
    form = _HALF * np.sqrt(np.maximum(apart, 0.0))
    axes.fill_between(
        degrees,
        mean - form,
        mean + form,
        color=BLUE,
        alpha=0.35,
        linewidth=0,
        zorder=2,
        label=_("its shape, 95 %"),
    )
    axes.plot(degrees, mean, "-", color=BLUE, linewidth=1.8, zorder=3, label=_("relaxed"))
    for number, (at, value, (low, high)) in enumerate(_stated(curve, measures)):
        axes.errorbar(
            [at],
            [value],
            [[value - low], [high - value]],
            fmt="D",
            color=INK,
            ms=4,
            lw=1.2,
            capsize=2.5,
            zorder=4,
            label="_" if number else _("at stated angles"),
        )
    dress(axes, _("Torque [Nm]"), _("Angle by the device [°], dorsiflexion positive"))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda tick, _place: _.number(f"{tick:g}".replace("-", "−")))
    axes.axhline(0.0, color=MUTED, linewidth=0.6)
    card_legend(axes, markerscale=2.0)


def _stated(
    curve: RelaxedCurve, measures: Mapping[str, Measure]
) -> list[tuple[float, float, tuple[float, float]]]:
    """Angles by the device [deg], torque there and its interval."""
    made = []
    for name, measure in measures.items():
        if name.startswith("passive_torque@") and measure.value is not None and measure.ci95:
            if measure.basis != "rest":
                continue
            at = _angle_of(name) - curve.zero_deg
            made.append((at, measure.value, measure.ci95))
    return made


def _angle_of(name: str) -> float:
    """The angle at which a measure is [deg]."""
    return float(name.partition("@")[2].removesuffix("deg"))
