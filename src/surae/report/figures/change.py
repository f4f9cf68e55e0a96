"""A leg before and after as a figure: both relaxed curves, and what lies between them."""

import numpy as np

from surae.inference.relaxed.aligned import laid_pairs
from surae.inference.relaxed.curve import RelaxedCurve
from surae.inference.relaxed.pair import paired_legs
from surae.measures.change.result import Change
from surae.report.figures import BLUE, GREY, INK, MUTED, Figure, dress, new_figure
from surae.report.figures.leg import CARD_WIDTH
from surae.report.language import Words

#: Half of a 95 % band in standard deviations.
_HALF = 1.96
_POINTS = 81
#: Axes reach beyond the curves by this part of what they span: no band decides it.
_ROOM = 0.15


def before_and_after_figure(
    before: RelaxedCurve, after: RelaxedCurve, names: tuple[str, str], _: Words, *, legs: bool
) -> Figure:
    """Torque over angle of both visits, or legs, and below it the difference with its own band.

    Angles are the device's. The band of the difference is that of both visits as one estimate, the
    foot mounted anew in it: it is narrower than what two bands suggest, for what both are wrong in
    alike is in neither.
    """
    figure = new_figure(4.2, width=CARD_WIDTH)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    low = max(before.low, after.low)
    high = min(before.high, after.high)
    looks = ((before, names[0], INK, "-"), (after, names[1], BLUE, "--"))
    values = []
    for curve, name, colour, dash in looks:
        degrees = np.linspace(curve.low, curve.high, _POINTS)
        mean, covariance = curve.torque(degrees)
        half = _HALF * np.sqrt(np.diag(covariance))
        upper.fill_between(degrees, mean - half, mean + half, color=colour, alpha=0.15, linewidth=0)
        upper.plot(degrees, mean, dash, color=colour, linewidth=1.8, label=name)
        values.append(mean)
    _limits(upper, np.concatenate(values))
    dress(upper, _("Torque [Nm]"), "")
    upper.legend(frameon=False, fontsize=8, labelcolor=INK, loc="upper left")
    if high > low:
        degrees = np.linspace(low, high, _POINTS)
        pairs = paired_legs(before, after, one_leg=False) if legs else laid_pairs(before, after)[0]
        turned = [
            side.scale[:, None]
            * np.stack(
                [
                    np.einsum("ij,ij->i", curve.basis.features(at + side.zero), side.weights)
                    for at in degrees
                ],
                axis=1,
            )
            for curve, side in ((before, pairs.before), (after, pairs.after))
        ]
        # a torque's zero is anew at each visit and no change: curves are laid on each other at
        # the end of the range where the ankle is slack
        apart = (turned[1] - turned[1][:, :1]) - (turned[0] - turned[0][:, :1])
        band = np.quantile(apart, [0.025, 0.5, 0.975], axis=0)
        lower.fill_between(degrees, band[0], band[2], color=GREY, alpha=0.45, linewidth=0)
        lower.plot(degrees, band[1], color=INK, linewidth=1.6)
        _limits(lower, band.ravel())
    lower.axhline(0.0, color=MUTED, linewidth=0.8)
    dress(lower, _("Difference [Nm]"), _("Angle of the device [°], dorsiflexion positive"))
    for axis in (lower.xaxis, lower.yaxis, upper.yaxis):
        axis.set_major_formatter(lambda tick, _place: _.number(f"{tick:g}".replace("-", "−")))
    return figure


def _limits(axes: object, values: np.ndarray) -> None:
    """Axes about what is drawn."""
    low = float(np.nanmin(values))
    high = float(np.nanmax(values))
    room = _ROOM * max(high - low, 0.5)
    axes.set_ylim(low - room, high + room)  # type: ignore[attr-defined]


def course_figure(change: Change, name: str, _: Words) -> Figure:
    """A measure at every visit, each with what another such visit would find, and the line."""
    series = change.series[name]
    figure = new_figure(2.8, width=CARD_WIDTH)
    axes = figure.subplots()
    there = [
        (t, v, _HALF * sem)
        for t, v, sem in zip(change.times, series.values, series.sems, strict=True)
        if v is not None and sem is not None
    ]
    times, values, halves = map(np.array, zip(*there, strict=True))
    axes.errorbar(times, values, halves, fmt="o", color=INK, ms=5, lw=1.2, capsize=3)
    d = change.measures.get(name)
    if d is not None and d.difference is not None and d.ci95 is not None:
        weights = halves**-2.0
        ends = np.array([times.min(), times.max()])
        whole = max(change.times) - min(change.times)
        middle = np.average(times, weights=weights)
        level = np.average(values, weights=weights)
        axes.plot(ends, level + d.difference / whole * (ends - middle), "-", color=BLUE, lw=1.6)
    unit = series.unit.replace("deg", "°").strip("-")
    dress(axes, f"{_.measure(name)} [{unit}]" if unit else _.measure(name), _("Visit"))
    axes.set_xticks(change.times, [str(visit)[:14] for visit in change.visits])
    axes.margins(x=0.12)
    axes.yaxis.set_major_formatter(lambda tick, _place: _.number(f"{tick:g}".replace("-", "−")))
    return figure
