"""Torque over angle and over EMG, of holds that were fitted together."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from surae.inference.diagnosis import STILL
from surae.quality.numeric import quantiles, smooth
from surae.recording import MUSCLES
from surae.report import block, figures
from surae.report.figures import BLUE, GREY, INK
from surae.report.traces import Traces
from surae.trials import tell_together

#: Parts of a hold's samples between which its torque is drawn, and at how many levels of EMG.
_ENDS = (0.05, 0.95)
_LEVELS = 7
#: EMG is averaged over this [s]: about what activation takes.
_AVERAGED = 0.4


def are_holds(trials: Sequence[Traces]) -> bool:
    """Whether all hold still, at angles that together show torque over angle."""
    angles = [quantiles(each.angle, 0.005, 0.5, 0.995) for each in trials]
    return all(high - low < STILL for low, _, high in angles) and tell_together(
        middle for _, middle, _ in angles
    )


def holds_section(trials: Sequence[Traces]) -> block.Section:
    """Where the torque of holds over angle and EMG stands."""
    picture = block.Picture(
        "holds",
        "Torque of each hold over its angle, and over the EMG at each angle.",
        trials[0].joint.worded(
            "Left: where each hold’s torque lies 90 % of the time, measured (wide, pale) and "
            "modelled (thin, dark). Right: measured torque over the EMG, triceps less tibialis, at "
            "each angle."
        ),
        "here",
    )
    return block.Section("Torque over angle and effort", (picture,), "holds")


def holds_figure(trials: Sequence[Traces]) -> Figure:
    """Draw the torque of holds over angle, and over EMG by angle."""
    figure = figures.new_figure(3.3)
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1, 1.15))
    degrees = [float(np.rad2deg(np.median(each.angle))) for each in trials]
    tops = np.max([each.emg.max(axis=0) for each in trials], axis=0)
    colours = colormaps["viridis"]
    for number in np.argsort(degrees):
        each = trials[number]
        at = degrees[number]
        for signal, colour, width in ((each.measured, GREY, 7.0), (each.modelled, BLUE, 1.5)):
            label = "" if number else "measured" if colour == GREY else "modelled"
            left.plot(
                [at, at],
                quantiles(signal, *_ENDS),
                color=colour,
                linewidth=width,
                solid_capstyle="butt",
                label=label or "_",
            )
        levels = each.emg / np.where(tops > 0.0, tops, 1.0)
        levels = np.array([smooth(column, round(_AVERAGED * each.rate_hz)) for column in levels.T])
        net = 100.0 * (levels[1:].mean(axis=0) - levels[MUSCLES.index("ta")])
        parts = np.array_split(np.argsort(net), _LEVELS)
        colour = colours(0.9 * (at - min(degrees)) / (max(degrees) - min(degrees)))
        right.plot(
            [net[part].mean() for part in parts],
            [each.measured[p].mean() for p in parts],
            "o-",
            color=colour,
            ms=3,
            linewidth=1.3,
            label=f"{at:.0f}°".replace("-", "−"),
        )
    worded = trials[0].joint.worded
    figures.dress(left, "Torque [Nm]", worded("Ankle angle [°], dorsiflexion positive"))
    figures.dress(right, "", worded("EMG, triceps less tibialis [% of the largest]"))
    left.legend(frameon=False, fontsize=8, labelcolor=INK, loc="upper left")
    right.legend(frameon=False, fontsize=7, labelcolor=INK, loc="upper left", ncols=2)
    return figure
