"""Muscle and tendon over time: length, velocity, elongation, force; and the tendon's curve."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.base.units import FloatArray
from surae.inference.judging.fascicles import Fascicles
from surae.model import TendonLaw, TendonState
from surae.report import figures
from surae.report.figures import BLUE, GREY, INK, OCHRE, RED, WIDTH
from surae.report.traces import Traces

_MILLI = 1e3
#: How many times the largest force an axis may go up to show where the toe ends.
_ROOM = 2.5
#: Points of a tendon's curve.
_POINTS = 200


def tendon_figure(traces: Traces, state: TendonState) -> Figure:
    """Muscle and tendon of both groups over time, and the tendons' curves (thesis Figure 39).

    Triceps surae left, tibialis anterior right; lengths and velocities in optimal lengths.
    """
    figure = figures.new_figure(10.2, layout=None)
    grid = figure.add_gridspec(6, 2, height_ratios=[1.25, 1.1, 1.0, 1.35, 0.03, 1.75])
    start = float(traces.time[0])
    end = float(traces.time[-1])
    for row, name in enumerate(traces.joint.headings):
        force = figure.add_subplot(grid[3, row])
        above = [figure.add_subplot(grid[i, row], sharex=force) for i in range(3)]
        length, velocity, elongation = above
        optimal = traces.optimal[row]
        muscle = state.muscle_length[row]
        speed = state.muscle_velocity[row]
        for axes, what, of_muscle, rigid in (
            (length, "length\n[l0]", muscle, muscle + state.elongation[row]),
            (velocity, "velocity\n[l0/s]", speed, speed + state.tendon_velocity[row]),
        ):
            figures.dress(axes, f"Muscle {what}")
            # A wide pale line below a thin dark one: what lies between the two is the tendon's.
            figures.trace(
                axes,
                traces.time,
                rigid / optimal,
                label="on a rigid tendon",
                color=GREY,
                linewidth=2.6,
            )
            figures.trace(
                axes, traces.time, of_muscle / optimal, label="muscle", color=BLUE, linewidth=1.0
            )
        figures.heading(length, name)
        figures.legend(velocity, 2)
        figures.dress(elongation, "Tendon\nelongation [mm]")
        figures.trace(
            elongation, traces.time, _MILLI * state.elongation[row], color=INK, linewidth=1.0
        )
        elongation.set_ylim(bottom=min(0.0, elongation.get_ylim()[0]))
        _force(force, traces, state, row)
        force.set_xlim(start, end)
        for axes in above:
            axes.tick_params(labelbottom=False)
        _curve(figure.add_subplot(grid[5, row]), state.laws[row], state.elongation[row])
    figures.space(figure, 6, 2)
    return figure


def _force(axes: Axes, traces: Traces, state: TendonState, row: int) -> None:
    figures.dress(axes, "Tendon force\n[N]", "Time [s]")
    force = state.tendon_force[row]
    toe = state.laws[row].toe_force
    figures.trace(axes, traces.time, force, label="tendon", color=INK, linewidth=1.0)
    figures.trace(
        axes,
        traces.time,
        state.tissue_force[row],
        label="passive tissue",
        color=RED,
        linewidth=1.6,
        linestyle=(0, (4, 1.5)),
    )
    highest = float(np.max(force[np.isfinite(force)], initial=0.0))
    room = 1.12
    if toe <= _ROOM * highest:
        axes.axhline(toe, color=OCHRE, linewidth=1.2, linestyle=(0, (1, 1.5)), label="end of toe")
        highest = max(highest, toe)
    else:
        room = 1.3
        axes.text(
            0.99,
            0.94,
            f"toe ends at {toe:.0f} N, above",
            transform=axes.transAxes,
            ha="right",
            va="top",
            fontsize=8,
            color=INK,
        )
    axes.set_ylim(0.0, room * highest or 1.0)
    figures.legend(axes, 3)


def _curve(axes: Axes, law: TendonLaw, elongation: FloatArray) -> None:
    figures.dress(axes, "Tendon force\n[N]", "Tendon elongation [mm]")
    known = elongation[np.isfinite(elongation)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    end = 1.12 * max(high, law.toe_elongation)
    e = np.linspace(min(low, -0.04 * end), end, _POINTS)
    axes.plot(_MILLI * e, law.force(e), color=INK, linewidth=1.0, label="fitted curve")
    if known.size:
        used = np.linspace(low, high, _POINTS)
        axes.plot(
            _MILLI * used,
            law.force(used),
            color=GREY,
            linewidth=5.0,
            zorder=1.5,
            solid_capstyle="butt",
            label="used here",
        )
    axes.plot(
        _MILLI * law.toe_elongation,
        law.toe_force,
        color=OCHRE,
        marker="D",
        markersize=5,
        linestyle="none",
        markeredgecolor=INK,
        label="end of toe",
    )
    axes.set_xlim(_MILLI * float(e[0]), _MILLI * end)
    axes.set_ylim(bottom=-0.03 * float(law.force(e[-1:])[0]))
    figures.legend(axes, 3)


#: Of the figure [inch].
_HEIGHT = 8.2
#: Wide and pale below thin and dark: told apart without colour.
_FILMED: dict[str, Any] = {"color": GREY, "linewidth": 3.0, "label": "filmed"}
_MODEL: dict[str, Any] = {"color": BLUE, "linewidth": 1.1, "label": "model"}


def film_figure(traces: Traces, film: Fascicles, figure: Figure | None = None) -> Figure:
    """Torque, fascicle length and tendon stretch over time, and force over both lengths.

    What the film shows is wide and pale, the model thin and dark; force is the model's.
    """
    figure = figures.new_figure(_HEIGHT) if figure is None else figure
    figure.set_size_inches(WIDTH, _HEIGHT)
    grid = figure.add_gridspec(5, 2, height_ratios=[1.0, 1.2, 1.2, 0.04, 1.7])
    stretch = figure.add_subplot(grid[2, :])
    torque, length = (figure.add_subplot(grid[row, :], sharex=stretch) for row in (0, 1))
    for axes, what in ((torque, "Torque\n[Nm]"), (length, "Fascicle length\n[mm]")):
        figures.dress(axes, what)
        axes.tick_params(labelbottom=False)
    figures.dress(stretch, "Tendon stretch\n[mm]", "Time [s]")
    torque.plot(traces.time, traces.measured, **{**_FILMED, "label": "measured"})
    torque.plot(traces.time, traces.modelled, **_MODEL)
    for axes, filmed, model in _pairs(film, length, stretch):
        axes.plot(film.time, filmed, **_FILMED)
        axes.plot(film.time, model, **_MODEL)
    stretch.set_xlim(float(traces.time[0]), float(traces.time[-1]))
    loops = [figure.add_subplot(grid[4, column]) for column in range(2)]
    for axes, filmed, model in _pairs(film, *loops):
        # the lines have their names above: a second row of them would lift one heading of two
        axes.plot(filmed, film.force, **{**_FILMED, "label": None})
        axes.plot(model, film.force, **{**_MODEL, "label": None})
        axes.plot(
            model[0], film.force[0], "o", color=INK, markersize=5, label="begin", clip_on=False
        )
        axes.set_ylim(bottom=0.0)
    figures.dress(loops[0], "Force in the model [N]", "Fascicle length [mm]")
    figures.dress(loops[1], "", "Tendon stretch [mm]")
    for axes, text in (
        (torque, "Torque"),
        (length, "Muscle"),
        (stretch, "Tendon"),
        (loops[0], "Force over length"),
        (loops[1], "Force over stretch"),
    ):
        figures.heading(axes, text)
    for axes, columns in ((torque, 2), (length, 2), *((loop, 1) for loop in loops)):
        figures.legend(axes, columns)
    figures.align(figure)
    return figure


def _pairs(film: Fascicles, first: Axes, second: Axes) -> list[tuple[Axes, FloatArray, FloatArray]]:
    """Filmed and modelled length, and stretch [mm], each with what it is drawn on."""
    return [
        (first, _MILLI * film.measured, _MILLI * film.modelled),
        (second, _MILLI * film.filmed_stretch, _MILLI * film.stretch),
    ]
