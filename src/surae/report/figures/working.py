"""Torque over angle of an ankle that steps, and how stiff it is under load."""

import numpy as np

from surae.measures.working import WorkingStiffness
from surae.report.figures import BLUE, INK, Figure, card_legend, dress, new_figure
from surae.report.figures.leg import CARD_WIDTH
from surae.report.figures.nerve import tick
from surae.report.language import Words


def working_figure(steps: WorkingStiffness, _: Words) -> Figure:
    """Mean torque [Nm] over mean angle [deg] of a cycle, and the slope under load through it."""
    figure = new_figure(2.6, width=CARD_WIDTH)
    axes = figure.subplots()
    axes.plot(steps.angle, steps.torque, color=INK, linewidth=1.2, label=_("mean of the steps"))
    angle = np.array([steps.from_deg, steps.to_deg])
    axes.plot(
        angle,
        steps.middle[1] + steps.value * (angle - steps.middle[0]),
        color=BLUE,
        linewidth=3.0,
        label=f"{_.number(f'{steps.value:.2g}')} Nm/°",
    )
    dress(axes, _("Torque [Nm]"), _("Ankle angle [°], dorsiflexion positive"))
    tick(axes, _)
    card_legend(axes)
    return figure
