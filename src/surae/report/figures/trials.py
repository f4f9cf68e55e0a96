"""Estimates of several trials beside each other."""

from collections.abc import Collection, Mapping

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.inference import Assessment, ParameterEstimate, Verdict
from surae.report import figures
from surae.report.figures import BLUE, GREY, INK, MUTED, WIDTH
from surae.report.parameters import shown_parameters

#: Width of a panel, and height of a trial in it [inch].
_PANEL, _HEIGHT = 2.1, 0.16


def trials_figure(
    fits: Mapping[str, Assessment], joint: Assessment | None, *, disputed: Collection[str] = ()
) -> Figure:
    """Each parameter's estimate and 95 % interval by trial, that of all together as a band.

    Where trials contradict each other in a parameter, it is `disputed` and none of them is drawn as
    identified. There is one panel a parameter; an open mark lies at a bound or has no interval.
    """
    every = [*([] if joint is None else [joint]), *fits.values()]
    free = (p.name for fit in every for p in shown_parameters(fit) if p.free)
    names, trials = list(dict.fromkeys(free)), list(fits)
    columns = max(round(WIDTH / _PANEL), 1)
    rows = -(-len(names) // columns)
    figure = figures.new_figure(rows * (0.75 + _HEIGHT * max(len(fits), 2)))
    panels = figure.subplots(rows, columns, squeeze=False, sharey=True)
    for axes, name in zip(panels.flat, names, strict=False):
        figures.dress(axes, "")
        figures.heading(axes, name)
        if joint is not None and name in joint.parameters:
            _band(axes, joint.parameters[name])
        for place, trial in enumerate(trials):
            if name in fits[trial].parameters:
                _mark(axes, place, fits[trial].parameters[name], name not in disputed)
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


def _mark(axes: Axes, place: int, p: ParameterEstimate, agreed: bool) -> None:
    sure = agreed and p.verdict is Verdict.IDENTIFIED
    if p.ci95 is not None:
        axes.plot(_within(p), [place, place], color=INK if sure else GREY, linewidth=1.6)
    axes.plot(
        [p.value], [place], marker="o", markersize=3.5, linestyle="none", markeredgecolor=INK,
        markerfacecolor=INK if p.ci95 is not None else "white", markeredgewidth=0.8,
    )  # fmt: skip


def _within(p: ParameterEstimate) -> tuple[float, float]:
    """An estimate's interval, cut off at the bounds: beyond them nothing was looked for."""
    assert p.ci95 is not None
    return max(p.ci95[0], p.lower), min(p.ci95[1], p.upper)
