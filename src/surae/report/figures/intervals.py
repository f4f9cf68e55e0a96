"""Profiles and posteriors of parameters, each beside what the covariance says."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.assessment.likelihood.profile import ParameterProfile
from surae.assessment.posterior.sample import Marginal, Posterior
from surae.formatting import significant
from surae.normal import standard_error_of
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

#: Panels side by side, and heights of a marginal's and of a pair's row [inch].
_COLUMNS, _ROW, _PAIR_ROW = 3, 1.75, 2.5
#: Pairs drawn, and the correlation from which one is worth it.
_PAIRS, _CORRELATED = 3, 0.3
#: Correlation from which two decimals would make it perfect.
_NEARLY = 0.995
#: Bars of a histogram, points of a curve, and points of a cloud.
_BARS, _POINTS, _CLOUD = 40, 200, 1500
#: What an axis leaves out at either end, of the draws.
_BEYOND = 0.002
#: Half the width, in standard deviations, of an ellipse that holds 95 % of two coordinates.
_ELLIPSE = 2.448


def posterior_figure(posterior: Posterior) -> Figure:
    """One panel for each parameter, then the most correlated pairs.

    Parameters
    ----------
    posterior : Posterior
        The draws.

    Returns
    -------
    Figure
        Histogram of the draws (grey), the Gaussian of the covariance (dark line), the prior
        (dotted) where it reaches in, the credible interval (bar below); clouds of draws with the
        Gaussian's 95 % ellipse; below, what the noise was taken for.
    """
    names, pairs = posterior.names, _pairs(posterior)
    columns = min(_COLUMNS, max(len(names), len(pairs)))
    rows = -(-len(names) // columns)
    heights = [_ROW] * rows + ([_PAIR_ROW] if pairs else [])
    figure = new_figure(sum(heights) + 0.4)
    figure.set_figwidth(WIDTH if columns == _COLUMNS else 0.45 * WIDTH * columns)
    grid = figure.add_gridspec(len(heights), columns, height_ratios=heights)
    for number, marginal in enumerate(posterior.marginals.values()):
        axes = figure.add_subplot(grid[divmod(number, columns)])
        _marginal(axes, marginal, posterior.of(marginal.name), leftmost=number % columns == 0)
    for column, pair in enumerate(pairs):
        _pair(figure.add_subplot(grid[rows, column]), posterior, *pair)
    shared_legend(figure, figure.axes[: len(names)], 5, "outside upper right")
    footnote(figure, posterior.noise)
    return figure


def _marginal(axes: Axes, marginal: Marginal, draws: FloatArray, *, leftmost: bool) -> None:
    dress(axes, "Density" if leftmost else "", f"[{marginal.unit}]", grid=False)
    heading(axes, marginal.name)
    shown = " … ".join(significant(end, 4) for end in marginal.ci95)
    axes.set_title(shown, loc="right", fontsize=8, color=MUTED)
    low, high = np.quantile(draws, [_BEYOND, 1 - _BEYOND]).tolist()
    shared = [low, high, *(marginal.from_covariance or ())]
    room = 0.5 * (high - low)
    lowest, highest = max(min(shared), low - room), min(max(shared), high + room)
    axes.set_xlim(lowest - 0.03 * (highest - lowest), highest + 0.03 * (highest - lowest))
    density, _, _ = axes.hist(
        draws, bins=_BARS, range=(low, high), density=True, color=GREY, alpha=0.75, linewidth=0,
        label="posterior",
    )  # fmt: skip
    top = float(np.max(density))
    x = np.linspace(*axes.get_xlim(), _POINTS)
    if marginal.from_covariance is not None:
        sem = standard_error_of(marginal.from_covariance)
        curve = np.exp(-(((x - marginal.value) / sem) ** 2) / 2) / (sem * np.sqrt(2 * np.pi))
        axes.plot(x, curve, color=BLUE, linewidth=1.3, linestyle=(0, (5, 1.5)),
                  label="covariance")  # fmt: skip
        top = max(top, float(curve.max()))
    axes.plot(x, _prior(marginal, x), color=OCHRE, linewidth=1.4, linestyle=(0, (1, 1.4)),
              label="prior")  # fmt: skip
    axes.plot(marginal.ci95, [-0.08 * top] * 2, color=INK, linewidth=3.2, solid_capstyle="butt",
              label="95 % credible")  # fmt: skip
    axes.set_ylim(-0.15 * top, 1.08 * top)
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    powers_of_ten(axes, "x", 4)


def _prior(marginal: Marginal, x: FloatArray) -> FloatArray:
    """Density of a prior, per unit of the parameter."""
    prior = marginal.prior
    if not prior.log:
        away, width = (x - prior.median) / prior.spread, np.full_like(x, prior.spread)
    else:
        positive = np.maximum(x, 1e-12 * prior.median)
        away, width = np.log(positive / prior.median) / prior.spread, prior.spread * positive
    density: FloatArray = np.exp(-(away**2) / 2) / (width * np.sqrt(2 * np.pi))
    return density


def _pairs(posterior: Posterior) -> list[tuple[int, int]]:
    """The most correlated pairs of parameters, no parameter in two of them."""
    matrix = np.abs(np.triu(posterior.correlation, 1))
    pairs: list[tuple[int, int]] = []
    while len(pairs) < _PAIRS and matrix.max() >= _CORRELATED:
        i, j = (int(k) for k in np.unravel_index(int(np.argmax(matrix)), matrix.shape))
        pairs.append((i, j))
        for k in (i, j):
            matrix[k, :] = matrix[:, k] = 0.0
    return pairs


def _pair(axes: Axes, posterior: Posterior, i: int, j: int) -> None:
    a, b = (posterior.marginals[posterior.names[k]] for k in (i, j))
    dress(axes, f"{b.name} [{b.unit}]", f"{a.name} [{a.unit}]")
    correlation = float(posterior.correlation[i, j])
    decimals = 2 if abs(correlation) < _NEARLY else 3
    heading(axes, f"correlation {correlation:+.{decimals}f}".replace("-", "−"))
    x, y = posterior.of(a.name), posterior.of(b.name)
    step = max(1, len(x) // _CLOUD)
    axes.plot(x[::step], y[::step], color=MUTED, marker=".", markersize=2.2, linestyle="none",
              markeredgewidth=0, alpha=0.6, rasterized=True)  # fmt: skip
    axes.plot(a.value, b.value, color=INK, marker="D", markersize=4.5, linestyle="none", zorder=4)
    _ellipse(axes, posterior, (a, b))
    for values, limit in ((x, axes.set_xlim), (y, axes.set_ylim)):
        low, high = np.quantile(values, [_BEYOND, 1 - _BEYOND]).tolist()
        limit(low - 0.08 * (high - low), high + 0.08 * (high - low))
    powers_of_ten(axes, "x", 4)
    powers_of_ten(axes, "y", 4)


def _ellipse(axes: Axes, posterior: Posterior, pair: Sequence[Marginal]) -> None:
    """The covariance's ellipse that holds 95 %; nothing where one of the two has no variance."""
    estimated = posterior.covariance
    if any(marginal.name not in estimated.names for marginal in pair):
        return
    chosen = [estimated.names.index(marginal.name) for marginal in pair]
    first, second = np.linalg.cholesky(estimated.matrix[np.ix_(chosen, chosen)])
    angle = np.linspace(0, 2 * np.pi, _POINTS)
    circle = _ELLIPSE * np.array([np.cos(angle), np.sin(angle)])
    axes.plot(
        pair[0].value + first @ circle, pair[1].value + second @ circle,
        color=BLUE, linewidth=1.3, linestyle=(0, (5, 1.5)),
    )  # fmt: skip


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
