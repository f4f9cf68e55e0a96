"""Torque and slope of possible legs' relaxed curves."""

import numpy as np

from surae.base.units import FloatArray
from surae.inference.relaxed.curve import PossibleLegs, RelaxedCurve, slow_features


def relaxed_torque(curve: RelaxedCurve, legs: PossibleLegs, at: FloatArray) -> FloatArray:
    """Torque of fully relaxed tissue at an angle of each leg [Nm], shape (n,)."""
    return _rowwise(curve.basis.features(at), legs.weights)


def relaxed_stiffness(curve: RelaxedCurve, legs: PossibleLegs, at: FloatArray) -> FloatArray:
    """Its slope [Nm/deg], shape (n,)."""
    return _rowwise(curve.basis.slopes(at), legs.weights)


def slow_torque(curve: RelaxedCurve, legs: PossibleLegs, at: FloatArray) -> FloatArray:
    """Torque as a slow stretch passes an angle of each leg [Nm], shape (n,)."""
    angles, elastic, lagging = slow_features(curve.low, curve.high)
    place = np.clip((at - angles[0]) / (angles[1] - angles[0]), 0, len(angles) - 1.001)
    i = place.astype(int)
    part = (place - i)[:, None]
    torque = np.zeros(len(at))
    for k, rows in enumerate((elastic, *lagging)):
        there = (1.0 - part) * rows[i] + part * rows[i + 1]
        torque += (1.0 if k == 0 else legs.gamma[:, k - 1]) * _rowwise(there, legs.weights)
    return torque


def slow_stiffness(curve: RelaxedCurve, legs: PossibleLegs, at: FloatArray) -> FloatArray:
    """Its slope [Nm/deg], shape (n,)."""
    return 0.5 * (slow_torque(curve, legs, at + 1.0) - slow_torque(curve, legs, at - 1.0))


def _rowwise(rows: FloatArray, weights: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ij,ij->i", rows, weights))
