"""Torque and stiffness of the relaxed leg over the range that was moved."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from surae.base.words import Message
from surae.inference.relaxed.curve import PossibleLegs, RelaxedCurve
from surae.measures.rest.draft import Draft
from surae.measures.rest.torque import relaxed_torque

#: The last of a range, over which its end is as stiff as its mean [deg].
_LAST = 10.0
#: Rest may miss an end of the range that was moved by so many degrees.
REACHES = 1.5
#: Part of the zero's error that an end of the range has: where the movement ended is not where the
#: zero is, but the foot turns on its plate on the way there; assumed. (A sketch without it had 86 %
#: of its intervals hold, on legs of another generator; what of that the zero is was not counted.)
_AT_ENDS = 0.5


def over_range(
    curve: RelaxedCurve, legs: PossibleLegs, moved: tuple[float, float], at_ends: float = _AT_ENDS
) -> Iterator[Draft]:
    """Torque and stiffness at the end of the range, and over it; `moved` is from where to where."""
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
        for zero in (np.zeros_like(legs.zero), at_ends * legs.zero):
            first, last_torque = (relaxed_torque(curve, legs, degrees + zero) for degrees in span)
            value = last_torque
            if name != "end_torque":
                value = last_torque - first
            if name == "end_stiffness":
                value = value / (span[1] - span[0])
            made.append(legs.scale * value)
        yield replace(bare, device=made[0], ankle=made[1])
