"""Figures 2, 3, 6 to 9 and 36 to 38."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from surae.protocol import Trajectory, chirp, chirp_rate, triceps_path
from surae.recording import MUSCLES
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
from surae_thesis.movements import basic, chirped, for_achilles
from surae_thesis.section import Drawing

#: The four muscles, told apart by dashes as well as by colour.
_LOOKS = {
    "ta": (BLUE, "solid", "tibialis anterior"),
    "gl": (OCHRE, (0, (4, 1)), "gastrocnemius lateralis"),
    "sol": (INK, (0, (1, 1)), "soleus"),
    "gm": (RED, (0, (5, 1, 1, 1)), "gastrocnemius medialis"),
}
_LETTERED = {
    "6A": ("sine", "Sine wavelet of 0.20 Hz"),
    "6B": ("multiple-holds", "Multiple holds"),
    "6C": ("multi-sine", "Multi-sine"),
    "6D": ("multi-sine-holds", "Multi-sine with holds"),
    "6E": ("scaled-chirp", "Scaled chirp"),
}
#: EMG of the largest effort in Figure 9 [V].
_FULL = 6e-4


def drawings() -> tuple[Drawing, ...]:
    """All of them, in the thesis's order."""
    return (
        _ramp_and_hold(),
        _plane("figure-3", "Figure 3: length and velocity of the triceps, ramp and hold",
               basic("ramp-and-hold", "passive")),
        _basic(),
        _chirp(),
        _chirped(),
        _efforts(),
        _adapted("figure-36", "multiple-holds", "Figure 36: multiple holds for the manipulator"),
        _adapted(
            "figure-37", "multi-sine-holds", "Figure 37: multi-sine with holds for the manipulator"
        ),
        _plane("figure-38", "Figure 38: length and velocity of the triceps, multi-sine with holds",
               chirped("multi-sine-holds")),
    )  # fmt: skip


def _position(axes: Axes, trajectory: Trajectory, *, last: bool = True, **line: object) -> None:
    """Angle from full plantarflexion, as the thesis draws it."""
    dress(axes, "Ankle angle\n[rad]", "Time [s]" if last else "")
    low, high = trajectory.settings.range_of_motion
    look = {"color": INK, "linewidth": 1.0} | line
    trace(axes, trajectory.time, trajectory.angle - low, **look)  # type: ignore[arg-type]
    axes.set_ylim(-0.06, high - low + 0.06)
    axes.set_yticks([0.0, 0.5, 1.0, 1.5])


def _ramp_and_hold() -> Drawing:
    figure = new_figure(2.6)
    axes = figure.add_subplot()
    _position(axes, basic("ramp-and-hold", "passive"))
    heading(axes, "Ramp and hold")
    return Drawing(
        name="figure-2",
        title="Figure 2: the ramp-and-hold protocol",
        caption="Full plantarflexion at 0 rad, full dorsiflexion at 1.5 rad; 18 s.",
        alt="The angle rises in one ramp to full dorsiflexion, is held, and returns.",
        figure=figure,
    )


def _plane(name: str, title: str, trajectory: Trajectory) -> Drawing:
    figure = new_figure(4.2)
    figure.set_figwidth(6.2)
    axes = figure.add_subplot()
    dress(axes, "Velocity [l0/s]", "Muscle length [L/l0]")
    path = triceps_path(trajectory)
    axes.axhline(0.0, color=MUTED, linewidth=0.7)
    axes.plot(
        path.length, path.velocity, color=BLUE, marker=".", markersize=2.6, markeredgewidth=0,
        linestyle="none", rasterized=True,
    )  # fmt: skip
    axes.set(xlim=(0.3, 1.2), ylim=(-5.0, 5.0))
    share = 100 * path.coverage.share
    heading(axes, f"Triceps surae, l0 = {1e3 * path.l0:g} mm: {share:.2g} % of the plane visited")
    return Drawing(
        name=name,
        title=title,
        caption="Each point is one sample: muscle length by equation (9) and its rate of change, "
        "both in optimal lengths, on the thesis's axes.",
        alt=f"A cloud of points that covers {share:.2g} % of the length–velocity plane.",
        figure=figure,
    )


def _basic() -> Drawing:
    figure = new_figure(7.6)
    rows: Sequence[Axes] = figure.subplots(len(_LETTERED), 1, sharex=True)
    for number, (axes, (letter, (profile, title))) in enumerate(
        zip(rows, _LETTERED.items(), strict=True)
    ):
        _position(axes, basic(profile), last=number == len(rows) - 1)
        heading(axes, f"{letter}. {title}")
    rows[0].set_xlim(0.0, 40.0)
    return Drawing(
        name="figure-6",
        title="Figure 6: the five basic profiles",
        caption="Full plantarflexion at 0 rad, full dorsiflexion at 1.5 rad.",
        alt="Five time courses of the ankle angle, each spanning the whole range of motion.",
        figure=figure,
    )


def _chirp() -> Drawing:
    figure = new_figure(2.6)
    axes = figure.add_subplot()
    dress(axes, "Angle [rad]", "Time [s]")
    time = np.arange(0.0, 30.0, 1e-3)
    axes.plot(time, chirp(time, amplitude=0.2, rate=chirp_rate(0.3))[0], color=INK, linewidth=0.8)
    axes.set_xlim(0.0, 30.0)
    heading(axes, "Chirp of 0.2 rad and factor 0.3")
    return Drawing(
        name="figure-7",
        title="Figure 7: the added chirp",
        caption="A·sin(s·t²) with A = 0.2 rad and s = 0.3: the frequency at time t is s·t/π.",
        alt="An oscillation of constant amplitude whose frequency rises from 0 to 2.9 Hz in 30 s.",
        figure=figure,
    )


def _chirped() -> Drawing:
    figure = new_figure(2.9)
    axes = figure.add_subplot()
    one = chirped("multiple-holds", 0.2, 0.3)
    dress(axes, "Part of the range\nof motion [-]", "Time [s]")
    low, high = one.settings.range_of_motion
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    trace(axes, one.time, (one.angle - middle) / half, color=INK, linewidth=0.8)
    axes.set_yticks([-1.0, -0.5, 0.0, 0.5, 1.0])
    axes.set_xlim(0.0, float(one.time[-1]))
    heading(axes, "Multiple holds with the chirp of Figure 7")
    return Drawing(
        name="figure-8",
        title="Figure 8: multiple holds with a chirp of 0.2 rad",
        caption="The sum of Figures 6B and 7, the holds mapped on a narrower range so that the sum "
        "just reaches full plantarflexion (−1) and full dorsiflexion (1).",
        alt="Holds at several positions with an oscillation of rising frequency upon them.",
        figure=figure,
    )


def _efforts() -> Drawing:
    figure = new_figure(5.2)
    rows: Sequence[Axes] = figure.subplots(2, 1, sharex=True)
    tasks = (("9A", "part-passive", "relaxed to 11 s, then alternating"),
             ("9B", "active", "alternating throughout"))  # fmt: skip
    for axes, (letter, task, said) in zip(rows, tasks, strict=True):
        one = basic("multiple-holds", task)
        for column, muscle in enumerate(MUSCLES):
            colour, dashes, label = _LOOKS[muscle]
            trace(
                axes, one.time, 1e6 * _FULL * one.effort[:, column],
                label=label if letter == "9A" else "",
                color=colour, linestyle=dashes, linewidth=1.1,
            )  # fmt: skip
        dress(axes, "EMG [µV]", "Time [s]" if letter == "9B" else "")
        axes.set_title(f"{letter}. {said}", loc="left", fontsize=9, color=INK, weight="bold", y=1.0)
        axes.set_xlim(0.0, float(one.time[-1]))
    rows[0].legend(loc="upper left", bbox_to_anchor=(0.01, 0.95), frameon=False, fontsize=8)
    return Drawing(
        name="figure-9",
        title="Figure 9: the two EMG tasks",
        caption="Bursts alternate between the triceps surae's three heads and the tibialis "
        "anterior; the largest effort is 600 µV, as in the thesis.",
        alt="Bursts of the four muscles, above from 11 s on, below from the start.",
        figure=figure,
    )


def _adapted(name: str, profile: str, title: str) -> Drawing:
    figure = new_figure(4.2)
    angle, velocity = figure.subplots(2, 1, sharex=True)
    before, after = chirped(profile), for_achilles(profile)
    _position(angle, after, last=False)
    heading(angle, "As the manipulator is asked to move")
    dress(velocity, "Velocity\n[rad/s]", "Time [s]")
    trace(velocity, before.time, before.velocity, color=GREY, linewidth=0.7, label="before")
    trace(velocity, after.time, after.velocity, color=INK, linewidth=0.9, label="after")
    for sign in (-1.0, 1.0):
        velocity.axhline(
            sign * 1.5, color=OCHRE, linewidth=1.2, linestyle=(0, (5, 2)),
            label="1.5 rad/s" if sign > 0 else "_",
        )  # fmt: skip
    velocity.set_ylim(-10.0, 10.0)
    velocity.set_xlim(0.0, float(after.time[-1]))
    legend(velocity, 3)
    adaptation = after.adaptation
    return Drawing(
        name=name,
        title=title,
        caption=" ".join(adaptation.steps) if adaptation else "",
        alt="The angle of the filtered profile; its velocity stays within ±1.5 rad/s, that of the "
        "unfiltered one does not.",
        figure=figure,
    )
