"""The movements and efforts of the thesis: Figures 2, 3, 6 to 9 and 36 to 38."""

from functools import cache

import numpy as np

from surae.protocol import (
    Adaptation,
    Trajectory,
    chirp,
    chirp_rate,
    generate,
)
from surae.recording import MUSCLES
from surae.report.figures import BLUE, GREY, INK, OCHRE, RED
from surae.studies import POPULATIONS
from surae_thesis.claims import Ruling, judge_all
from surae_thesis.coverage import L0_TRI, triceps_path
from surae_thesis.legs import motion, protocol
from surae_thesis.plots import Panel, PlotLine, draw
from surae_thesis.section import Context, Drawing, Result
from surae_thesis.simulation.cells import (
    AMPLITUDES,
    CHOSEN,
    CHOSEN_AMPLITUDE,
    CHOSEN_FACTOR,
    FACTORS,
    PROFILES,
)

#: The five basic profiles of the simulation study (2.5.1) after the one in use before it (2.1).
NAMES = ("ramp-and-hold", *PROFILES)
#: Full plantarflexion and dorsiflexion count as reached within this part of the range.
_REACHED = 0.001
#: Speed that a muscle cannot exceed [l0/s], equation (17), and what Figure 38 shows of it.
_VMAX = 8.0
_SHOWN = 5.0


@cache
def basic(profile: str, task: str = "part-passive") -> Trajectory:
    """A profile without a chirp."""
    return generate(protocol(profile, task, 0.0))


@cache
def chirped(
    profile: str,
    amplitude: float = CHOSEN_AMPLITUDE,
    factor: float = CHOSEN_FACTOR,
    device: str = "",
) -> Trajectory:
    """A profile with the chirp, for a device without limits or for the thesis's manipulator."""
    return generate(protocol(profile, "part-passive", amplitude, factor, device=device))


def for_achilles(profile: str) -> Trajectory:
    """A chosen profile as the manipulator of the thesis can follow it."""
    return chirped(profile, device="achilles")


def adaptation(profile: str) -> Adaptation:
    """What was changed for it."""
    changed = for_achilles(profile).adaptation
    assert changed is not None  # a device was asked for
    return changed


def _peak(profile: str, amplitude: float, factor: float) -> float:
    """Highest lengthening or shortening speed of the triceps [l0/s]."""
    return float(np.abs(triceps_path(chirped(profile, amplitude, factor)).velocity).max())


def span(_: None) -> Ruling:
    """Every profile's part of the range."""
    spans = []
    for done in [*map(basic, NAMES), *map(chirped, CHOSEN)]:
        low, high = done.settings.angle_range
        spans.append(float(np.ptp(done.angle)) / (high - low))
    least = min(spans)
    return Ruling(least >= 1 - 2 * _REACHED, f"{100 * least:.2f} % of the range at least")


def highest_factor(_: None, near: float) -> Ruling:
    """The speed that the fastest of the simulated triceps reach at the highest factor."""
    fastest = max(_peak(name, AMPLITUDES[-1], FACTORS[-1]) for name in CHOSEN) * L0_TRI
    speed = {name: fastest / POPULATIONS[name]["l0_tri"][0] for name in ("healthy", "patient")}
    text = ", ".join(f"{value:.1f} l0/s ({name})" for name, value in speed.items())
    holds = near * _VMAX <= speed["patient"] <= _VMAX
    return Ruling(holds, f"at 0.6 and 0.3 rad, shortest muscles: {text}")


def plane_visited(_: None) -> Ruling:
    """Part of the length–velocity plane, as simulated, and as the manipulator can follow."""
    low, high, filtered = (
        triceps_path(done).coverage.share
        for done in (
            basic("ramp-and-hold"),
            chirped("multi-sine-holds"),
            for_achilles("multi-sine-holds"),
        )
    )
    return Ruling(
        high >= 5 * low,
        f"{100 * low:.1f} % by ramp and hold, {100 * high:.1f} % by multi-sine with holds "
        f"({100 * filtered:.1f} % filtered for the manipulator)",
    )


def within_axes(_: None) -> Ruling:
    """The triceps's speed with the chosen chirp."""
    velocity = triceps_path(chirped("multi-sine-holds")).velocity
    low = float(velocity.min())
    high = float(velocity.max())
    return Ruling(low >= -_SHOWN and high <= _SHOWN, f"{low:.1f} … {high:.1f} l0/s")


def overshoot(_: None) -> Ruling:
    """Peak velocities before and after filtering."""
    peaks = {name: adaptation(name).peak_velocity for name in CHOSEN}
    return Ruling(
        all(before > 1.5 >= after - 1e-9 for before, after in peaks.values()),
        "; ".join(f"{name}: {a:.1f} to {b:.2f} rad/s" for name, (a, b) in peaks.items()),
    )


def fades(_: None) -> Ruling:
    """The chirp's amplitude at its beginning and end."""
    ends = {
        name: (adaptation(name).chirp_amplitude[1], adaptation(name).chirp_end_amplitude)
        for name in CHOSEN
    }
    return Ruling(
        all(end < 0.5 * used for used, end in ends.values()),
        "; ".join(f"{name}: {used:.2g} to {end:.2g} rad" for name, (used, end) in ends.items()),
    )


# Figures

#: The four muscles, told apart by dashes as well as by colour.
_LOOKS = {
    "ta": (BLUE, "solid", "tibialis anterior"),
    "gl": (OCHRE, (0, (4, 1)), "gastrocnemius lateralis"),
    "sol": (INK, (0, (1, 1)), "soleus"),
    "gm": (RED, (0, (5, 1, 1, 1)), "gastrocnemius medialis"),
}
_TITLES = (
    "A. Sine wavelet of 0.20 Hz",
    "B. Multiple holds",
    "C. Multi-sine",
    "D. Multi-sine with holds",
    "E. Scaled chirp",
)
#: EMG of the largest effort in Figure 9 [µV].
_FULL = 600.0
_ENDS = "Full plantarflexion at 0 rad, full dorsiflexion at 1.5 rad"


def drawings() -> tuple[Drawing, ...]:
    """All figures, in the thesis's order."""
    time = np.arange(0.0, 30.0, 1e-3)
    added = chirp(time, amplitude=0.2, rate=chirp_rate(0.3))[0]
    eighth = chirped("multiple-holds", 0.2, 0.3)
    low, high = eighth.settings.angle_range
    part = (eighth.angle - 0.5 * (low + high)) / (0.5 * (high - low))
    names = NAMES[1:]
    basics = [
        _position(basic(name), f"6{title}", last=name == names[-1])
        for name, title in zip(names, _TITLES, strict=True)
    ]
    return (
        Drawing(
            "figure-2",
            "Figure 2: the ramp-and-hold protocol",
            f"{_ENDS}; 18 s.",
            "The angle rises in one ramp to full dorsiflexion, is held, and returns.",
            draw([_position(basic("ramp-and-hold", "passive"), "Ramp and hold")], 2.6),
        ),
        _map(
            "figure-3",
            "Figure 3: length and velocity of the triceps, ramp and hold",
            basic("ramp-and-hold", "passive"),
        ),
        Drawing(
            "figure-6",
            "Figure 6: the five basic profiles",
            f"{_ENDS}.",
            "Five time courses of the ankle angle, each spanning the whole range of motion.",
            draw(basics, 7.6, sharex=True),
        ),
        Drawing(
            "figure-7",
            "Figure 7: the added chirp",
            "A·sin(s·t²) with A = 0.2 rad and s = 0.3: the frequency at time t is s·t/π.",
            "An oscillation of constant amplitude whose frequency rises from 0 to 2.9 Hz in 30 s.",
            draw(
                [
                    Panel(
                        "Angle [rad]",
                        [PlotLine(time, added)],
                        "Time [s]",
                        "Chirp of 0.2 rad and factor 0.3",
                        {"xlim": (0.0, 30.0)},
                    )
                ],
                2.6,
            ),
        ),
        Drawing(
            "figure-8",
            "Figure 8: multiple holds with a chirp of 0.2 rad",
            "The sum of Figures 6B and 7, the holds mapped on a narrower range so that the sum "
            "just reaches full plantarflexion (−1) and full dorsiflexion (1).",
            "Holds at several positions with an oscillation of rising frequency upon them.",
            draw(
                [
                    Panel(
                        "Part of the range\nof motion [-]",
                        [PlotLine(eighth.time, part)],
                        "Time [s]",
                        "Multiple holds with the chirp of Figure 7",
                        {"xlim": (0.0, eighth.time[-1])},
                    )
                ],
                2.9,
            ),
        ),
        Drawing(
            "figure-9",
            "Figure 9: the two EMG tasks",
            "Bursts alternate between the triceps surae's three heads and the tibialis "
            f"anterior; the largest effort is {_FULL:g} µV, as in the thesis.",
            "Bursts of the four muscles, above from 11 s on, below from the start to 24 s.",
            draw(
                [
                    _efforts("part-passive", "9A. relaxed to 11 s, then alternating", ""),
                    _efforts("active", "9B. the active part alone", "Time [s]"),
                ],
                5.2,
                shared=4,
                sharex=True,
            ),
        ),
        _adapted("figure-36", "multiple-holds", "Figure 36: multiple holds for the manipulator"),
        _adapted(
            "figure-37", "multi-sine-holds", "Figure 37: multi-sine with holds for the manipulator"
        ),
        _map(
            "figure-38",
            "Figure 38: length and velocity of the triceps, multi-sine with holds",
            chirped("multi-sine-holds"),
        ),
    )


def _position(done: Trajectory, title: str, *, last: bool = True) -> Panel:
    """Angle from full plantarflexion, as the thesis draws it."""
    low, high = done.settings.angle_range
    at = {"ylim": (-0.06, high - low + 0.06), "yticks": [0.0, 0.5, 1.0, 1.5]}
    lines = [PlotLine(done.time, done.angle - low)]
    return Panel("Ankle angle\n[rad]", lines, "Time [s]" if last else "", title, at)


def _map(name: str, title: str, done: Trajectory) -> Drawing:
    path = triceps_path(done)
    share = f"{100 * path.coverage.share:.2g} % of the"
    cloud = {
        "color": BLUE,
        "marker": ".",
        "markersize": 2.6,
        "markeredgewidth": 0,
        "linestyle": "none",
        "rasterized": True,
    }
    panel = Panel(
        "Velocity [l0/s]",
        [PlotLine(path.length, path.velocity, "", cloud)],
        "Muscle length [L/l0]",
        f"Triceps surae, l0 = {1e3 * path.l0:g} mm: {share} plane visited",
        {"xlim": (0.3, 1.2), "ylim": (-_SHOWN, _SHOWN)},
        (0.0,),
    )
    return Drawing(
        name,
        title,
        "Each point is one sample: muscle length by equation (9) and its rate of change, both in "
        "optimal lengths, on the thesis's axes.",
        f"A cloud of points that covers {share} length–velocity plane.",
        draw([panel], 4.2),
    )


def _efforts(task: str, title: str, xlabel: str) -> Panel:
    done = motion("multiple-holds", task, 0.0, None, 512.0)
    lines = [
        PlotLine(
            done.time,
            _FULL * done.effort[:, MUSCLES.index(muscle)],
            label,
            {"color": colour, "linestyle": dashes},
        )
        for muscle, (colour, dashes, label) in _LOOKS.items()
    ]
    return Panel("EMG [µV]", lines, xlabel, title, {"xlim": (0.0, 35.0)})


def _adapted(name: str, profile: str, title: str) -> Drawing:
    before = chirped(profile)
    after = for_achilles(profile)
    limit = {"color": OCHRE, "linewidth": 1.2, "linestyle": (0, (5, 2))}
    ends = np.array([0.0, after.time[-1]])
    velocity = Panel(
        "Velocity\n[rad/s]",
        [
            PlotLine(before.time, before.velocity, "before", {"color": GREY, "linewidth": 0.7}),
            PlotLine(after.time, after.velocity, "after", {"linewidth": 0.9}),
            PlotLine(ends, np.full(2, 1.5), "1.5 rad/s", limit),
            PlotLine(ends, np.full(2, -1.5), "", limit),
        ],
        "Time [s]",
        "",
        {"xlim": ends, "ylim": (-10.0, 10.0)},
        legend=3,
    )
    angle = _position(after, "As the manipulator is asked to move", last=False)
    return Drawing(
        name,
        title,
        " ".join(adaptation(profile).steps),
        "The angle of the filtered profile; its velocity stays within ±1.5 rad/s, that of the "
        "unfiltered one does not.",
        draw([angle, velocity], 4.2, sharex=True),
    )


def run(context: Context) -> Result:
    """Generate every movement and effort, judge and draw them."""
    context.progress("protocols", 0, 1)
    return Result(
        findings=judge_all("protocols", {"": None}, __name__),
        figures=drawings(),
        notes=(
            "The thesis prints its movements as figures without tables. Where an instant, a speed "
            "or a hold's position cannot be read from them it is our choice; the durations, the "
            "range of motion, the chirp and its placement are the thesis's. Angles run from full "
            "plantarflexion (0 rad in the thesis's figures) to full dorsiflexion (1.5 rad).",
        ),
    )
