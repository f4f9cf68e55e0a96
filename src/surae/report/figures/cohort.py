"""Figures of a cohort: every leg and its group's mean, legs over sessions, and against a scale."""

from collections.abc import Sequence

from surae.base.normal import NORMAL
from surae.cohorts.quantity import PooledQuantity
from surae.report import figures
from surae.report.figures import BLUE, GREY, INK, MUTED, OCHRE, RED, Axes, Figure

_COLOURS = (INK, BLUE, OCHRE, RED)
_MARKERS = ("o", "s", "^", "D")
#: Legs from which names are left away.
_MOST = 60


def forest_figure(pooled: PooledQuantity) -> Figure:
    """Every leg as it was found and as its group draws it, with the groups' means below."""
    legs = sorted(pooled.legs, key=lambda leg: (leg.group, leg.value))
    groups = list(dict.fromkeys(leg.group for leg in legs))
    rows = len(legs) + len(pooled.groups)
    step = 0.2 if len(legs) <= _MOST else 6.0 / len(legs)
    figure = figures.new_figure(1.0 + step * rows, width=7.2)
    axes = figure.subplots()
    for row, leg in enumerate(legs):
        look = groups.index(leg.group) % len(_COLOURS)
        axes.plot(
            [leg.value - NORMAL * leg.sd, leg.value + NORMAL * leg.sd],
            [row, row],
            color=GREY,
            linewidth=1.0,
        )
        axes.plot([leg.value], [row], marker=_MARKERS[look], markersize=3, color=GREY)
        axes.plot(leg.ci95, [row, row], color=_COLOURS[look], linewidth=1.4)
        axes.plot([leg.shrunken], [row], marker=_MARKERS[look], markersize=4, color=_COLOURS[look])
    for row, (group, effects) in enumerate(pooled.groups.items(), len(legs)):
        look = groups.index(group) % len(_COLOURS) if group in groups else 0
        low, high = effects.ci95
        axes.fill(
            [low, effects.mean, high, effects.mean],
            [row, row - 0.4, row, row + 0.4],
            color=_COLOURS[look],
        )
        axes.axvline(effects.mean, color=_COLOURS[look], linewidth=0.6, linestyle=":")
    figures.dress(axes, "", f"{pooled.name} [{pooled.unit}]")
    names = [leg.leg for leg in legs] if len(legs) <= _MOST else [""] * len(legs)
    axes.set_yticks(
        range(rows), [*names, *(f"{g or 'all'}, mean" for g in pooled.groups)], fontsize=7
    )
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
        names, heights = zip(*values, strict=True)
        at = [sessions.index(name) for name in names]
        axes.plot(
            at,
            heights,
            marker=_MARKERS[look],
            markersize=4,
            linewidth=1.0,
            color=_COLOURS[look],
            label="_",
        )
    axes.set_xticks(range(len(sessions)), sessions)
    _legend(axes, groups)
    figures.dress(axes, label, "session")
    return figure


def _legend(axes: Axes, groups: Sequence[str]) -> None:
    if len(groups) > 1:
        for look, group in enumerate(groups):
            axes.plot(
                [],
                [],
                marker=_MARKERS[look % 4],
                linestyle="",
                label=group or "all",
                color=_COLOURS[look % 4],
            )
        axes.legend(frameon=False, fontsize=7.5, labelcolor=INK)
