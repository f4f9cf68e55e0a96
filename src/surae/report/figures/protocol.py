"""A measurement protocol: angle, velocity, effort and the triceps' length–velocity plane."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.protocol import Trajectory
from surae.protocol.coverage import L0_TRI, TricepsPath, triceps_path
from surae.recording import MUSCLES
from surae.report.figures.style import (
    BLUE,
    DPI,
    GREY,
    INK,
    MUTED,
    OCHRE,
    dress,
    dress_degrees,
    heading,
    legend,
    new_figure,
    trace,
)

#: The triceps counts as active above this effort.
_ACTIVE = 0.02
#: Effort is drawn at this rate [Hz]: its bursts last about a second.
_EFFORT_HZ = 40.0
#: Columns of the triceps' heads in the effort.
_HEADS = [MUSCLES.index(muscle) for muscle in ("gl", "sol", "gm")]


def protocol_figure(trajectory: Trajectory, *, l0_tri: float = L0_TRI) -> Figure:
    """What a protocol asks of the device and the subject (thesis Figures 2, 3, 6, 8, 9, 36–38).

    Parameters
    ----------
    trajectory : Trajectory
        The protocol.
    l0_tri : float
        Optimal length of the triceps for its plane [m].

    Returns
    -------
    Figure
        Angle; velocity, with the device's limit; target effort, one strip for each muscle; muscle
        length and velocity of the triceps, on the thesis's axes and close up.
    """
    figure = new_figure(9.4)
    figure.set_dpi(DPI)  # that of the rastered points in an SVG
    grid = figure.add_gridspec(7, 2, height_ratios=[1.9, 1.5, 0.42, 0.42, 0.42, 0.42, 2.6])
    lowest = figure.add_subplot(grid[5, :])
    angle, velocity, *strips = (figure.add_subplot(grid[row, :], sharex=lowest) for row in range(5))
    _angle(angle, trajectory)
    _velocity(velocity, trajectory)
    _effort([*strips, lowest], trajectory)
    for axes in (angle, velocity, *strips):
        axes.tick_params(labelbottom=False)
    lowest.set_xlim(0.0, float(trajectory.time[-1]))
    path = triceps_path(trajectory, l0=l0_tri)
    active = trajectory.effort[:, _HEADS].max(axis=1) > _ACTIVE
    whole, close = figure.add_subplot(grid[6, 0]), figure.add_subplot(grid[6, 1])
    _plane(whole, path, active)
    _thesis_axes(whole, path)
    _plane(close, path, active)
    heading(close, "Close up")
    legend(close, 2)
    figure.align_ylabels([angle, velocity, *strips, lowest])
    return figure


def _angle(axes: Axes, trajectory: Trajectory) -> None:
    dress(axes, "Angle [rad]")
    settings = trajectory.settings
    heading(axes, f"{settings.profile}, ankle angle, dorsiflexion positive")
    for end in settings.range_of_motion:
        axes.axhline(end, color=GREY, linewidth=0.9, linestyle=(0, (4, 2)))
    trace(axes, trajectory.time, trajectory.angle, color=INK, linewidth=0.9)
    dress_degrees(axes)


def _velocity(axes: Axes, trajectory: Trajectory) -> None:
    dress(axes, "Velocity\n[rad/s]")
    heading(axes, "Angular velocity")
    trace(axes, trajectory.time, trajectory.velocity, color=INK, linewidth=0.7)
    device = trajectory.settings.device
    if device is not None and device.max_velocity is not None:
        for sign in (1.0, -1.0):
            axes.axhline(
                sign * device.max_velocity, color=OCHRE, linewidth=1.3, linestyle=(0, (5, 2)),
                label=f"limit of {device.name}" if sign > 0.0 else "_",
            )  # fmt: skip
        legend(axes, 1)


def _effort(strips: list[Axes], trajectory: Trajectory) -> None:
    thin = max(1, round(trajectory.settings.rate_hz / _EFFORT_HZ))
    for column, (axes, muscle) in enumerate(zip(strips, MUSCLES, strict=True)):
        last = column == len(strips) - 1
        dress(axes, "", "Time [s]" if last else "")
        axes.set_ylim(0.0, 1.08)
        axes.set_yticks([0.0, 0.5, 1.0])
        axes.set_yticklabels(["0", "", "1"])
        axes.spines["bottom"].set_visible(last)
        axes.tick_params(bottom=last)
        time, effort = trajectory.time[::thin], trajectory.effort[::thin, column]
        axes.fill_between(time, effort, color=GREY, alpha=0.6, linewidth=0)
        trace(axes, time, effort, color=INK, linewidth=0.8)
        axes.text(
            0.008, 0.9, muscle.upper(), transform=axes.transAxes, va="top", fontsize=8,
            weight="bold", color=INK,
        )  # fmt: skip
    heading(strips[0], f"Target effort, {trajectory.settings.task}")
    strips[1].set_ylabel("Effort [-]", fontsize=9, color=INK, y=0.0)


def _plane(axes: Axes, path: TricepsPath, active: np.typing.NDArray[np.bool_]) -> None:
    dress(axes, "Velocity [l0/s]", "Muscle length [L/l0]")
    axes.axhline(0.0, color=MUTED, linewidth=0.7)
    # Dark and small upon light and large: told apart without their hues.
    for chosen, colour, size, label in (
        (~active, GREY, 4.0, "triceps relaxed"),
        (active, BLUE, 2.0, "active"),
    ):
        if chosen.any():
            axes.plot([], [], color=colour, marker=".", markersize=2.0 * size,
                      linestyle="none", label=label)  # fmt: skip
            axes.plot(
                path.length[chosen], path.velocity[chosen], color=colour, marker=".",
                markersize=size, markeredgewidth=0, linestyle="none", rasterized=True,
            )  # fmt: skip


def _thesis_axes(axes: Axes, path: TricepsPath) -> None:
    """The limits of Figures 3 and 38, wider where the motion goes beyond, and the share visited."""
    share = 100 * path.coverage.share
    heading(axes, f"Triceps surae, l0 = {1e3 * path.l0:g} mm: {share:.2g} % visited")
    covered = path.coverage
    for edges, values, limit in (
        (covered.length_edges, path.length, axes.set_xlim),
        (covered.velocity_edges, path.velocity, axes.set_ylim),
    ):
        low, high = min(edges[0], 1.05 * values.min()), max(edges[-1], 1.05 * values.max())
        limit(float(low), float(high))
    for border in covered.velocity_edges[[0, -1]]:
        axes.axhline(border, color=OCHRE, linewidth=1.0, linestyle=(0, (1, 1.5)))
