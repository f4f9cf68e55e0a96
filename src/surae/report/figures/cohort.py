"""Figures of a cohort: every leg and its group's mean, legs over sessions, and against a scale."""

from collections.abc import Collection, Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surae.base.normal import NORMAL
from surae.inference import Assessment, ParameterEstimate, Verdict
from surae.measures.cohort import Pooled
from surae.report import figures
from surae.report.figures import BLUE, GREY, INK, MUTED, OCHRE, RED, WIDTH
from surae.report.parameters import shown_parameters

_COLOURS = (INK, BLUE, OCHRE, RED)
_MARKERS = ("o", "s", "^", "D")
#: Legs from which names are left away.
_MOST = 60


def forest_figure(pooled: Pooled) -> Figure:
    """Every leg as it was found and as its group draws it, with the groups' means below."""
    legs = sorted(pooled.legs, key=lambda leg: (leg.group, leg.value))
    groups = list(dict.fromkeys(leg.group for leg in legs))
    rows = len(legs) + len(pooled.groups)
    step = 0.2 if len(legs) <= _MOST else 6.0 / len(legs)
    figure = figures.new_figure(1.0 + step * rows, width=7.2)
    axes = figure.subplots()
    for row, leg in enumerate(legs):
        look = groups.index(leg.group) % len(_COLOURS)
        axes.plot([leg.value - NORMAL * leg.sd, leg.value + NORMAL * leg.sd], [row, row],
                  color=GREY, linewidth=1.0)  # fmt: skip
        axes.plot([leg.value], [row], marker=_MARKERS[look], markersize=3, color=GREY)
        axes.plot(leg.ci95, [row, row], color=_COLOURS[look], linewidth=1.4)
        axes.plot([leg.shrunken], [row], marker=_MARKERS[look], markersize=4, color=_COLOURS[look])
    for row, (group, effects) in enumerate(pooled.groups.items(), len(legs)):
        look = groups.index(group) % len(_COLOURS) if group in groups else 0
        low, high = effects.ci95
        axes.fill([low, effects.mean, high, effects.mean], [row, row - 0.4, row, row + 0.4],
                  color=_COLOURS[look])  # fmt: skip
        axes.axvline(effects.mean, color=_COLOURS[look], linewidth=0.6, linestyle=":")
    figures.dress(axes, "", f"{pooled.name} [{pooled.unit}]")
    names = [leg.leg for leg in legs] if len(legs) <= _MOST else [""] * len(legs)
    axes.set_yticks(range(rows), [*names, *(f"{g or 'all'}, mean" for g in pooled.groups)],
                    fontsize=7)  # fmt: skip
    axes.tick_params(axis="y", length=0, labelcolor=MUTED)
    axes.invert_yaxis()
    return figure


def sessions_figure(
    label: str, sessions: Sequence[str], legs: Sequence[tuple[str, Sequence[tuple[str, float]]]]
) -> Figure:
    """Each leg, its group and values by session, as a line over its sessions."""
    figure = figures.new_figure(2.6, width=7.2)
    axes = figure.subplots()
    groups = list(dict.fromkeys(group for group, _ in legs))
    for group, values in legs:
        look = groups.index(group) % len(_COLOURS)
        names, own = zip(*values, strict=True)
        at = [sessions.index(name) for name in names]
        axes.plot(at, own, marker=_MARKERS[look], markersize=4, linewidth=1.0,
                  color=_COLOURS[look], label="_")  # fmt: skip
    axes.set_xticks(range(len(sessions)), sessions)
    _legend(axes, groups)
    figures.dress(axes, label, "session")
    return figure


def _legend(axes: Axes, groups: Sequence[str]) -> None:
    if len(groups) > 1:
        for look, group in enumerate(groups):
            axes.plot([], [], marker=_MARKERS[look % 4], linestyle="", label=group or "all",
                      color=_COLOURS[look % 4])  # fmt: skip
        axes.legend(frameon=False, fontsize=7.5, labelcolor=INK)


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
        axes.set_yticks(range(len(trials)), trials, fontsize=7)
        axes.set_ylim(len(trials) - 0.4, -0.6)
        axes.locator_params(axis="x", nbins=4)
        axes.xaxis.get_offset_text().set(fontsize=7, color=MUTED)
        unit = next(p.unit for a in every if (p := a.parameters.get(name)))
        axes.set_xlabel("" if unit == "-" else unit, fontsize=8, color=MUTED)
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
