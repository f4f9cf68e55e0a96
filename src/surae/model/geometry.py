"""Moment arms and muscle lengths from the ankle angle: equations (4), (5) and (9).

Neither depends on an estimated parameter, so they are computed once per recording.
"""

from dataclasses import dataclass

import numpy as np

from surae.model.options import ModelOptions
from surae.units import FloatArray

#: Offset [m] and slope [m/rad] of the moment arms, equations (4) and (5) (Maganaris 1998, 1999).
ARM_TRI = (0.0480, -0.0104)
ARM_TIB = (0.0393, 0.0171)
#: l_m [m] and factor of the arm in equation (9).
LENGTH_TRI = (0.118, 1.67)
LENGTH_TIB = (0.136, 1.56)


def arm_tri(angle: FloatArray) -> FloatArray:
    """Moment arm of the Achilles tendon, equation (4): r = 0.0480 − 0.0104·θ.

    Parameters
    ----------
    angle : ndarray
        Ankle angle [rad], dorsiflexion positive.

    Returns
    -------
    ndarray
        Arm [m], same shape.
    """
    return ARM_TRI[0] + ARM_TRI[1] * angle


def arm_tib(angle: FloatArray) -> FloatArray:
    """Moment arm of the tibialis tendon, equation (5): r = 0.0393 + 0.0171·θ.

    Parameters
    ----------
    angle : ndarray
        Ankle angle [rad], dorsiflexion positive.

    Returns
    -------
    ndarray
        Arm [m], same shape.
    """
    return ARM_TIB[0] + ARM_TIB[1] * angle


def length_tri(angle: FloatArray, options: ModelOptions) -> tuple[FloatArray, FloatArray]:
    """Triceps length and its slope, equation (9) or virtual work.

    ``"thesis"``: x = 0.118 − 1.67·r(θ), the literal product; its slope is not the arm.
    ``"virtual-work"``: x = x_ref + ∫r dθ, so that force times dx/dθ is the torque.

    Returns
    -------
    length : ndarray
        Muscle length x [m].
    slope : ndarray
        dx/dθ [m/rad].
    """
    if options.geometry == "thesis":
        length = LENGTH_TRI[0] - LENGTH_TRI[1] * arm_tri(angle)
        return length, np.full_like(angle, -LENGTH_TRI[1] * ARM_TRI[1])
    swept = ARM_TRI[0] * angle + 0.5 * ARM_TRI[1] * angle**2
    return options.x_ref_tri + swept, arm_tri(angle)


def length_tib(angle: FloatArray, options: ModelOptions) -> tuple[FloatArray, FloatArray]:
    """Tibialis length and its slope, equation (9) or virtual work; it shortens with dorsiflexion.

    ``"thesis"``: x = 0.136 − 1.56·r(θ). ``"virtual-work"``: x = x_ref − ∫r dθ.

    Returns
    -------
    length : ndarray
        Muscle length x [m].
    slope : ndarray
        dx/dθ [m/rad].
    """
    if options.geometry == "thesis":
        length = LENGTH_TIB[0] - LENGTH_TIB[1] * arm_tib(angle)
        return length, np.full_like(angle, -LENGTH_TIB[1] * ARM_TIB[1])
    swept = ARM_TIB[0] * angle + 0.5 * ARM_TIB[1] * angle**2
    return options.x_ref_tib - swept, -arm_tib(angle)


@dataclass(frozen=True, slots=True)
class Path:
    """What an ankle angle does to one muscle group, arrays of shape (n,)."""

    #: Moment arm, signed as in equation (1): triceps positive, tibialis negative [m].
    arm: FloatArray
    #: `length`, `speed`: length [m] and lengthening speed [m/s] of the muscle with a rigid tendon.
    length: FloatArray
    speed: FloatArray
    slope: FloatArray  #: dx/dθ, lengthening with the angle [m/rad].
    #: `bend`, `arm_slope`: derivatives by the angle of `slope` [m/rad²] and of `arm` [m/rad].
    bend: float
    arm_slope: float


def paths(*, angle: FloatArray, velocity: FloatArray, options: ModelOptions) -> tuple[Path, Path]:
    """Paths of the triceps surae and of the tibialis anterior, in this order."""
    x_tri, slope_tri = length_tri(angle, options)
    x_tib, slope_tib = length_tib(angle, options)
    # by virtual work the slope is the arm and bends with it; the printed product does not bend
    bends = options.geometry == "virtual-work"
    by_tri, by_tib = ARM_TRI[1], -ARM_TIB[1]
    return (
        Path(arm_tri(angle), x_tri, slope_tri * velocity, slope_tri, bends * by_tri, by_tri),
        Path(-arm_tib(angle), x_tib, slope_tib * velocity, slope_tib, bends * by_tib, by_tib),
    )
