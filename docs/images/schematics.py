"""Draw the thesis's schematics with our symbols.

A muscle (Figure 1), the estimation around the manipulator (4 and 5), and the models (10).
"""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

HERE = Path(__file__).parent
INK, BLUE, RED, PALE = "#1c2430", "#1f4e8c", "#a9341f", "#e8eef6"


def canvas(width: float, height: float) -> tuple[Figure, Axes]:
    """An empty drawing in units of 1/10 inch."""
    figure = Figure((width / 10, height / 10), dpi=200)
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, width), ylim=(0, height))
    axes.axis("off")
    return figure, axes


def box(axes: Axes, x: float, y: float, text: str, w: float = 15, h: float = 6) -> None:
    """A box with text about a point."""
    axes.add_patch(
        FancyBboxPatch(
            (x - w / 2, y - h / 2), w, h, "round,pad=0,rounding_size=0.8", fc=PALE, ec=BLUE, lw=1
        )
    )
    axes.text(x, y, text, ha="center", va="center", fontsize=7.5, color=INK, linespacing=1.3)


def arrow(
    axes: Axes, *points: tuple[float, float], text: str = "", at: Sequence[float] = ()
) -> None:
    """An arrow through points, and what goes along it."""
    axes.plot(*zip(*points, strict=True), color=INK, lw=0.9, solid_capstyle="butt")
    style = {"arrowstyle": "-|>", "color": INK, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", points[-1], points[-2], arrowprops=style)
    if text:
        axes.text(*at, text, ha="center", va="bottom", fontsize=7, color=INK)


def line(axes: Axes, xs: Sequence[float], ys: Sequence[float], colour: str = INK) -> None:
    """A plain line."""
    axes.plot(xs, ys, color=colour, lw=1.3, solid_capstyle="round")


def spring(axes: Axes, x: float, y: float, length: float, text: str) -> None:
    """A spring from a point to the right."""
    part = [0, 0.15, 0.21, 0.33, 0.45, 0.57, 0.69, 0.81, 0.87, 1]
    up = [0, 0, 1.2, -1.2, 1.2, -1.2, 1.2, -1.2, 0, 0]
    line(axes, [x + p * length for p in part], [y + u for u in up], BLUE)
    axes.text(x + length / 2, y + 1.8, text, ha="center", va="bottom", fontsize=7.5, color=INK)


def muscle() -> Figure:
    """A muscle group between bone and tendon."""
    figure, axes = canvas(66, 27)
    line(axes, [4, 4], [4, 23])
    for y in (6, 12, 18):
        line(axes, [4, 2.4], [y, y - 1.6])
    line(axes, [4, 8], [13.5, 13.5])
    line(axes, [8, 8], [8, 19])
    line(axes, [38, 38], [8, 19])
    spring(axes, 8, 19, 30, "tissue: $k$, $x_0$, relaxing by $k_{rel}$, $\\tau_{rel}$ (10, 11)")
    line(axes, [8, 17], [8, 8], RED)
    line(axes, [29, 38], [8, 8], RED)
    axes.add_patch(FancyBboxPatch((17, 5.6), 12, 4.8, "square,pad=0", fc="white", ec=RED, lw=1.2))
    axes.text(23, 8, r"$\alpha\,f_l(l_0)\,f_v$", ha="center", va="center", fontsize=8, color=INK)
    arrow(axes, (23, 1.8), (23, 5.4))
    axes.text(24, 2, "EMG × $g$, filtered by $f_0$, $\\beta$ (13, 14)", fontsize=7, color=INK)
    spring(axes, 38, 13.5, 18, "tendon: $\\varepsilon_0$, $\\bar F_{toe}$ (18–21)")
    arrow(axes, (56, 13.5), (62, 13.5), text="$F$", at=(59.5, 14))
    axes.text(23, 24, "muscle, length $x$", ha="center", fontsize=7.5, color=INK)
    axes.text(47, 8.6, "rigid in model 1.0", ha="center", fontsize=7, color=INK)
    return figure


def estimation() -> Figure:
    """From leg and manipulator to estimates."""
    figure, axes = canvas(72, 32)
    box(axes, 9, 25, "manipulator\nmoves the ankle")
    box(axes, 9, 9, "leg\npulls")
    box(axes, 37, 9, "model\n$I\\ddot\\theta$, gravity, muscles")
    box(axes, 37, 25, "sum of squares\nof the difference")
    box(axes, 62, 17, "search\nof the parameters")
    arrow(axes, (9, 22), (9, 12))
    axes.text(9.8, 17, "angle $\\theta$", fontsize=7, color=INK, va="center")
    arrow(axes, (16.5, 8), (29.5, 8), text="EMG $e_1 … e_4$", at=(23, 8.2))
    arrow(axes, (9, 18.9), (21.5, 18.9), (21.5, 11), (29.5, 11))
    axes.text(22.1, 13.2, "$\\theta, \\dot\\theta, \\ddot\\theta$", fontsize=7, color=INK)
    arrow(axes, (4, 12), (4, 22))
    axes.text(3.6, 17, "torque", fontsize=7, color=INK, va="center", ha="right", rotation=90)
    arrow(axes, (16.5, 25), (29.5, 25), text="measured $T$", at=(23, 25.2))
    arrow(axes, (37, 12), (37, 22))
    axes.text(37.8, 17, "modelled $T$", fontsize=7, color=INK, va="center")
    arrow(axes, (44.5, 25), (62, 25), (62, 20))
    arrow(axes, (62, 14), (62, 9), (44.5, 9), text="15 to 17 values", at=(54, 9.2))
    return figure


def models() -> Figure:
    """What each model adds to the one before."""
    figure, axes = canvas(62, 40)
    for x, y, text in (
        (31, 36, "model of 2010\nmuscle-2010, 10 free"),
        (31, 25.5, "[1.0] muscle, 15 free\ntibialis, relaxation, rigid tendons"),
        (31, 15, "[2.0] muscle-tendon, 15 free\ncompliant tendons, as Table 2"),
        (13, 4.5, "[2.1] muscle-tendon-strain\n$\\varepsilon_0$ freed, 17 free"),
        (49, 4.5, "[2.2] muscle-tendon-toe\n$\\bar F_{toe}$ freed, 17 free"),
    ):
        box(axes, x, y, text, w=25, h=6.4)
    for a, b in ((32.8, 28.8), (22.3, 18.3)):
        arrow(axes, (31, a), (31, b))
    for x in (13, 49):
        arrow(axes, (31, 11.8), (31, 9.8), (x, 9.8), (x, 7.8))
    return figure


for name, draw in (("muscle", muscle), ("estimation", estimation), ("models", models)):
    draw().savefig(HERE / f"schematic-{name}.png")
