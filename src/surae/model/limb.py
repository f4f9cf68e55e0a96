"""Inertia and gravity of foot and footplate: equations (6) and (7), both proportional to m."""

import numpy as np

from surae.units import FloatArray

#: Distance of the point mass from the ankle axis [m], equation (6).
ARM_LIMB = 0.15
GRAVITY = 9.81


def inertia_torque(*, acceleration: FloatArray) -> FloatArray:
    """Inertial torque of a mass of 1 kg, equations (1) and (6): la²·θ''.

    Parameters
    ----------
    acceleration : ndarray
        Angular acceleration [rad/s²].

    Returns
    -------
    ndarray
        Torque per mass [Nm/kg].
    """
    return ARM_LIMB**2 * acceleration


def gravity_torque(*, angle: FloatArray, theta_foot: float) -> FloatArray:
    """Gravitational torque of a mass of 1 kg, equation (7): g·la·cos(θ − θ_foot).

    Parameters
    ----------
    angle : ndarray
        Ankle angle [rad].
    theta_foot : float
        Angle of the foot to the horizontal at θ = 0 [rad].

    Returns
    -------
    ndarray
        Torque per mass [Nm/kg].
    """
    torque: FloatArray = GRAVITY * ARM_LIMB * np.cos(angle - theta_foot)
    return torque


def gravity_slope(*, angle: FloatArray, theta_foot: float) -> FloatArray:
    """Derivative of `gravity_torque` by the angle [Nm/(kg·rad)]; parameters as there."""
    slope: FloatArray = -GRAVITY * ARM_LIMB * np.sin(angle - theta_foot)
    return slope
