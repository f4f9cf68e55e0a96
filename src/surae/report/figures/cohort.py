"""Figures of a cohort: every leg and its group's mean, and legs before and after."""

from matplotlib.figure import Figure

from surae.measures.cohort import Pooled
from surae.report.figures.style import BLUE, GREY, INK, MUTED, OCHRE, RED, dress, new_figure

_COLOURS = (INK, BLUE, OCHRE, RED)
_MARKERS = ("o", "s", "^", "D")
#: Legs from which names are left away.
_MOST = 60


def forest_figure(pooled: Pooled) -> Figure:
    """Every leg as it was found and as its group draws it, with the groups' means below.

    Parameters
    ----------
    pooled : Pooled
        A measure or parameter over the cohort.
    """
    legs = sorted(pooled.legs, key=lambda leg: (leg.group, leg.value))
    groups = list(dict.fromkeys(leg.group for leg in legs))
    rows = len(legs) + len(pooled.groups)
    step = 0.2 if len(legs) <= _MOST else 6.0 / len(legs)
    figure = new_figure(1.0 + step * rows, width=7.2)
    axes = figure.subplots()
    for row, leg in enumerate(legs):
        look = groups.index(leg.group) % len(_COLOURS)
        axes.plot([leg.value - 1.96 * leg.sd, leg.value + 1.96 * leg.sd], [row, row],
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
    dress(axes, "", f"{pooled.name} [{pooled.unit}]")
    names = [leg.leg for leg in legs] if len(legs) <= _MOST else [""] * len(legs)
    axes.set_yticks(range(rows), [*names, *(f"{g or 'all'}, mean" for g in pooled.groups)],
                    fontsize=7)  # fmt: skip
    axes.tick_params(axis="y", length=0, labelcolor=MUTED)
    axes.invert_yaxis()
    return figure
