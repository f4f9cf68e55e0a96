"""A measurement protocol: angle, velocity and effort."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.protocol import Trajectory
from surae.recording import MUSCLES
from surae.report import figures
from surae.report.figures import GREY, INK, OCHRE

#: Effort is drawn at this rate [Hz]: its bursts last about a second.
_EFFORT_HZ = 40.0


def protocol_figure(trajectory: Trajectory) -> Figure:
    """What a protocol asks of the device and the subject (thesis Figures 2, 6, 8, 9, 36, 37).

    Angle; velocity, with the device's limit; target effort, one strip for each muscle.
    """
    figure = figures.new_figure(6.4)
    grid = figure.add_gridspec(6, 1, height_ratios=[1.9, 1.5, 0.42, 0.42, 0.42, 0.42])
    lowest = figure.add_subplot(grid[5])
    angle, velocity, *strips = (figure.add_subplot(grid[row], sharex=lowest) for row in range(5))
    _angle(angle, trajectory)
    _velocity(velocity, trajectory)
    _effort([*strips, lowest], trajectory)
    for axes in (angle, velocity, *strips):
        axes.tick_params(labelbottom=False)
    lowest.set_xlim(0.0, float(trajectory.time[-1]))
    figures.align(figure)
    return figure


def _angle(axes: Axes, trajectory: Trajectory) -> None:
    figures.dress(axes, "Angle [°]")
    settings = trajectory.settings
    figures.heading(axes, f"{settings.profile}, ankle angle, dorsiflexion positive")
    for end in settings.angle_range:
        axes.axhline(math.degrees(end), color=GREY, linewidth=0.9, linestyle=(0, (4, 2)))
    figures.trace(axes, trajectory.time, np.degrees(trajectory.angle), color=INK, linewidth=0.9)


def _velocity(axes: Axes, trajectory: Trajectory) -> None:
    figures.dress(axes, "Velocity\n[°/s]")
    figures.heading(axes, "Angular velocity")
    figures.trace(axes, trajectory.time, np.degrees(trajectory.velocity), color=INK, linewidth=0.7)
    device = trajectory.settings.device
    if device is not None and math.isfinite(device.max_velocity):
        for sign in (1.0, -1.0):
            axes.axhline(
                sign * math.degrees(device.max_velocity),
                color=OCHRE,
                linewidth=1.3,
                linestyle=(0, (5, 2)),
                label=f"limit of {device.name}" if sign > 0.0 else "_",
            )
        figures.legend(axes, 1)


def _effort(strips: list[Axes], trajectory: Trajectory) -> None:
    thin = max(1, round(trajectory.settings.rate_hz / _EFFORT_HZ))
    for column, (axes, muscle) in enumerate(zip(strips, MUSCLES, strict=True)):
        last = column == len(strips) - 1
        figures.dress(axes, "", "Time [s]" if last else "")
        axes.set_ylim(0.0, 1.08)
        axes.set_yticks([0.0, 0.5, 1.0], ["0", "", "1"])
        axes.spines["bottom"].set_visible(last)
        axes.tick_params(bottom=last)
        time = trajectory.time[::thin]
        effort = trajectory.effort[::thin, column]
        axes.fill_between(time, effort, color=GREY, alpha=0.6, linewidth=0)
        figures.trace(axes, time, effort, color=INK, linewidth=0.8)
        axes.text(
            0.008,
            0.9,
            muscle.upper(),
            transform=axes.transAxes,
            va="top",
            fontsize=8,
            weight="bold",
            color=INK,
        )
    figures.heading(strips[0], f"Target effort, {trajectory.settings.task}")
    strips[1].set_ylabel("Effort [-]", fontsize=9, color=INK, y=0.0)
