"""Angles at which the relaxed leg reaches torques, and how stiff it is there."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference.relaxed.curve import PossibleLegs, RelaxedCurve
from surae.measures.rest.draft import Draft
from surae.measures.rest.torque import relaxed_stiffness

#: Torques at which the range of motion is given [Nm], and the stiffness.
RANGE_TORQUES = (5.0, 10.0, 12.0, 15.0)
STIFFNESS_TORQUES = (10.0,)
#: Part of the possible legs that has to reach a torque for a range at it.
REACHING = 0.95


def at_torques(curve: RelaxedCurve, legs: PossibleLegs) -> Iterator[Draft]:
    """Angles at which torques are reached, and how stiff the ankle is there."""
    degrees = np.arange(curve.low, curve.high + 0.25, 0.5)
    torque = legs.scale[:, None] * (legs.weights @ curve.basis.features(degrees).T)
    torque = np.maximum.accumulate(torque, axis=1)
    for wanted in RANGE_TORQUES:
        bare = Draft(
            f"range_at_torque@{wanted:g}Nm",
            "deg",
            "Angle of the ankle at which its relaxed torque is so large.",
        )
        stiff = Draft(
            f"stiffness_at_torque@{wanted:g}Nm",
            "Nm/deg",
            "Stiffness of the relaxed ankle at the angle where its relaxed torque is so large.",
        )
        within = (torque[:, 0] < wanted) & (torque[:, -1] > wanted)
        if legs.share[within].sum() < REACHING:
            largest = float(np.average(torque[:, -1], weights=legs.share))
            why = Message("none/rest-torque", torque=wanted, largest=largest)
            bare = replace(bare, missing=why)
            stiff = replace(stiff, missing=why)
        else:
            at = _crossing(degrees, torque, wanted)
            on_device = at + curve.zero_deg
            bare = replace(bare, device=on_device, ankle=on_device + legs.zero, power=0.0)
            slope = legs.scale * relaxed_stiffness(curve, legs, at)
            stiff = replace(stiff, device=slope, ankle=slope)
        yield bare
        if wanted in STIFFNESS_TORQUES:
            yield stiff


def _crossing(degrees: FloatArray, torque: FloatArray, wanted: float) -> FloatArray:
    """Where each row of a growing torque is so large [deg]; at an end where it never is."""
    i = np.clip((torque < wanted).sum(axis=1), 1, len(degrees) - 1)
    row = np.arange(len(torque))
    before = torque[row, i - 1]
    after = torque[row, i]
    part = np.clip((wanted - before) / np.maximum(after - before, 1e-12), 0.0, 1.0)
    made: FloatArray = degrees[i - 1] + part * (degrees[i] - degrees[i - 1])
    return made
