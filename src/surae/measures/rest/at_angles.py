"""Torque and stiffness of the relaxed leg at angles."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from scipy.special import ndtri

from surae.base.frozen import as_read_only
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference.relaxed.curve import SLOW_FROM, PossibleLegs, RelaxedCurve
from surae.measures.rest.draft import Draft
from surae.measures.rest.torque import (
    relaxed_stiffness,
    relaxed_torque,
    slow_stiffness,
    slow_torque,
)

#: Degrees from the start of a slow stretch before it tells a slope.
ON_ITS_WAY = 10.0
#: What the equations leave out of a slope, whatever its size, one standard deviation [Nm/deg]: half
#: of what the foot's weight turns at −25°. Set on five virtual legs of surae's own, whose stiffness
#: there came out 0.007 to 0.02 too low, and widened by a quarter where at −10° 91 % held by the
#: device (75 legs of another author).
_SLOPE = 0.0125
_SEED = 11


def at_angles(curve: RelaxedCurve, legs: PossibleLegs, angles: Sequence[float]) -> Iterator[Draft]:
    """Torque and stiffness at each angle [deg], relaxed and in a slow stretch."""
    kinds: tuple[tuple[str, str, str, Callable[..., FloatArray], bool], ...] = (
        (
            "passive_torque",
            "Nm",
            "Torque of the relaxed ankle at an angle, its tissue fully relaxed.",
            relaxed_torque,
            False,
        ),
        (
            "passive_stiffness",
            "Nm/deg",
            "Stiffness of the relaxed ankle at an angle, for a movement so slow that tissue "
            "relaxes.",
            relaxed_stiffness,
            False,
        ),
        (
            "slow_torque",
            "Nm",
            "Torque of the relaxed ankle as it passes an angle in a slow stretch, 5°/s from −30°.",
            slow_torque,
            True,
        ),
        (
            "slow_stiffness",
            "Nm/deg",
            "Stiffness of the relaxed ankle as it passes an angle in a slow stretch, 5°/s from "
            "−30°.",
            slow_stiffness,
            True,
        ),
    )
    for name, unit, meaning, value, slow in kinds:
        for angle in dict.fromkeys(map(float, angles)):
            at = angle - curve.zero_deg
            bare = Draft(f"{name}@{angle:g}deg", unit, meaning, at_angle=True)
            if why := _withheld(curve, at, slow):
                yield replace(bare, missing=why)
                continue
            beside = _slopes(len(legs.zero)) if unit == "Nm/deg" else np.zeros(1)
            yield replace(
                bare,
                device=legs.scale * value(curve, legs, np.full_like(legs.zero, at)) + beside,
                ankle=legs.scale * value(curve, legs, at + legs.zero) + beside,
            )


@lru_cache(maxsize=4)
def _slopes(n: int) -> FloatArray:
    """What else may turn the torque with the angle, of so many legs [Nm/deg], shape (n,)."""
    normal = ndtri((np.arange(n) + 0.5) / n)
    return as_read_only(_SLOPE * np.random.default_rng(_SEED).permutation(normal))


def _withheld(curve: RelaxedCurve, at: float, slow: bool) -> Message | None:
    """Why there is nothing at an angle of the device [deg]."""
    if slow and at < SLOW_FROM + ON_ITS_WAY:
        return Message("none/stretch", low=SLOW_FROM, high=curve.high)
    if curve.passed(at, held=not slow):
        return None
    if curve.low <= at <= curve.high:
        return Message("none/rest-not-passed", degrees=at)
    return Message("none/rest-beyond", degrees=at, low=curve.low, high=curve.high)
