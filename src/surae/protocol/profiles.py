"""The position profiles of the thesis (2.5.1, Figures 2 and 6): fractions of the range of motion.

A profile is a pure function of time, defined for every t, smooth, at rest at its start and end:
0 is full plantarflexion, 1 full dorsiflexion. To add one, write its function and a line in
`PROFILES`. Of the thesis's plots only the axes are left, so most speeds, frequencies and hold
positions are ours; the durations, the 0.20 Hz of the sine, how each profile is made and the speed
of the ramp and hold (0.35 l0/s in Figure 3, which is 0.9 rad/s) are the thesis's.

To a profile the thesis adds a chirp A·sin(s·t²), s its "frequency scale factor" (2.5.1): its
frequency is s·t/π and rises by s/π Hz/s (Figures 7 and 8). What happens at the ends of the range it
doesn't say. A leg must never be moved beyond its range of motion, so the profile is mapped on a
narrower range, chosen so that profile + chirp just reaches both ends.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from surae.base.formatting import named
from surae.base.units import FloatArray
from surae.base.words import N_

#: Time in which a ramp gains or loses its speed [s].
BLEND = 0.2


class Ramp(NamedTuple):
    """A movement at constant speed to a new hold."""

    start: float  #: When it starts [s].
    to: float  #: Fraction of the range of motion where it ends.
    speed: float  #: Speed of the constant part [1/s], in ranges of motion per second.

    def end(self, origin: float) -> float:
        """Instant at which the ramp that starts from the fraction `origin` has come to rest [s]."""
        return self.start + abs(self.to - origin) / self.speed + BLEND


def smooth_step(u: FloatArray) -> FloatArray:
    """Minimum-jerk step 10u³ − 15u⁴ + 6u⁵ from 0 (u ≤ 0) to 1 (u ≥ 1), Flash and Hogan 1985."""
    u = np.clip(u, 0.0, 1.0)
    return u**3 * (10.0 + u * (6.0 * u - 15.0))


def _integrated_step(u: FloatArray) -> FloatArray:
    """Integral of `smooth_step` from −∞ to u."""
    integral = np.maximum(u - 1.0, 0.0)
    integral[u >= 1.0] += 0.5
    within = (u > 0.0) & (u < 1.0)  # little of a protocol; powers are slow
    part = u[within]
    integral[within] = part**4 * (2.5 + part * (part - 3.0))
    return integral


def ramps_and_holds(t: FloatArray, ramps: tuple[Ramp, ...], origin: float = 0.0) -> FloatArray:
    """Position from `origin` by ramp after ramp, at rest between, in parts of the range."""
    position = np.full_like(t, origin)
    for ramp in ramps:
        # The speed is a smooth step up minus the same step down, distance / speed later: their
        # integrals differ by exactly the distance once both are over.
        distance = ramp.to - origin
        moving = abs(distance) / ramp.speed
        u = (t - ramp.start) / BLEND
        shape = _integrated_step(u) - _integrated_step(u - moving / BLEND)
        position = position + np.sign(distance) * ramp.speed * BLEND * shape
        origin = ramp.to
    return position


#: Eight angles, no two neighbours in turn, each held for some 12 s, the first from the start:
#: efforts there show torque over angle.
ISOMETRIC = tuple(
    Ramp(15.0 * (k + 1), level / 7, 0.3) for k, level in enumerate((4, 7, 2, 5, 1, 6, 3))
)


PositionFunction = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class Profile:
    """A position profile."""

    name: str  #: Name in settings and files.
    duration: float  #: Its own duration [s].
    #: Times [s], shape (n,), to fractions of the range of motion, shape (n,).
    position: PositionFunction
    description: str  #: One sentence.


@cache
def _extremes(raw: PositionFunction, duration: float) -> tuple[float, float]:
    values = raw(np.linspace(0.0, duration, int(duration * 4000) + 1))
    return float(values.min()), float(values.max())


def _spanning(raw: PositionFunction, t: FloatArray, duration: float) -> FloatArray:
    """`raw` mapped so that its extremes over [0, duration] are 0 and 1."""
    lowest, highest = _extremes(raw, duration)
    return (raw(t) - lowest) / (highest - lowest)


#: To full dorsiflexion and to full plantarflexion, each held.
RAMP_AND_HOLD = (Ramp(2.0, 1.0, 0.6), Ramp(10.0, 0.0, 0.6))


def sine(t: FloatArray) -> FloatArray:
    """Sine of 0.20 Hz over the whole range, from full plantarflexion."""
    return 0.5 - 0.5 * np.cos(2 * np.pi * 0.2 * t)


#: Slow, with long holds, while the subject is passive (to 11 s); then holds at many lengths,
#: reached at 0.15 to 0.8 /s.
MULTIPLE_HOLDS = (
    Ramp(0.5, 1.0, 0.5),
    Ramp(5.0, 0.0, 0.25),
    Ramp(10.5, 0.5, 0.6),
    Ramp(12.5, 0.8, 0.15),
    Ramp(15.5, 0.3, 0.6),
    Ramp(17.5, 1.0, 0.35),
    Ramp(20.8, 0.65, 0.8),
    Ramp(22.4, 0.1, 0.25),
    Ramp(25.8, 0.9, 0.7),
    Ramp(28.1, 0.4, 0.4),
    Ramp(30.5, 0.7, 0.2),
    Ramp(32.8, 0.0, 0.6),
)


#: Two ramps with holds, while the subject is passive; then sines.
MULTI_SINE_START = (Ramp(1.0, 1.0, 0.6), Ramp(7.0, 0.5, 0.25))


def _three_sines(t: FloatArray) -> FloatArray:
    # Odd about the middle of the window, so the extremes are symmetric about mid-range.
    window = smooth_step((t - 10.5) / 1.0) * smooth_step((40.0 - t) / 1.0)
    since_middle = 2 * np.pi * (t - 25.25)
    total = np.zeros_like(t)
    for frequency in (0.31, 0.73, 1.13):
        total += np.sin(frequency * since_middle)
    return window * total


def multi_sine(t: FloatArray) -> FloatArray:
    """Ramp and hold, then from 10.5 s the sum of sines of 0.31, 0.73 and 1.13 Hz."""
    sines = _spanning(_three_sines, t, 40.0) - 0.5
    return ramps_and_holds(t, MULTI_SINE_START) + sines


def _sine_product(t: FloatArray) -> FloatArray:
    """Slow at first and faster later, holding at various positions."""
    # The speed of the lingering cosine is 15/8 sin⁵ φ: it holds at every turning point. Slow sines
    # move those turning points. 0.03 Hz at the start, 0.245 Hz after 40 s and 5.5 periods.
    cosine = np.cos(2 * np.pi * (0.03 * t + 0.0026875 * t**2))
    lingering = cosine * (15.0 - 10.0 * cosine**2 + 3.0 * cosine**4) / 8.0
    slow = np.cos(2 * np.pi * 0.075 * t) * np.cos(2 * np.pi * 0.025 * t)
    return -(0.65 + 0.35 * slow) * lingering


def _half_cosine_chirp(t: FloatArray) -> FloatArray:
    """Chirp from 0.025 to 1 Hz, scaled by the first half of a cosine."""
    # 0.025 Hz at the start, 0.5 Hz after 40 s and 10.5 periods: at rest at both ends.
    phase = 2 * np.pi * (0.025 * t + 0.0059375 * t**2)
    return -np.cos(np.pi * t / 40.0) * np.cos(phase)


PROFILES: dict[str, Profile] = {
    profile.name: profile
    for profile in (
        Profile(
            "ramp-and-hold",
            18.0,
            partial(ramps_and_holds, ramps=RAMP_AND_HOLD),
            N_("One ramp, a hold and the ramp back."),
        ),
        Profile("sine", 30.0, sine, N_("Sine of 0.20 Hz.")),
        Profile(
            "multiple-holds",
            35.0,
            partial(ramps_and_holds, ramps=MULTIPLE_HOLDS),
            N_("Holds reached at various speeds."),
        ),
        Profile("multi-sine", 40.0, multi_sine, N_("A ramp and hold, then three sines added.")),
        Profile(
            "multi-sine-holds",
            40.0,
            partial(_spanning, _sine_product, duration=40.0),
            N_("Products of sines, slow to fast."),
        ),
        Profile(
            "scaled-chirp",
            40.0,
            partial(_spanning, _half_cosine_chirp, duration=40.0),
            N_("A chirp scaled by half a cosine."),
        ),
        Profile(
            "isometric",
            120.0,
            partial(ramps_and_holds, ramps=ISOMETRIC),
            N_("Eight angles, each held: for efforts in steps or at random."),
        ),
    )
}


def named_profile(name: str) -> Profile:
    """The profile of that name."""
    return named("profile", PROFILES, name)


def chirp_rate(factor: float) -> float:
    """Rise of the frequency [Hz/s] of a chirp A·sin(factor·t²), factor in rad/s²."""
    return factor / np.pi


def chirp(
    t: FloatArray, *, amplitude: float, rate: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Chirp A·sin(π·r·t²), of instantaneous frequency r·t [Hz], and its two derivatives [rad, s].

    `rate` is r [Hz/s]; `chirp_rate` gives it for a factor of the thesis.
    """
    phase = np.pi * rate * t**2
    phase_speed = 2 * np.pi * rate * t
    angle = amplitude * np.sin(phase)
    velocity = amplitude * phase_speed * np.cos(phase)
    acceleration = amplitude * (2 * np.pi * rate * np.cos(phase) - phase_speed**2 * np.sin(phase))
    return angle, velocity, acceleration


def base_range(
    fraction: FloatArray, added: FloatArray, angle_range: tuple[float, float]
) -> tuple[float, float]:
    """Range on which the profile is mapped so that profile + chirp spans the range of motion.

    `fraction` is the profile, 0…1, `added` the chirp [rad], smaller than half the range; low +
    (high − low)·fraction + added then has the extremes `angle_range`, to 1e-12 rad.
    """
    plantarflexed, dorsiflexed = angle_range
    amplitude = float(np.abs(added).max())
    # From the range that is safe whatever the phases, each end is moved out by the room that is
    # left. That room shrinks at every step: the sum follows `high` where the profile is near 1.
    low = plantarflexed + amplitude
    high = dorsiflexed - amplitude
    for _ in range(200):
        total = low + (high - low) * fraction + added
        above = dorsiflexed - float(total.max())
        below = float(total.min()) - plantarflexed
        high = high + above
        low = low - below
        if max(abs(above), abs(below)) < 1e-13:
            break
    return low, high
