"""The four panels of the thesis: EMG, angle, measured and modelled torque, torque parts."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.recording import MUSCLES
from surae.report.figures.style import (
    BLUE,
    GREY,
    INK,
    MUTED,
    OCHRE,
    RED,
    dress,
    heading,
    legend,
    new_figure,
    shade_excluded,
    trace,
)
from surae.report.traces import Traces

_MICRO = 1e6


def torque_figure(traces: Traces) -> Figure:
    """Figure like 18–20 of the thesis: what went in, what came out, and what it is made of.

    Parameters
    ----------
    traces : Traces
        Signals of one recording.

    Returns
    -------
    Figure
        EMG of the four muscles, one strip each on one scale; angle; torque; torque parts.
    """
    figure = new_figure(9.0)
    grid = figure.add_gridspec(7, 1, height_ratios=[0.5, 0.5, 0.5, 0.5, 1.3, 2.1, 2.1])
    bottom = figure.add_subplot(grid[6])
    *strips, angle, torque = (figure.add_subplot(grid[row], sharex=bottom) for row in range(6))
    _emg(strips, traces)
    _angle(angle, traces)
    _torque(torque, traces)
    _parts(bottom, traces)
    for axes in (*strips, angle, torque):
        axes.tick_params(labelbottom=False)
    bottom.set_xlim(float(traces.time[0]), float(traces.time[-1]))
    figure.align_ylabels()
    return figure


def _emg(strips: list[Axes], traces: Traces) -> None:
    volts = traces.emg_unit == "V"
    signals = traces.emg * (_MICRO if volts else 1.0)
    highest = float(signals.max()) or 1.0
    for column, (axes, muscle) in enumerate(zip(strips, MUSCLES, strict=True)):
        dress(axes, "")
        axes.set_ylim(0.0, 1.08 * highest)
        axes.spines["bottom"].set_visible(column == len(strips) - 1)
        axes.tick_params(bottom=False)
        axes.locator_params(axis="y", nbins=2)
        name = muscle.upper()
        if muscle in traces.missing_emg:
            name += " (not recorded)"
        axes.text(
            0.008, 0.94, name, transform=axes.transAxes, va="top", fontsize=8, weight="bold",
            color=INK, bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
        )  # fmt: skip
        trace(axes, traces.time, signals[:, column], color=INK, linewidth=0.7)
    heading(strips[0], "EMG, on one scale")
    strips[1].set_ylabel(f"EMG [{'µV' if volts else '-'}]", fontsize=9, color=INK, y=0.0)


def _angle(axes: Axes, traces: Traces) -> None:
    dress(axes, "Angle [rad]")
    heading(axes, "Ankle angle, dorsiflexion positive")
    trace(axes, traces.time, traces.angle, color=INK, linewidth=1.1)
    degrees = axes.secondary_yaxis("right", functions=(np.degrees, np.radians))
    degrees.set_ylabel("Angle [°]", fontsize=9, color=INK)
    degrees.tick_params(labelsize=8, color=MUTED, labelcolor=INK, length=3, width=0.7)
    degrees.spines["right"].set(color=MUTED, linewidth=0.7)


def _torque(axes: Axes, traces: Traces) -> None:
    dress(axes, "Torque [Nm]")
    heading(axes, "Torque, triceps positive")
    # A wide pale line below a thin dark one: where they part is visible without any hue.
    trace(axes, traces.time, traces.measured, label="measured", color=GREY, linewidth=3.0)
    trace(axes, traces.time, traces.modelled, label="modelled", color=BLUE, linewidth=1.0)
    shade_excluded(axes, traces.time, traces.excluded)
    legend(axes, 3)


def _parts(axes: Axes, traces: Traces) -> None:
    dress(axes, "Torque [Nm]", "Time [s]")
    heading(axes, "Parts of the modelled torque")
    parts = traces.parts
    styles: list[tuple[str, dict[str, object]]] = [
        ("tissue", {"color": RED, "linewidth": 2.0, "linestyle": "solid"}),
        ("neural", {"color": BLUE, "linewidth": 1.0, "linestyle": "solid"}),
        ("inertial", {"color": INK, "linewidth": 1.0, "linestyle": (0, (1, 1.2))}),
        ("gravitational", {"color": OCHRE, "linewidth": 1.5, "linestyle": (0, (5, 2))}),
    ]
    if parts.reflex is not None:  # within the neural part, not beside it
        reflex: dict[str, object] = {"color": INK, "linewidth": 1.2, "linestyle": (0, (4, 1, 1, 1))}
        styles.append(("reflex", reflex))
    if parts.zero is not None:
        styles.append(("zero", {"color": MUTED, "linewidth": 2.0, "linestyle": (0, (2, 3))}))
    for name, line in styles:
        trace(axes, traces.time, getattr(parts, name), label=name, **line)
    legend(axes, len(styles))
