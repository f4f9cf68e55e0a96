"""Profiles of parameters, each beside what the covariance says."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.assessment.likelihood.profile import ParameterProfile
from surae.formatting import significant
from surae.report.figures.style import (
    BLUE,
    GREY,
    INK,
    MUTED,
    OCHRE,
    WIDTH,
    dress,
    footnote,
    heading,
    new_figure,
    powers_of_ten,
    shared_legend,
)
from surae.units import FloatArray

#: Panels side by side.
_COLUMNS = 3
#: Height of a profile's row, and width of a single panel [inch].
_PROFILE_ROW, _SINGLE = 2.35, 5.2
#: Top of the axis, in thresholds.
_TOP = 1.6
#: Points of a profile's curve.
_PROFILE_POINTS = 400
#: How far an axis goes beyond the profile to show the covariance's interval, in profile widths.
_ROOM = 0.6


def profile_figure(profiles: Sequence[ParameterProfile], caption: str = "") -> Figure:
    """One panel for each parameter.

    Parameters
    ----------
    profiles : sequence of ParameterProfile
        At least one.
    caption : str
        What the noise was taken for, below the panels; see `Profiles.noise`.

    Returns
    -------
    Figure
        Δχ² of the profile (thin, dark, with its points) and of the covariance (wide, pale,
        dashed), the threshold of 95 %, and the interval shaded; an arrow marks an open end.
    """
    columns = min(_COLUMNS, len(profiles))
    rows = -(-len(profiles) // columns)
    figure = new_figure(_PROFILE_ROW * rows + (1.4 if columns == 1 else 0.5))
    if columns == 1:
        figure.set_figwidth(_SINGLE)
    elif columns < _COLUMNS:
        figure.set_figwidth(0.85 * WIDTH)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for number, (axes, profile) in enumerate(zip(panels, profiles, strict=False)):
        _panel(axes, profile, leftmost=number % columns == 0)
    for axes in panels[len(profiles) :]:
        axes.set_visible(False)
    shared_legend(figure, list(panels[: len(profiles)]), 5, "outside upper right")
    footnote(figure, caption)
    return figure


def _panel(axes: Axes, profile: ParameterProfile, *, leftmost: bool) -> None:
    dress(axes, "Δχ² [-]" if leftmost else "", f"{profile.name} [{profile.unit}]")
    heading(axes, profile.name)
    axes.set_title(_interval(profile), loc="right", fontsize=8, color=MUTED)
    top = _TOP * profile.threshold
    lowest, highest = _profile_limits(profile)
    ends = zip(profile.interval, profile.values[[0, -1]], strict=True)
    low, high = (edge if end is None else end for end, edge in ends)
    axes.axvspan(low, high, color=GREY, alpha=0.22, linewidth=0, label="95 % interval")
    axes.axhline(profile.threshold, color=OCHRE, linewidth=1.3, linestyle=(0, (1, 1.4)),
                 label=f"threshold {profile.threshold:.2f}")  # fmt: skip
    if profile.sem is not None:
        grid = np.linspace(lowest, highest, _PROFILE_POINTS)
        axes.plot(grid, ((grid - profile.value) / profile.sem) ** 2, color=GREY, linewidth=2.8,
                  linestyle=(0, (3, 1.2)), label="covariance")  # fmt: skip
    axes.plot(*_curve(profile), color=BLUE, linewidth=1.2, zorder=3)
    axes.plot(profile.values, profile.chi2, color=BLUE, marker="o", markersize=3.2,
              linestyle="none", zorder=3)  # fmt: skip
    axes.plot([], [], color=BLUE, linewidth=1.2, marker="o", markersize=3.2, label="profile")
    axes.plot(profile.value, 0.0, color=INK, marker="D", markersize=5, linestyle="none", zorder=4,
              clip_on=False, label="estimate")  # fmt: skip
    for end, edge, sign in zip(profile.interval, profile.values[[0, -1]], (-1, 1), strict=True):
        if end is None:
            _arrow(axes, float(edge), sign, top)
    axes.set_xlim(lowest, highest)
    axes.set_ylim(0.0, top)
    powers_of_ten(axes, "x", 5)


def _profile_limits(profile: ParameterProfile) -> tuple[float, float]:
    """Ends of the axis: the profile, and the covariance's interval as far as there is room."""
    low, high = float(profile.values[0]), float(profile.values[-1])
    room = _ROOM * (high - low)
    lowest, highest = low, high
    if profile.from_covariance is not None:
        lowest = max(min(low, profile.from_covariance[0]), low - room)
        highest = min(max(high, profile.from_covariance[1]), high + room)
    margin = 0.03 * (highest - lowest)
    return lowest - margin, highest + margin


def _curve(profile: ParameterProfile) -> tuple[FloatArray, FloatArray]:
    """The profile between its points: √Δχ², with the sign of the side, is nearly straight."""
    side = np.sign(profile.values - profile.values[int(np.argmin(profile.chi2))])
    grid = np.union1d(
        np.linspace(profile.values[0], profile.values[-1], _PROFILE_POINTS), profile.values
    )
    return grid, np.interp(grid, profile.values, side * np.sqrt(profile.chi2)) ** 2


def _arrow(axes: Axes, edge: float, sign: int, top: float) -> None:
    """An open end: the interval goes on beyond what was tried."""
    axes.annotate(
        "open", xy=(edge, 0.5 * top), xytext=(-34 * sign, 0), textcoords="offset points",
        ha="center", va="center", fontsize=8, color=INK,
        arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.2}, zorder=5,
    )  # fmt: skip


def _interval(profile: ParameterProfile) -> str:
    """The interval with as many digits as tell its ends apart."""
    width = float(profile.values[-1] - profile.values[0])
    digits = 3 + max(0, math.floor(math.log10(max(abs(profile.value) / width, 1.0))))
    low, high = ("open" if end is None else significant(end, digits) for end in profile.interval)
    return f"{low} … {high}"
