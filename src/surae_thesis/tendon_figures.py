"""Figures 10, 39, 44 and 45."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyBboxPatch

from surae.model import MODELS
from surae.report.figures import (
    BLUE,
    GREY,
    INK,
    MUTED,
    OCHRE,
    RED,
    dress,
    heading,
    legend,
    new_figure,
    trace,
)
from surae_thesis.section import Drawing
from surae_thesis.tendons import FINE, SLACK_TIB, SLACK_TRI, printed_force, states, trial


def drawings() -> tuple[Drawing, ...]:
    """All of them."""
    return _tree(), _without_slack(), _with_slack(), _speeds()


def _box(axes: Axes, x: float, y: float, title: str, said: str) -> None:
    axes.add_patch(
        FancyBboxPatch(
            (x - 0.155, y - 0.105), 0.31, 0.21, boxstyle="round,pad=0.005,rounding_size=0.02",
            facecolor="white", edgecolor=INK, linewidth=1.1,
        )
    )  # fmt: skip
    axes.text(x, y + 0.04, title, ha="center", va="center", fontsize=9, weight="bold", color=INK)
    axes.text(x, y - 0.045, said, ha="center", va="center", fontsize=8, color=MUTED)


def _tree() -> Drawing:
    figure = new_figure(3.6)
    axes = figure.add_subplot()
    axes.set(xlim=(0, 1), ylim=(0, 1))
    axes.axis("off")
    places = {
        "muscle": (0.5, 0.87, "rigid tendons"),
        "muscle-tendon": (0.5, 0.5, "compliant tendons"),
        "muscle-tendon-strain": (0.25, 0.13, "tendon strain ε0 free"),
        "muscle-tendon-toe": (0.75, 0.13, "tendon toe force free"),
    }
    for below, above in (
        ("muscle-tendon", "muscle"),
        ("muscle-tendon-strain", "muscle-tendon"),
        ("muscle-tendon-toe", "muscle-tendon"),
    ):
        (x0, y0, _), (x1, y1, _) = places[above], places[below]
        axes.annotate(
            "", xy=(x1, y1 + 0.115), xytext=(x0, y0 - 0.115),
            arrowprops={"arrowstyle": "-|>", "color": MUTED, "linewidth": 1.1},
        )  # fmt: skip
    for name, (x, y, said) in places.items():
        spec = MODELS[name]
        number = spec.title[spec.title.index("[") :]
        _box(axes, x, y, f"{name} {number}", f"{said}, {len(spec.free)} parameters")
    return Drawing(
        name="figure-10",
        title="Figure 10: the tree of models",
        caption="Every step down changes one thing. 2.0, 2.1 and 2.2 are one model with other "
        "parameters freed.",
        alt="The muscle model, below it the muscle-tendon model, below that its two variants.",
        figure=figure,
    )


def _without_slack() -> Drawing:
    figure = new_figure(3.4)
    axes = figure.add_subplot()
    dress(axes, "Tendon force [N]", "Elongation, length less slack length [mm]")
    law = states(trial(125.0)).laws[0]
    elongation = np.linspace(-0.005, 0.04, 400)
    axes.plot(1e3 * elongation, law.force(elongation), color=GREY, linewidth=4.0,
              label=f"slack length {1e3 * SLACK_TRI:g} mm")  # fmt: skip
    half = 0.5 * SLACK_TRI
    axes.plot(1e3 * elongation, printed_force(half + elongation, half), color=INK, linewidth=1.2,
              linestyle=(0, (4, 2)), label=f"{1e3 * half:g} mm")  # fmt: skip
    axes.plot([1e3 * law.toe_elongation], [law.toe_force], "o", color=RED, markersize=5,
              label="end of the toe")  # fmt: skip
    heading(axes, "Triceps surae")
    legend(axes, 3)
    return Drawing(
        name="figure-39",
        title="Figure 39: tendon force against elongation",
        caption="Equations (18) to (21) with ε0 in metres: the slack length, once subtracted, "
        "changes nothing.",
        alt="Two curves that coincide: no force when slack, a curved toe, then a straight line.",
        figure=figure,
    )


def _with_slack() -> Drawing:
    figure = new_figure(3.4)
    axes = figure.add_subplot()
    dress(axes, "Tendon force [N]", "Tendon length [m]")
    laws = states(trial(125.0)).laws
    looks = ((INK, "solid", "triceps surae"), (BLUE, (0, (5, 2)), "tibialis anterior"))
    for law, slack, (colour, dashes, label) in zip(
        laws, (SLACK_TRI, SLACK_TIB), looks, strict=True
    ):
        length = np.concatenate([[0.0], slack + np.linspace(0.0, 0.04, 400)])
        force = law.force(length - slack)
        axes.plot(length, force, color=colour, linestyle=dashes, linewidth=1.3, label=label)
        axes.plot([slack + law.toe_elongation], [law.toe_force], "o", color=colour, markersize=4)
    axes.set_xlim(0.0, 0.5)
    axes.set_ylim(-100.0, 8000.0)
    heading(axes, "Both tendons of Table 2; dots: end of the toe")
    legend(axes, 2)
    return Drawing(
        name="figure-44",
        title="Figure 44: tendon force against length",
        caption="No force up to the slack length, then a non-linear toe and a straight line.",
        alt="Two curves, flat at zero and then rising steeply, one at 0.216 m, one at 0.415 m.",
        figure=figure,
    )


def _speeds() -> Drawing:
    figure = new_figure(4.6)
    rows = figure.subplots(2, 1, sharex=True, sharey=True)
    inputs = trial(FINE)
    for axes, scheme, said, colour in zip(
        rows, ("explicit-euler", "implicit"),
        (f"Explicit scheme at {FINE:g} Hz", f"Implicit scheme at {FINE:g} Hz"),
        (OCHRE, INK), strict=True,
    ):  # fmt: skip
        dress(axes, "Muscle speed\n[m/s]", "Time [s]" if scheme == "implicit" else "")
        speed = states(inputs, scheme).muscle_velocity[0]
        trace(axes, inputs.time, speed, color=colour, linewidth=0.7)
        heading(axes, said)
    rows[0].set_xlim(0.0, float(inputs.time[-1]))
    return Drawing(
        name="figure-45",
        title="Figure 45: rate of length change of the triceps",
        caption="The same trial of the same subject by both integrators. The explicit one, the "
        "thesis's, chatters between the clamps ±vmax wherever the muscle is hardly active.",
        alt="Above, a dense band of oscillation between the clamps; below, a smooth speed.",
        figure=figure,
    )
