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
    N_MUSCLE,
    G,
    M,
    active_state,
    rigid_forces,
    rigid_torque,
    rigid_torque_jacobian,
)
from surae.model.simulator import TorqueParts
from surae.signals import ModelInputs
from surae.units import FloatArray

_ALL = list(range(N_MUSCLE))


class MuscleSimulator:
    """Model 1.0 on one recording; whatever no parameter touches is computed here, once."""

    def __init__(self, inputs: ModelInputs, options: ModelOptions) -> None:
        tri, tib = paths(inputs.angle, inputs.velocity, options)
        self._inertia = limb.inertia_torque(inputs.acceleration)
        self._gravity = limb.gravity_torque(inputs.angle, options.theta_foot)
        self._arms = np.stack([tri.arm, tib.arm])
        self._lengths = np.stack([tri.length, tib.length])
        self._speeds = np.stack([tri.speed, tib.speed])
        self._emg = np.array(inputs.emg, dtype=np.float64, order="C")
        self._factor = float(options.vmax_factor)
        self._dt = 1.0 / inputs.rate_hz
        self._limb = self._inertia + self._gravity

    def _arguments(self, values: FloatArray) -> tuple[Any, ...]:
        # Copies: for a read-only or strided array numba would compile every kernel once more.
        p = np.array(values, dtype=np.float64)
        return (
            p, self._limb, self._arms, self._lengths, self._speeds, self._emg, self._factor,
            self._dt,
        )  # fmt: skip

    def torque(self, values: FloatArray) -> FloatArray:
        """Modelled torque [Nm], shape (n,)."""
        return rigid_torque(*self._arguments(values))

    def torque_jacobian(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray]:
        """Modelled torque, shape (n,), and its derivatives, one row for each of `columns`."""
        torque, jacobian = rigid_torque_jacobian(*self._arguments(values))
        wanted = list(columns)
        return torque, jacobian if wanted == _ALL else jacobian[wanted]

    def parts(self, values: FloatArray) -> TorqueParts:
        """The torque split into its parts."""
        p = np.array(values, dtype=np.float64)
        alpha = active_state(self._emg, p[G : G + 4], p[F0], p[BETA], self._dt)
        forces = rigid_forces(p, self._lengths, self._speeds, alpha, self._factor, self._dt)
        return TorqueParts(
            tissue_tri=self._arms[0] * forces[0, 0],
            tissue_tib=self._arms[1] * forces[1, 0],
            neural_tri=self._arms[0] * forces[0, 1],
            neural_tib=self._arms[1] * forces[1, 1],
            inertial=p[M] * self._inertia,
            gravitational=p[M] * self._gravity,
        )

    def tendon(self, values: FloatArray) -> None:
        """Nothing: the tendons are rigid."""
