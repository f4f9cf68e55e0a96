"""A filmed fascicle beside the model's: over time under the torque, and force over lengths."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.assessment.fascicles import Fascicles
from surae.report.figures import BLUE, GREY, INK, WIDTH, dress, heading, legend, new_figure
from surae.report.traces import Traces
from surae.units import FloatArray

#: Of the figure [inch].
_HEIGHT = 8.2
_MILLI = 1e3
#: Wide and pale below thin and dark: told apart without colour.
_FILMED: dict[str, Any] = {"color": GREY, "linewidth": 3.0, "label": "filmed"}
_MODEL: dict[str, Any] = {"color": BLUE, "linewidth": 1.1, "label": "model"}


def film_figure(traces: Traces, film: Fascicles, figure: Figure | None = None) -> Figure:
    """Torque, fascicle length and tendon stretch over time, and force over both lengths.

    What the film shows is wide and pale, the model thin and dark; force is the model's. It is drawn
    on a new figure, or the one given.
    """
    figure = new_figure(_HEIGHT) if figure is None else figure
    figure.set_size_inches(WIDTH, _HEIGHT)
    grid = figure.add_gridspec(5, 2, height_ratios=[1.0, 1.2, 1.2, 0.04, 1.7])
    stretch = figure.add_subplot(grid[2, :])
    torque, length = (figure.add_subplot(grid[row, :], sharex=stretch) for row in (0, 1))
    for axes, what in ((torque, "Torque\n[Nm]"), (length, "Fascicle length\n[mm]")):
        dress(axes, what)
        axes.tick_params(labelbottom=False)
    dress(stretch, "Tendon stretch\n[mm]", "Time [s]")
    torque.plot(traces.time, traces.measured, **{**_FILMED, "label": "measured"})
    torque.plot(traces.time, traces.modelled, **_MODEL)
    for axes, filmed, model in _pairs(film, length, stretch):
        axes.plot(film.time, filmed, **_FILMED)
        axes.plot(film.time, model, **_MODEL)
    stretch.set_xlim(float(traces.time[0]), float(traces.time[-1]))
    loops = [figure.add_subplot(grid[4, column]) for column in range(2)]
    for axes, filmed, model in _pairs(film, *loops):
        axes.plot(filmed, film.force, **_FILMED)
        axes.plot(model, film.force, **_MODEL)
        axes.plot(model[0], film.force[0], "o", color=INK, markersize=5, label="begin")
        axes.set_ylim(bottom=0.0)
    dress(loops[0], "Force in the model [N]", "Fascicle length [mm]")
    dress(loops[1], "", "Tendon stretch [mm]")
    for axes, text in (
        (torque, "Torque"), (length, "Muscle"), (stretch, "Tendon"),
        (loops[0], "Force over length"), (loops[1], "Force over stretch"),
    ):  # fmt: skip
        heading(axes, text)
    for axes, columns in ((torque, 2), (length, 2), (loops[1], 3)):
        legend(axes, columns)
    figure.align_ylabels([torque, length, stretch, loops[0]])
    return figure


def _pairs(film: Fascicles, first: Axes, second: Axes) -> list[tuple[Axes, FloatArray, FloatArray]]:
    """Filmed and modelled length, and stretch [mm], each with what it is drawn on."""
    return [
        (first, _MILLI * film.measured, _MILLI * film.modelled),
        (second, _MILLI * film.filmed_stretch, _MILLI * film.stretch),
    ]
