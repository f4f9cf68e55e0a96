"""Figures of the joint fits: errors, intervals and held-out torque, a look for each way."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from surae.report.figures import BLUE, GREY, INK, OCHRE, RED, dress, heading, new_figure
from surae_thesis.cohort.boxes import Box, Panel, vaf_figure
from surae_thesis.cohort.joint import Way
from surae_thesis.cohort.members import PASSIVE_PROTOCOL
from surae_thesis.cohort.results import Point

_LOOKS: tuple[dict[str, Any], ...] = (
    {"facecolor": "white", "edgecolor": INK},
    {"facecolor": GREY, "edgecolor": INK},
    {"facecolor": OCHRE, "edgecolor": INK, "hatch": "///"},
    {"facecolor": BLUE, "edgecolor": INK},
)
#: Errors below this are drawn at it [%].
_LEAST = 0.1


def error_figure(ways: Sequence[Way], names: Sequence[str]) -> Figure:
    """Box plots of relative errors on a logarithmic axis, parameters side by side."""
    figure = new_figure(4.4)
    axes = figure.subplots()
    dress(axes, "Error against the truth [%]")
    axes.grid(visible=False, axis="x")
    axes.axhline(10.0, color=RED, linewidth=1.0, linestyle=(0, (5, 2)), zorder=1)
    width = 0.8 / len(ways)
    for number, (way, look) in enumerate(zip(ways, _LOOKS, strict=False)):
        for at, name in enumerate(names):
            errors = 100.0 * way.errors((name,))
            if len(errors):
                axes.boxplot(
                    [np.maximum(errors, _LEAST)],
                    positions=[at + (number - 0.5 * (len(ways) - 1)) * width],
                    widths=0.85 * width, patch_artist=True, showfliers=False,
                    boxprops={**look, "linewidth": 0.7},
                    medianprops={"color": RED, "linewidth": 1.6},
                    whiskerprops={"linewidth": 0.7}, capprops={"linewidth": 0.7},
                )  # fmt: skip
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.set_xticks(range(len(names)), names, rotation=45, ha="right", rotation_mode="anchor")
    axes.set_xlim(-0.6, len(names) - 0.4)
    handles = [Patch(label=w.name, **look) for w, look in zip(ways, _LOOKS, strict=False)]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, fontsize=8
    )
    return figure


def coverage_figure(ways: Sequence[Way]) -> Figure:
    """Bars of the share of intervals that hold the truth, two for each way."""
    figure = new_figure(3.4)
    axes = figure.subplots()
    dress(axes, "Intervals that hold the truth [%]")
    axes.grid(visible=False, axis="x")
    axes.axhline(95.0, color=RED, linewidth=1.0, linestyle=(0, (5, 2)))
    for shift, kind, label, look in (
        (-0.2, "white", "equation (34)", _LOOKS[0] | {"hatch": "///"}),
        (0.2, "trusted", "ours", _LOOKS[3]),
    ):
        for at, way in enumerate(ways):
            share, n = way.covered(kind)
            if not n:
                continue
            axes.bar(at + shift, 100 * share, 0.36, label=label if at == 0 else "_", **look)
            axes.annotate(
                f"{100 * share:.0f}", (at + shift, 100 * share), textcoords="offset points",
                xytext=(0, 2), ha="center", fontsize=8, color=INK,
            )  # fmt: skip
    axes.set_ylim(0.0, 104.0)
    axes.set_xticks(range(len(ways)), [way.name for way in ways], fontsize=8)
    axes.legend(loc="upper left", frameon=False, fontsize=8, bbox_to_anchor=(0.0, 0.93))
    heading(axes, "Dashed: 95 %, what they claim")
    return figure


def held_out_figure(ways: Sequence[Way], protocols: Sequence[str]) -> Figure:
    """Box plots of the VAF of the repetition that no fit has seen, a panel for each protocol."""
    panels = []
    for protocol in protocols:
        boxes = [
            Box(
                way.name.replace(" ", "\n", 1),
                [Point(subject, 0, value) for subject, value in way.held_out.get(protocol, ())],
            )
            for way in ways
        ]
        shown = [one.value for box in boxes for one in box.points]
        low = 5.0 * np.floor((np.percentile(shown, 5) if shown else 50.0) / 5.0)
        title = "Ramp and hold" if protocol == PASSIVE_PROTOCOL else "Multiple holds"
        panels.append(Panel(title, boxes, max(float(low), 0.0)))
    return vaf_figure(panels, (), "Held-out VAF [%]")
