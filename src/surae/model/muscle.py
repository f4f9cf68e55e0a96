"""The muscle model (1.0) tied to a recording."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from surae.model import limb
from surae.model.geometry import paths
from surae.model.options import ModelOptions
from surae.model.rigid import (
    BETA,
    F0,
    M,
    G,
    active_state,
    rigid_forces,
    rigid_torque,
    rigid_torque_jacobian,
)
from surae.model.simulator import TorqueParts
from surae.signals import ModelInputs
from surae.units import FloatArray


class MuscleSimulator:
    """Model 1.0 on one recording; whatever no parameter touches is computed here, once."""

    def __init__(self, inputs: ModelInputs, options: ModelOptions) -> None:
        tri, tib = paths(inputs.angle, inputs.velocity, options)
        self._inertia = limb.inertia_torque(inputs.acceleration)
        self._gravity = limb.gravity_torque(inputs.angle, options.theta_foot)
        self._arms = np.stack([tri.arm, tib.arm])
        self._lengths = np.stack([tri.length, tib.length])
        self._speeds = np.stack([tri.speed, tib.speed])
        self._emg = np.ascontiguousarray(inputs.emg)
        self._factor = float(options.vmax_factor)
        self._dt = 1.0 / inputs.rate_hz
        self._limb = self._inertia + self._gravity

    def _arguments(self) -> tuple[Any, ...]:
        return (
            self._limb, self._arms, self._lengths, self._speeds, self._emg, self._factor, self._dt,
        )  # fmt: skip

    def torque(self, values: FloatArray) -> FloatArray:
        """Modelled torque [Nm], shape (n,)."""
        return rigid_torque(values, *self._arguments())

    def torque_jacobian(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray]:
        """Modelled torque, shape (n,), and its derivatives, one row for each of `columns`."""
        torque, jacobian = rigid_torque_jacobian(values, *self._arguments())
        return torque, jacobian[list(columns)]

    def parts(self, values: FloatArray) -> TorqueParts:
        """The torque split into its parts."""
        alpha = active_state(self._emg, values[G : G + 4], values[F0], values[BETA], self._dt)
        forces = rigid_forces(values, self._lengths, self._speeds, alpha, self._factor, self._dt)
        return TorqueParts(
            tissue_tri=self._arms[0] * forces[0, 0],
            tissue_tib=self._arms[1] * forces[1, 0],
            neural_tri=self._arms[0] * forces[0, 1],
            neural_tib=self._arms[1] * forces[1, 1],
            inertial=values[M] * self._inertia,
            gravitational=values[M] * self._gravity,
        )
