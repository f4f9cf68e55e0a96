"""What a recording's movement does to limb and muscles, as far as its sensors can be believed.

The angle that is measured is that of the device. Two parameters say how the joint's differs:

    θ_joint = angle_zero + (1 + axis)·θ

`angle_zero` is the sensor's zero. `axis` is what a joint's axis beside the device's does: with the
foot on the plate, the joint's centre moves on an arc around the device's axis, and the shank, held
at a distance L, turns with it; an offset d turns it by about d/L of the foot's angle (2 cm at 40
cm: 0.05). No work is lost, T·dθ = T_joint·dθ_joint, so that the device measures (1 + axis) times
the torque of the muscles, the 5 to 9 % of Arampatzis et al. (2007). The foot turns with the plate:
gravity depends on θ + angle_zero, inertia on the device's own acceleration, neither on `axis`.

References
----------
A. Arampatzis, G. De Monte, G. Morey-Klapsing (2007). Effect of contraction form and contraction
velocity on the differences between resultant and measured ankle joint moments. Journal of
Biomechanics 40(7):1622-1628.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from surae.model import limb
from surae.model.geometry import Path, paths
from surae.model.options import ModelOptions
from surae.signals import ModelInputs
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class MusclePath:
    """Path of one muscle group as the device's torque knows it.

    Attributes
    ----------
    arm, length, speed : ndarray, shape (n,)
        Signed moment arm [m], length [m] and lengthening speed [m/s] on a rigid tendon.
    columns : tuple of int
        Columns of the wanted parameters that touch it.
    arm_slopes, length_slopes, speed_slopes : ndarray, shape (s, n)
        Derivatives of the three by those parameters.
    """

    arm: FloatArray
    length: FloatArray
    speed: FloatArray
    columns: tuple[int, ...]
    arm_slopes: FloatArray
    length_slopes: FloatArray
    speed_slopes: FloatArray


@dataclass(frozen=True, slots=True)
class LegMovement:
    """Limb and muscles of a moving leg.

    Attributes
    ----------
    inertia, gravity : ndarray, shape (n,)
        Torques of 1 kg [Nm/kg].
    gravity_slope : ndarray, shape (n,)
        Derivative of `gravity` by angle_zero [Nm/(kg·rad)].
    muscles : tuple of MusclePath
        Triceps surae and tibialis anterior.
    """

    inertia: FloatArray
    gravity: FloatArray
    gravity_slope: FloatArray
    muscles: tuple[MusclePath, MusclePath]


class Movement:
    """The movement of one recording; computed once where no parameter touches it.

    Parameters
    ----------
    inputs, options : ModelInputs, ModelOptions
        Of the recording.
    at : mapping of str to int
        Columns of the model's parameters.
    """

    def __init__(self, inputs: ModelInputs, options: ModelOptions, at: Mapping[str, int]) -> None:
        self._inputs, self._options, self._at = inputs, options, at
        self._fixed = None if {"angle_zero", "axis"} & at.keys() else self._moved(0.0, 0.0, {})

    @property
    def is_fixed(self) -> bool:
        """Whether no parameter touches it."""
        return self._fixed is not None

    def at(self, values: FloatArray, wanted: Collection[int] = ()) -> LegMovement:
        """The movement at these parameters, with its derivatives by the wanted columns."""
        if self._fixed is not None:
            return self._fixed
        zero, axis = (
            float(values[self._at[name]]) if name in self._at else 0.0
            for name in ("angle_zero", "axis")
        )
        columns = {
            name: self._at[name]
            for name in ("angle_zero", "axis")
            if name in self._at and self._at[name] in wanted
        }
        return self._moved(zero, axis, columns)

    def _moved(self, zero: float, axis: float, columns: Mapping[str, int]) -> LegMovement:
        inputs, options = self._inputs, self._options
        measured = inputs.angle
        angle, velocity = zero + (1.0 + axis) * measured, (1.0 + axis) * inputs.velocity
        tri, tib = paths(angle=angle, velocity=velocity, options=options)
        return LegMovement(
            inertia=limb.inertia_torque(acceleration=inputs.acceleration),
            gravity=limb.gravity_torque(angle=measured + zero, theta_foot=options.theta_foot),
            gravity_slope=limb.gravity_slope(angle=measured + zero, theta_foot=options.theta_foot),
            muscles=(
                self._muscle(tri, velocity, axis, columns),
                self._muscle(tib, velocity, axis, columns),
            ),
        )

    def _muscle(
        self, path: Path, velocity: FloatArray, axis: float, columns: Mapping[str, int]
    ) -> MusclePath:
        n, gear = len(path.arm), 1.0 + axis
        slopes = np.empty((3, len(columns), n))
        for row, name in enumerate(columns):
            turned = np.ones(n) if name == "angle_zero" else self._inputs.angle  # ∂θ_joint
            slopes[0, row] = gear * path.arm_slope * turned
            slopes[1, row] = path.slope * turned
            slopes[2, row] = path.bend * turned * velocity
            if name == "axis":
                slopes[0, row] += path.arm
                slopes[2, row] += path.slope * self._inputs.velocity
        return MusclePath(
            gear * path.arm, path.length, path.speed, tuple(columns.values()), *slopes
        )
