"""What a recording's movement does to limb and muscles, as far as its sensors can be believed.

The angle that is measured is that of the device, and of its zero: the joint's is that of
`surae.model.geometry` at θ + angle_zero, with the ankle's axis at (axis_forward, axis_up).
Everything in the leg follows the joint, and all its torque is felt by the device times dθ_joint/dθ.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from surae.model.geometry import AnkleAxis, JointAngle, Path, paths
from surae.model.options import ModelOptions
from surae.model.parameters import OPTIONAL
from surae.signals import ModelInputs
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


_AXIS = OPTIONAL["axis"]
#: What they are to `AnkleAxis`.
_TURNING = {"angle_zero": "angle", **dict(zip(_AXIS, ("forward", "up"), strict=True))}


@dataclass(frozen=True, slots=True)
class MusclePath:
    """Path of one muscle group as the device's torque knows it."""

    #: `arm`, `length`, `speed`: signed moment arm [m], length [m] and lengthening speed [m/s] on a
    #: rigid tendon, shape (n,).
    arm: FloatArray
    length: FloatArray
    speed: FloatArray
    #: `arm_slopes`, `length_slopes`, `speed_slopes`: derivatives of the three by the parameters of
    #: `LegMovement.columns`, shape (s, n).
    arm_slopes: FloatArray
    length_slopes: FloatArray
    speed_slopes: FloatArray


@dataclass(frozen=True, slots=True)
class LegMovement:
    """Limb and muscles of a moving leg."""

    #: `inertia`, `gravity`: torques of 1 kg [Nm/kg], shape (n,).
    inertia: FloatArray
    gravity: FloatArray
    muscles: tuple[MusclePath, MusclePath]  #: Triceps surae and tibialis anterior.
    columns: tuple[int, ...]  #: Columns of the wanted parameters that touch it.
    #: Derivatives of inertia and gravity together by those parameters, shape (s, n).
    limb_slopes: FloatArray


class Movement:
    """The movement of one recording; computed once where no parameter touches it.

    `at` holds the columns of the model's parameters.
    """

    def __init__(self, inputs: ModelInputs, options: ModelOptions, at: Mapping[str, int]) -> None:
        self._inputs, self._options = inputs, options
        self._at = {name: at[name] for name in _TURNING if name in at}
        self._fixed = None if self._at else self._moved({}, {})

    @property
    def is_fixed(self) -> bool:
        """Whether no parameter touches it."""
        return self._fixed is not None

    def at(self, values: FloatArray, wanted: Collection[int] = ()) -> LegMovement:
        """The movement at these parameters, with its derivatives by the wanted columns."""
        if self._fixed is not None:
            return self._fixed
        turns = {name: float(values[column]) for name, column in self._at.items()}
        columns = {name: column for name, column in self._at.items() if column in wanted}
        return self._moved(turns, columns)

    def _moved(self, turns: Mapping[str, float], columns: Mapping[str, int]) -> LegMovement:
        inputs, options = self._inputs, self._options
        velocity, acceleration = inputs.velocity, inputs.acceleration
        angle = inputs.angle + turns.get("angle_zero", 0.0)
        if _AXIS[0] in turns:
            forward, up = (turns[name] for name in _AXIS)
            axis = AnkleAxis(angle=angle, forward=forward, up=up)
            joint, slopes = axis.joint, [axis.slope(_TURNING[name]) for name in columns]
        else:
            still, same = np.zeros_like(angle), np.ones_like(angle)
            joint = JointAngle(angle, same, still)
            slopes = [JointAngle(same, still, still)] * len(columns)
        turning = joint.factor * velocity
        swinging = joint.factor * acceleration + joint.bend * velocity**2
        inertia = inertia_torque(acceleration=swinging)
        gravity = gravity_torque(angle=joint.angle, theta_foot=options.theta_foot)
        falling = gravity_slope(angle=joint.angle, theta_foot=options.theta_foot)
        limb_slopes = np.empty((len(columns), inputs.n))
        for row, by in enumerate(slopes):
            swung = by.factor * acceleration + by.bend * velocity**2
            limb_slopes[row] = by.factor * (inertia + gravity)
            limb_slopes[row] += joint.factor * (
                inertia_torque(acceleration=swung) + falling * by.angle
            )
        tri, tib = paths(angle=joint.angle, velocity=turning, options=options)
        return LegMovement(
            inertia=joint.factor * inertia,
            gravity=joint.factor * gravity,
            muscles=(_muscle(tri, joint, slopes, velocity), _muscle(tib, joint, slopes, velocity)),
            columns=tuple(columns.values()),
            limb_slopes=limb_slopes,
        )


def _muscle(
    path: Path, joint: JointAngle, slopes: list[JointAngle], velocity: FloatArray
) -> MusclePath:
    arm, length, speed = np.empty((3, len(slopes), len(path.arm)))
    for row, by in enumerate(slopes):
        arm[row] = by.factor * path.arm + joint.factor * path.arm_slope * by.angle
        length[row] = path.slope * by.angle
        speed[row] = (path.bend * by.angle * joint.factor + path.slope * by.factor) * velocity
    return MusclePath(joint.factor * path.arm, path.length, path.speed, arm, length, speed)
