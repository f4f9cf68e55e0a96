"""Figures of perturbed recordings: frequency and impulse responses, stiffness over effort."""

from collections.abc import Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.nerve.measures import NerveMeasure
from surae.nerve.perturbed_records import Perturbed
from surae.report import figures
from surae.report.figures import BLUE, GREY, INK, MUTED, OCHRE, RED, Figure
from surae.report.language import Words

#: A degree [rad]: torque by the radian, times this, is torque by the degree.
_DEGREE = float(np.deg2rad(1.0))


def tick(axes: figures.Axes, _: Words, which: str = "xy") -> None:
    """Numbers of linear axes as the reader's language writes them."""
    for name in which:
        axis = axes.xaxis if name == "x" else axes.yaxis
        axis.set_major_formatter(lambda tick, _place: _.number(f"{tick:g}".replace("-", "−")))


def frequency_figure(recording: Perturbed, _: Words) -> Figure:
    """Coherence, gain and phase of torque over angle, with the equations over them."""
    c = recording.curves
    figure = figures.new_figure(5.6, width=7.2)
    top, middle, bottom = figure.subplots(3, 1, sharex=True)
    top.plot(c.f, c.coherence, color=GREY, linewidth=1.6)
    top.set_ylim(0.0, 1.03)
    figures.dress(top, _("Coherence"))
    tick(top, _, "y")
    middle.loglog(c.f, _DEGREE * c.gain, color=GREY, linewidth=2.4, label=_("measured"))
    middle.loglog(c.f, _DEGREE * c.model_gain, color=BLUE, linewidth=1.1, label=_("both paths"))
    middle.loglog(
        c.f,
        _DEGREE * c.intrinsic_gain,
        color=OCHRE,
        linewidth=1.1,
        linestyle="--",
        label=_("tissue"),
    )
    figures.dress(middle, _("Gain [Nm/°]"))
    figures.legend(middle, 3)
    bottom.semilogx(c.f, c.phase, color=GREY, linewidth=2.4)
    bottom.semilogx(c.f, c.model_phase, color=BLUE, linewidth=1.1)
    figures.dress(bottom, _("Phase [°]"), _("Frequency [Hz]"))
    tick(bottom, _, "y")
    return figure


def impulse_figure(recording: Perturbed, _: Words) -> Figure:
    """Impulse responses of both paths, with and without equations."""
    c = recording.curves
    figure = figures.new_figure(2.6, width=7.2)
    left, right = figure.subplots(1, 2, width_ratios=(1, 2))
    left.plot(1e3 * c.intrinsic_lag, _DEGREE * _smooth(c.free_intrinsic), color=GREY, linewidth=1.6)
    figures.dress(left, _("Tissue [Nm/°/s]"), _("Lag [ms]"))
    right.plot(
        1e3 * c.lag,
        _DEGREE * _smooth(c.free_reflex),
        color=GREY,
        linewidth=1.6,
        label=_("without equations"),
    )
    if recording.reflex.verdict == "present":
        right.plot(
            1e3 * c.lag, _DEGREE * c.reflex, color=RED, linewidth=1.1, label=_("its equation")
        )
    right.axhline(0.0, color=MUTED, linewidth=0.6)
    figures.dress(right, _("Reflex [Nm/°]"), _("Lag [ms]"))
    figures.legend(right, 2)
    for axes in (left, right):
        tick(axes, _)
    return figure


def _smooth(response: FloatArray) -> FloatArray:
    """A response without what alternates from lag to lag, which the movement hardly excites."""
    return np.convolve(np.pad(response, 2, mode="edge"), np.array([1, 4, 6, 4, 1]) / 16, "valid")


def effort_figure(recordings: Sequence[Perturbed], _: Words) -> Figure:
    """Stiffness of every recording over its mean torque, and over its mean angle."""
    figure = figures.new_figure(2.8, width=7.2)
    panels = figure.subplots(1, 2, sharey=True)
    of = [(r.mean_torque, r.mean_angle, r.measures["intrinsic_stiffness"]) for r in recordings]
    for axes, at, label in zip(
        panels, (0, 1), (_("Mean torque [Nm]"), _("Mean angle [°]")), strict=True
    ):
        for each in of:
            _bar(axes, float(each[at]), each[2])  # type: ignore[arg-type]
        figures.dress(axes, _("Stiffness [Nm/°]") if at == 0 else "", label)
        tick(axes, _)
    return figure


def _bar(axes: figures.Axes, at: float, measure: NerveMeasure) -> None:
    if measure.value is not None:
        axes.plot([at, at], np.multiply(_DEGREE, measure.ci95), color=BLUE, linewidth=1.2)
        axes.plot([at], [_DEGREE * measure.value], marker="o", markersize=4, color=INK)
