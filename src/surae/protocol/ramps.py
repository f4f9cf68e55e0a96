"""Ramps between holds whose speed rises and falls by a minimum-jerk transition."""

from typing import NamedTuple

import numpy as np

from surae.units import FloatArray

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
    within = np.clip(u, 0.0, 1.0)
    return within**4 * (2.5 + within * (within - 3.0)) + np.maximum(u - 1.0, 0.0)


def ramps_and_holds(t: FloatArray, ramps: tuple[Ramp, ...], origin: float = 0.0) -> FloatArray:
    """Position that starts at `origin` and follows the ramps, at rest between them.

    Each ramp starts after the one before has ended; positions, and `origin`, are fractions of the
    range of motion.
    """
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
