"""Estimates of several trials beside each other."""

from collections.abc import Collection, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.inference import Assessment, ParameterEstimate, Verdict
from surae.report import figures
from surae.report.figures import BLUE, GREY, GRID, INK, MUTED, WIDTH
from surae.report.parameters import shown_parameters

#: Width of a panel, and height of a trial in it [inch].
_PANEL = 2.1
_HEIGHT = 0.16


def trials_figure(
    fits: Mapping[str, Assessment], joint: Assessment | None, *, disputed: Collection[str] = ()
) -> Figure:
    """Each parameter's estimate and 95 % interval by trial, that of all together as a band.

    Where trials contradict each other in a parameter, it is `disputed` and none of them is drawn as
    identified. There is one panel a parameter; an open mark lies at a bound or has no interval.
    """
    every = [*([] if joint is None else [joint]), *fits.values()]
    free = (p.name for fit in every for p in shown_parameters(fit) if p.free)
    names = list(dict.fromkeys(free))
    trials = list(fits)
    columns = max(round(WIDTH / _PANEL), 1)
    rows = -(-len(names) // columns)
    figure = figures.new_figure(rows * (0.75 + _HEIGHT * max(len(fits), 2)))
    panels = figure.subplots(rows, columns, squeeze=False, sharey=True)
    for axes in panels[
        :, 1:
    ].flat:  # lines where ticks would be, which take a hundred times as long
        axes.yaxis.set_visible(False)
        axes.hlines(
            range(len(trials)),
            0.0,
            1.0,
            transform=axes.get_yaxis_transform(),
            color=GRID,
            linewidth=0.6,
            zorder=0.5,
        )
    for axes, name in zip(panels.flat, names, strict=False):
        figures.dress(axes, "")
        figures.heading(axes, name)
        if joint is not None and name in joint.parameters:
            _band(axes, joint.parameters[name])
        estimates = {
            k: estimate for k, t in enumerate(trials) if (estimate := fits[t].parameters.get(name))
        }
        _mark(axes, estimates, name not in disputed)
        axes.tick_params(axis="y", labelsize=7)
        axes.locator_params(axis="x", nbins=4)
        axes.xaxis.get_offset_text().set(fontsize=7, color=MUTED)
        unit = next(p.unit for a in every if (p := a.parameters.get(name)))
        axes.set_xlabel("" if unit == "-" else unit, fontsize=8, color=MUTED)
    panels[0, 0].set_yticks(range(len(trials)), trials)  # of all panels
    panels[0, 0].set_ylim(len(trials) - 0.4, -0.6)
    for axes in panels.flat[len(names) :]:
        axes.set_visible(False)
    return figure


def _band(axes: Axes, p: ParameterEstimate) -> None:
    if p.ci95 is not None:
        axes.axvspan(*_within(p), facecolor=BLUE, alpha=0.18, linewidth=0)
    axes.axvline(p.value, color=BLUE, linewidth=1.0)


def _mark(axes: Axes, trials: Mapping[int, ParameterEstimate], agreed: bool) -> None:
    known = {place: p for place, p in trials.items() if p.ci95 is not None}
    sure = [agreed and p.verdict is Verdict.IDENTIFIED for p in known.values()]
    low, high = np.array([_within(p) for p in known.values()]).reshape(-1, 2).T
    axes.hlines(list(known), low, high, [INK if s else GREY for s in sure], linewidth=1.6)
    axes.scatter(
        [p.value for p in trials.values()],
        list(trials),
        s=3.5**2,
        edgecolors=INK,
        linewidths=0.8,
        facecolors=[INK if place in known else "white" for place in trials],
        zorder=2.5,
    )


def _within(p: ParameterEstimate) -> tuple[float, float]:
    """An estimate's interval, cut off at the bounds: beyond them nothing was looked for."""
    assert p.ci95 is not None
    return max(p.ci95[0], p.lower), min(p.ci95[1], p.upper)
