"""What the model leaves over: in time, its autocorrelation and its distribution."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from surae.assessment import Whiteness
from surae.report.figures.style import (
    BLUE,
    GREY,
    INK,
    MUTED,
    RED,
    dress,
    legend,
    new_figure,
    shade_excluded,
    trace,
)
from surae.units import FloatArray


def residual_figure(
    time: FloatArray,
    residual: FloatArray,
    whiteness: Whiteness,
    excluded: Sequence[tuple[int, int]] = (),
) -> Figure:
    """Residual against time, its autocorrelation with the white-noise band, and its histogram.

    The torque is in Nm; `excluded` are first and last sample of every stretch that the fit left
    out, without which the histogram is.
    """
    figure = new_figure(4.6)
    grid = figure.add_gridspec(2, 2, width_ratios=[1.4, 1.0], wspace=0.08)

    axes = figure.add_subplot(grid[0, :])
    dress(axes, "Residual [Nm]", "Time [s]")
    axes.axhline(0.0, color=MUTED, linewidth=0.7)
    trace(axes, time, residual, color=INK, linewidth=0.7)
    axes.set_xlim(float(time[0]), float(time[-1]))
    if excluded:
        shade_excluded(axes, time, excluded)
        legend(axes, 1)

    axes = figure.add_subplot(grid[1, 0])
    dress(axes, "Autocorrelation [-]", "Lag [s]")
    lags = np.arange(len(whiteness.correlation)) / whiteness.rate_hz
    axes.axhspan(
        -whiteness.band, whiteness.band, color=GREY, alpha=0.45, linewidth=0,
        label="95 % band of white noise (±1.96/√n)",
    )  # fmt: skip
    axes.axhline(0.0, color=MUTED, linewidth=0.7)
    axes.plot(
        lags, whiteness.correlation, color=BLUE, linewidth=1.1,
        marker="." if len(lags) < 100 else "", markersize=3,
    )  # fmt: skip
    axes.set_xlim(0.0, float(lags[-1]))
    axes.set_ylim(top=1.05)
    legend(axes, 1)

    axes = figure.add_subplot(grid[1, 1])
    dress(axes, "Density [1/Nm]", "Residual [Nm]")
    counted = np.ones(len(residual), dtype=bool)
    for first, last in excluded:
        counted[first : last + 1] = False
    residual = residual[counted]
    with np.errstate(over="ignore", invalid="ignore"):
        spread = float(residual.std())
    if 0 < spread < np.inf:
        density, edges = np.histogram(residual, bins=50, density=True)
        axes.stairs(density, edges, fill=True, color=GREY)
        x = np.linspace(edges[0], edges[-1], 200)
        z = (x - residual.mean()) / spread
        axes.plot(
            x, np.exp(-0.5 * z**2) / (spread * np.sqrt(2 * np.pi)), color=RED, linewidth=1.3,
            linestyle=(0, (4, 1.5)), label="normal of the same spread",
        )  # fmt: skip
        legend(axes, 1)
    return figure
