"""Muscle and tendon over time: length, velocity, elongation, force; and the tendon's curve."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.model import TendonLaw, TendonState
from surae.report.figures import (
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
    trace,
)
from surae.report.recordings import GROUPS
from surae.report.traces import Traces
from surae.units import FloatArray

_MILLI = 1e3
#: How many times the largest force an axis may go up to show where the toe ends.
_ROOM = 2.5
#: Points of a tendon's curve.
_POINTS = 200


def tendon_figure(traces: Traces, state: TendonState) -> Figure:
    """Muscle and tendon of both groups over time, and the tendons' curves (thesis Figure 39).

    Triceps surae left, tibialis anterior right: muscle length and velocity in optimal lengths,
    tendon elongation, tendon force, and force against elongation with the range that the recording
    used.
    """
    figure = new_figure(10.2)
    grid = figure.add_gridspec(6, 2, height_ratios=[1.25, 1.1, 1.0, 1.35, 0.03, 1.75], wspace=0.05)
    for row, name in enumerate(GROUPS):
        force = figure.add_subplot(grid[3, row])
        length, velocity, elongation = (
            figure.add_subplot(grid[i, row], sharex=force) for i in range(3)
        )
        _length(length, traces, state, row)
        heading(length, name)
        _velocity(velocity, traces, state, row)
        _elongation(elongation, traces, state, row)
        _force(force, traces, state, row)
        force.set_xlim(float(traces.time[0]), float(traces.time[-1]))
        for axes in (length, velocity, elongation):
            axes.tick_params(labelbottom=False)
        _curve(figure.add_subplot(grid[5, row]), state.laws[row], state.elongation[row])
    figure.align_ylabels()
    return figure


def _length(axes: Axes, traces: Traces, state: TendonState, row: int) -> None:
    dress(axes, "Muscle length\n[l0]")
    optimal = traces.optimal[row]
    rigid = (state.muscle_length[row] + state.elongation[row]) / optimal
    # A wide pale line below a thin dark one: what lies between the two is the tendon's.
    trace(axes, traces.time, rigid, color=GREY, linewidth=2.6)
    trace(axes, traces.time, state.muscle_length[row] / optimal, color=BLUE, linewidth=1.0)


def _velocity(axes: Axes, traces: Traces, state: TendonState, row: int) -> None:
    dress(axes, "Muscle velocity\n[l0/s]")
    optimal = traces.optimal[row]
    axes.axhline(0.0, color=MUTED, linewidth=0.7)
    rigid = (state.muscle_velocity[row] + state.tendon_velocity[row]) / optimal
    trace(axes, traces.time, rigid, label="on a rigid tendon", color=GREY, linewidth=2.6)
    trace(axes, traces.time, state.muscle_velocity[row] / optimal, label="muscle", color=BLUE,
          linewidth=1.0)  # fmt: skip
    legend(axes, 2)


def _elongation(axes: Axes, traces: Traces, state: TendonState, row: int) -> None:
    dress(axes, "Tendon\nelongation [mm]")
    trace(axes, traces.time, _MILLI * state.elongation[row], color=INK, linewidth=1.0)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))


def _force(axes: Axes, traces: Traces, state: TendonState, row: int) -> None:
    dress(axes, "Tendon force\n[N]", "Time [s]")
    force, toe = state.tendon_force[row], state.laws[row].toe_force
    trace(axes, traces.time, force, label="tendon", color=INK, linewidth=1.0)
    trace(axes, traces.time, state.tissue_force[row], label="passive tissue", color=RED,
          linewidth=1.6, linestyle=(0, (4, 1.5)))  # fmt: skip
    highest, room = _highest(force), 1.12
    if toe <= _ROOM * highest:
        axes.axhline(toe, color=OCHRE, linewidth=1.2, linestyle=(0, (1, 1.5)), label="end of toe")
        highest = max(highest, toe)
    else:
        room = 1.3
        axes.text(
            0.99, 0.94, f"toe ends at {toe:.0f} N, above", transform=axes.transAxes, ha="right",
            va="top", fontsize=8, color=INK,
        )  # fmt: skip
    axes.set_ylim(0.0, room * highest or 1.0)
    legend(axes, 3)


def _curve(axes: Axes, law: TendonLaw, elongation: FloatArray) -> None:
    dress(axes, "Tendon force\n[N]", "Tendon elongation [mm]")
    known = elongation[np.isfinite(elongation)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    end = 1.12 * max(high, law.toe_elongation)
    e = np.linspace(min(low, -0.04 * end), end, _POINTS)
    axes.plot(_MILLI * e, law.force(e), color=INK, linewidth=1.0, label="fitted curve")
    if known.size:
        used = np.linspace(low, high, _POINTS)
        axes.plot(_MILLI * used, law.force(used), color=GREY, linewidth=5.0, zorder=1.5,
                  solid_capstyle="butt", label="used here")  # fmt: skip
    axes.plot(_MILLI * law.toe_elongation, law.toe_force, color=OCHRE, marker="D", markersize=5,
              linestyle="none", markeredgecolor=INK, label="end of toe")  # fmt: skip
    axes.set_xlim(_MILLI * float(e[0]), _MILLI * end)
    axes.set_ylim(bottom=-0.03 * float(law.force(e[-1:])[0]))
    legend(axes, 3)


def _highest(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else 0.0
