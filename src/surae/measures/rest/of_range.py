"""Torque and stiffness of the relaxed leg over the range that was moved."""

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np
from scipy.special import ndtri

from surae.base.frozen import as_read_only
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference.relaxed.curve import PossibleLegs, RelaxedCurve
from surae.measures.rest.draft import Draft
from surae.measures.rest.torque import relaxed_torque

#: The last of a range, over which its end is as stiff as its mean [deg].
_LAST = 10.0
#: Rest may miss an end of the range that was moved by so many degrees.
REACHES = 1.5
#: By how much the foot turns on its plate on the way to the ends of the range [deg], one standard
#: deviation, whatever is known of the angle's zero: half of a goniometer's error; assumed. Without
#: it 85 % of the ends' stiffnesses hold on 75 virtual legs of another author, with it 95 %.
_TURNS = 1.25
_SEED = 13


def over_range(
    curve: RelaxedCurve,
    legs: PossibleLegs,
    moved: tuple[float, float],
    turned: FloatArray | None = None,
) -> Iterator[Draft]:
    """Torque and stiffness at the end of the range, and over it.

    `moved` is from where to where [deg], `turned` by how much the foot of each leg is turned there
    [deg]; None: as a foot may be on its plate.
    """
    if turned is None:
        turned = _turned(len(legs.zero))
    low, high = moved
    last = max(low, high - _LAST)
    ends = {
        "end_torque": (
            "Nm",
            "Torque of the relaxed ankle at the end of the dorsiflexion that was moved.",
            (high, high),
        ),
        "end_stiffness": (
            "Nm/deg",
            "Stiffness of the relaxed ankle over the last 10° of the dorsiflexion that was moved.",
            (last, high),
        ),
        "torque_rise": (
            "Nm",
            "Rise of the relaxed ankle's torque over the whole range that was moved.",
            (low, high),
        ),
    }
    short = curve.high < high - REACHES or high - low < REACHES  # a hold alone has no range
    begins = curve.low <= low + REACHES
    for name, (unit, meaning, span) in ends.items():
        bare = Draft(name, unit, meaning, span=span)
        if short or (name == "torque_rise" and not begins):
            yield replace(
                bare,
                missing=Message(
                    "none/rest-short", low=curve.low, high=curve.high, first=low, last=high
                ),
            )
            continue
        made = []
        for by in (np.zeros_like(turned), turned):
            first, last_torque = (relaxed_torque(curve, legs, degrees + by) for degrees in span)
            value = last_torque
            if name != "end_torque":
                value = last_torque - first
            if name == "end_stiffness":
                value = value / (span[1] - span[0])
            made.append(legs.scale * value)
        yield replace(bare, device=made[0], ankle=made[1])


@lru_cache(maxsize=4)
def _turned(n: int) -> FloatArray:
    """By how much the feet of so many legs are turned [deg], shape (n,)."""
    normal = ndtri((np.arange(n) + 0.5) / n)
    return as_read_only(_TURNS * np.random.default_rng(_SEED).permutation(normal))
