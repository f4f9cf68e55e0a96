"""Lengths and moment arms that a fit was given, beside those of the thesis."""

import numpy as np
from matplotlib.figure import Figure

from surae.model import GeometryTable, ModelOptions
from surae.model.geometry import Path, paths
from surae.model.joint import ANKLE
from surae.report.figures.style import BLUE, MUTED, dress, heading, legend, new_figure
from surae.units import FloatArray

#: Points of a curve.
_POINTS = 200


def geometry_figure(options: ModelOptions, names: tuple[str, ...]) -> Figure:
    """Moment arm and change of length of both muscle groups, called so, over the angle."""
    table = options.geometry
    assert isinstance(table, GeometryTable)
    angle = np.linspace(*table.range, _POINTS)
    drawn = [
        (how, look, paths(angle=angle, velocity=np.zeros_like(angle), options=of))
        for how, look, of in (
            ("thesis, arms and printed lengths", (MUTED, "-"), ModelOptions()),
            ("integral of the thesis’s arms", (MUTED, "--"), ModelOptions(geometry="virtual-work")),
            (table.name, (BLUE, "-"), options),
        )
    ]  # fmt: skip
    if options.anatomy != ANKLE:  # the thesis has no other joint
        del drawn[:-1]
    figure = new_figure(4.6)
    for group, name in enumerate(names):
        arm, length = (figure.add_subplot(2, 2, 1 + group + row) for row in (0, 2))
        heading(arm, name)
        dress(arm, "Moment arm\n[mm]")
        dress(length, "Change of length\n[mm]", "Angle [°]")
        for how, (colour, style), both in drawn:
            path: Path = both[group]
            degrees, arms = np.degrees(angle), 1e3 * np.abs(path.arm)
            arm.plot(degrees, arms, label=how, linewidth=1.2, color=colour, linestyle=style)
            length.plot(degrees, _travel(angle, path), linewidth=1.2, color=colour, linestyle=style)
        if group == 0:
            legend(arm, 1)
    return figure


def _travel(angle: FloatArray, path: Path) -> FloatArray:
    """Length beyond that at the angle nearest to 0 [mm]."""
    travel: FloatArray = 1e3 * (path.length - path.length[np.argmin(np.abs(angle))])
    return travel
