"""Lengths and moment arms that a fit was given, beside those of the thesis."""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from surae.model import GeometryTable, ModelOptions
from surae.model.geometry import paths
from surae.model.joint import ANKLE
from surae.report.figures.style import BLUE, MUTED, dress, heading, legend, new_figure
from surae.units import FloatArray

#: Points of a curve.
_POINTS = 200


def geometry_figure(options: ModelOptions, names: tuple[str, ...]) -> Figure:
    """Moment arm and change of length of both muscle groups, called so, over the angle.

    With a second angle for its ends and its middle.
    """
    table = options.geometry
    assert isinstance(table, GeometryTable)
    angle = np.linspace(*table.range, _POINTS)
    still, rest = np.zeros_like(angle), int(np.argmin(np.abs(angle)))
    drawn: list[tuple[str, str, str, ModelOptions, tuple[FloatArray, ...]]] = [
        ("thesis, arms and printed lengths", MUTED, "-", ModelOptions(), ()),
        ("integral of the thesis’s arms", MUTED, "--", ModelOptions(geometry="virtual-work"), ()),
    ]
    if options.anatomy != ANKLE:  # the thesis has no other joint
        drawn = []
    drawn.append((table.name, BLUE, "-", options, ()))
    for second, line in zip(table.second[:: len(table.second) - 1 or 1], (":", "--"), strict=False):
        how = f"second angle {math.degrees(second):.0f}°"
        drawn.append((how, BLUE, line, options, (still + second, still)))
    figure = new_figure(4.6)
    for group, name in enumerate(names):
        arm, length = (figure.add_subplot(2, 2, 1 + group + row) for row in (0, 2))
        heading(arm, name)
        dress(arm, "Moment arm\n[mm]")
        dress(length, "Change of length\n[mm]", "Angle [°]")
        middle = 0.0
        for how, colour, style, of, at in drawn:
            path = paths(angle=angle, velocity=still, options=of, second=at)[group]
            if not at:
                middle = float(path.length[rest])
            look: dict[str, Any] = {"linewidth": 1.2, "color": colour, "linestyle": style}
            arm.plot(np.degrees(angle), 1e3 * np.abs(path.arm), label=how, **look)
            length.plot(np.degrees(angle), 1e3 * (path.length - middle), **look)
        if group == 0:
            legend(arm, 1)
    return figure
