"""What the thesis says of its movements, each claim computed."""

import numpy as np

from surae.protocol import PROFILES, Adaptation
from surae.protocol.triceps import L0_TRI, triceps_path
from surae.reproduction.chapter import Table
from surae.reproduction.claims import Claim, Finding, judged
from surae.reproduction.protocols.motions import (
    AMPLITUDE,
    CHOSEN,
    NAMES,
    basic,
    chirped,
    for_achilles,
)

#: Full plantarflexion and dorsiflexion count as reached within this part of the range.
_REACHED = 0.001
#: Speed that a muscle cannot exceed [l0/s], equation (17).
_VMAX = 8.0
#: The rates of the grid end at the one that the thesis calls the highest possible [-].
_HIGHEST, _STEP = 0.6, 0.025


def findings() -> tuple[Finding, ...]:
    """All of them."""
    return _spans(), _speed(), _coverage(), _device(), _fading()


def durations() -> Table:
    """What the profiles are, as numbers."""
    rows = []
    for name in NAMES:
        one, path = basic(name), triceps_path(basic(name))
        rows.append(
            (
                name,
                PROFILES[name].duration,
                round(float(np.abs(one.velocity).max()), 3),
                round(float(np.abs(path.velocity).max()), 3),
                round(100 * path.coverage.share, 2),
            )
        )
    return Table(
        name="profiles",
        title="The basic profiles, without a chirp",
        columns=(
            "profile",
            "duration [s]",
            "peak velocity [rad/s]",
            "peak triceps speed [l0/s]",
            "length–velocity plane visited [%]",
        ),
        rows=tuple(rows),
    )


def _spans() -> Finding:
    claim = Claim(
        name="whole-range",
        source="2.5.1, Figures 2, 6 and 8",
        text="Every profile spans the whole range of motion, with and without a chirp.",
        number="0 … 1.5 rad",
        rule=f"each profile reaches both ends within {100 * _REACHED:g} % of the range",
    )
    shares = []
    for one in [*(basic(name) for name in NAMES), *(chirped(name) for name in CHOSEN)]:
        low, high = one.settings.range_of_motion
        shares.append((one.angle.max() - one.angle.min()) / (high - low))
    worst = float(min(shares))
    return judged(
        claim,
        worst >= 1 - 2 * _REACHED,
        f"{100 * worst:.2f} % of the range at least",
        why="A profile stops short of an end.",
        remark="To make room for the chirp, the basic profile is mapped on a narrower range.",
        figure="figure-6",
    )


def _speed() -> Finding:
    claim = Claim(
        name="highest-chirp-rate",
        source="4.1.4",
        text="A chirp rate of 0.6 is the highest before the triceps exceeds 8 optimal lengths/s.",
        number="0.6",
        rule="at the chosen amplitude (0.2 rad) the triceps stays below 8 l0/s at 0.6 in the "
        "chosen profiles, and no longer at 0.625",
    )
    peaks = {
        amplitude: max(_peak(name, amplitude, _HIGHEST) for name in CHOSEN)
        for amplitude in (0.1, 0.2, 0.3)
    }
    beyond = max(_peak(name, AMPLITUDE, _HIGHEST + _STEP) for name in CHOSEN)
    holds = peaks[AMPLITUDE] <= _VMAX < beyond
    listed = ", ".join(f"{value:.1f} l0/s at {a:g} rad" for a, value in peaks.items())
    limit = _HIGHEST * _VMAX / peaks[AMPLITUDE]
    return judged(
        claim,
        holds,
        f"at 0.6: {listed} (l0 {1e3 * L0_TRI:g} mm)",
        why="The chirp's frequency grows to the profile's end (24 Hz after 40 s at 0.6), and "
        f"with it the speed. Where the chirp runs that long, 0.2 rad keeps below 8 l0/s up to "
        f"about {limit:.2f}; the thesis does not say with which amplitude, optimal length "
        "and duration it found its limit.",
        figure="figure-7",
    )


def _peak(profile: str, amplitude: float, rate: float) -> float:
    """Highest lengthening or shortening speed of the triceps [l0/s]."""
    return float(np.abs(triceps_path(chirped(profile, amplitude, rate)).velocity).max())


def _coverage() -> Finding:
    claim = Claim(
        name="richer-plane",
        source="1.2 and 4.1.5, Figures 3 and 38",
        text="Multi-sine with holds visits far more of the triceps's length–velocity plane than "
        "ramp and hold.",
        number="two figures, no number",
        rule="it visits at least five times as much of the plane of those figures",
    )
    before = triceps_path(basic("ramp-and-hold")).coverage.share
    after = triceps_path(chirped("multi-sine-holds")).coverage.share
    filtered = triceps_path(for_achilles("multi-sine-holds")).coverage.share
    return judged(
        claim,
        after >= 5 * before,
        f"{100 * before:.1f} % by ramp and hold, {100 * after:.1f} % by multi-sine with holds",
        why="Its richness is less than fivefold.",
        remark="As simulated, with the chirp of 0.2 rad and 0.5. Filtered for the manipulator "
        f"it visits {100 * filtered:.1f} %: most of what the chirp adds is too fast for it.",
        figure="figure-38",
    )


def _device() -> Finding:
    claim = Claim(
        name="below-overshoot",
        source="4.1.5, Figures 36 and 37",
        text="The chosen profiles move faster than the 1.5 rad/s from which the manipulator "
        "overshoots, until they are filtered.",
        number="1.5 rad/s",
        rule="their peak velocity is above 1.5 rad/s before and at most that after filtering",
    )
    peaks = [_adaptation(name).peak_velocity for name in CHOSEN]
    return judged(
        claim,
        all(before > 1.5 >= after - 1e-9 for before, after in peaks),
        "; ".join(
            f"{name}: {before:.1f} to {after:.2f} rad/s"
            for name, (before, after) in zip(CHOSEN, peaks, strict=True)
        ),
        why="A profile is slow enough as it is, or too fast even when filtered.",
        figure="figure-36",
    )


def _fading() -> Finding:
    claim = Claim(
        name="chirp-fades",
        source="4.1.5, Figures 36 and 37",
        text="Filtered for the manipulator, the chirp loses amplitude as its frequency rises.",
        number="two figures, no number",
        rule="at its end the chirp has less than half the amplitude that it began with",
    )
    ends = [(_adaptation(name).chirp_amplitude[1], _adaptation(name).chirp_end_amplitude)
            for name in CHOSEN]  # fmt: skip
    return judged(
        claim,
        all(end < 0.5 * used for used, end in ends),
        "; ".join(
            f"{name}: {used:.2g} to {end:.2g} rad"
            for name, (used, end) in zip(CHOSEN, ends, strict=True)
        ),
        why="The filter needed for 1.5 rad/s takes less than half of the chirp.",
        figure="figure-37",
    )


def _adaptation(profile: str) -> Adaptation:
    adaptation = for_achilles(profile).adaptation
    assert adaptation is not None  # a device was asked for
    return adaptation
