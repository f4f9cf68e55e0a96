"""The relaxed leg as a figure: torque over angle as measured, the curve over it, stated angles."""

from collections.abc import Mapping

import numpy as np

from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.measure import Measure
from surae.report.figures import BLUE, GREY, INK, MUTED, Axes, Figure, dress, new_figure
from surae.report.language import Words

#: Half of a 95 % band in standard deviations.
_HALF = 1.96
#: Slower than this nothing moves [deg/s].
_STILL = 0.3


def relaxed_figure(curve: RelaxedCurve, measures: Mapping[str, Measure], _: Words) -> Figure:
    """The figure of a relaxed leg."""
    figure = new_figure(3.6, width=6.4)
    draw_relaxed(figure.subplots(), curve, measures, _)
    return figure


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
    axes.legend(
        frameon=False,
        fontsize=7,
        labelcolor=INK,
        loc="lower left",
        ncols=2,
        bbox_to_anchor=(0.0, 1.0),
        markerscale=2.0,
    )


def _stated(
    curve: RelaxedCurve, measures: Mapping[str, Measure]
) -> list[tuple[float, float, tuple[float, float]]]:
    """Angles by the device [deg], torque there and its interval."""
    made = []
    for name, measure in measures.items():
        if name.startswith("passive_torque@") and measure.value is not None and measure.ci95:
            at = float(name.partition("@")[2].removesuffix("deg")) - curve.zero_deg
            made.append((at, measure.value, measure.ci95))
    return made
