"""The muscle-tendon models tied to a recording (thesis 2.4): one model, whatever is freed of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.model import limb
from surae.model.compliant import (
    ELONGATION,
    FORCE,
    LENGTH,
    N_COMPLIANT,
    SPEED,
    TISSUE,
    IntArray,
    compliant_torque,
)
from surae.model.explicit import explicit_states
from surae.model.geometry import paths
from surae.model.options import ModelOptions
from surae.model.parameters import MUSCLE_PARAMETERS, TENDON_PARAMETERS
from surae.model.rigid import M
from surae.model.simulator import TorqueParts
from surae.model.stages import GAMMA
from surae.model.tendon import SLACK_TIB, SLACK_TRI
from surae.recording import read_only
from surae.signals import ModelInputs
from surae.units import FloatArray

#: Relative step of the central differences that the explicit scheme's derivatives are made of.
DIFFERENCE = 1e-6
_STARTS = np.array([p.start for p in MUSCLE_PARAMETERS + TENDON_PARAMETERS])


@dataclass(frozen=True, slots=True)
class TendonState:
    """What muscle and tendon of both groups do over time; arrays (2, n), triceps surae first.

    Attributes
    ----------
    muscle_length, muscle_velocity : ndarray
        Length x [m] and lengthening velocity x' [m/s] of the muscle.
    tendon_length, elongation : ndarray
        Length lt and elongation lt − lt0 of the tendon [m]; a slack tendon's is negative.
    tendon_force, tissue_force, active_force : ndarray
        Force in the tendon, and the passive and active forces of the muscle that make it up [N].
    unsolved : tuple of int or None
        First sample of each group whose force balance could not be solved, which takes a number
        that is not finite; from there on everything is NaN.
    """

    muscle_length: FloatArray
    muscle_velocity: FloatArray
    tendon_length: FloatArray
    elongation: FloatArray
    tendon_force: FloatArray
    tissue_force: FloatArray
    active_force: FloatArray
    unsolved: tuple[int | None, int | None]


class MuscleTendonSimulator:
    """Models 2.0, 2.1, 2.2 on one recording; whatever no parameter touches is computed here, once.

    The muscle-tendon length is lmt = lt0 + x of the rigid tendon, in either geometry. Columns of a
    jacobian are to be distinct. Where the force balance of a sample cannot be solved (see
    `TendonState.unsolved`), the torque is NaN from there on.
    """

    def __init__(self, inputs: ModelInputs, options: ModelOptions) -> None:
        tri, tib = paths(inputs.angle, inputs.velocity, options)
        self._inertia = limb.inertia_torque(inputs.acceleration)
        self._gravity = limb.gravity_torque(inputs.angle, options.theta_foot)
        self._limb = self._inertia + self._gravity
        self._arms = np.stack([tri.arm, tib.arm])
        self._lengths = np.stack([tri.length, tib.length])
        self._emg = np.array(inputs.emg.T, dtype=np.float64, order="C")
        self._factor = float(options.vmax_factor)
        self._dt = 1.0 / inputs.rate_hz
        self._staged = _at_first_stage(self._lengths, np.stack([tri.speed, tib.speed]), self._dt)
        self._slack = np.array([SLACK_TRI, SLACK_TIB])
        in_metres = options.tendon_strain == "thesis"
        self._strain_lengths = np.ones(2) if in_metres else self._slack

    def torque(self, values: FloatArray) -> FloatArray:
        """Modelled torque [Nm], shape (n,)."""
        return self._run(values, ())[0]

    def torque_jacobian(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray]:
        """Modelled torque, shape (n,), and its derivatives, one row for each of `columns`."""
        torque, jacobian, _, _ = self._run(values, columns)
        return torque, jacobian

    def parts(self, values: FloatArray) -> TorqueParts:
        """The torque split into its parts; of the tendon's torque, tissue is F_elas·r."""
        states = self._states(values)[0]
        tissue = states[:, TISSUE]
        tissue, neural = self._arms * tissue, self._arms * (states[:, FORCE] - tissue)
        return TorqueParts(
            tissue_tri=tissue[0],
            tissue_tib=tissue[1],
            neural_tri=neural[0],
            neural_tib=neural[1],
            inertial=values[M] * self._inertia,
            gravitational=values[M] * self._gravity,
        )

    def tendon(self, values: FloatArray) -> TendonState:
        """Lengths, velocities and forces of muscles and tendons over time."""
        states, unsolved = self._states(values)
        first = [None if sample < 0 else int(sample) for sample in unsolved]
        return TendonState(
            muscle_length=read_only(states[:, LENGTH]),
            muscle_velocity=read_only(states[:, SPEED]),
            tendon_length=read_only(self._slack[:, None] + states[:, ELONGATION]),
            elongation=read_only(states[:, ELONGATION]),
            tendon_force=read_only(states[:, FORCE]),
            tissue_force=read_only(states[:, TISSUE]),
            active_force=read_only(states[:, FORCE] - states[:, TISSUE]),
            unsolved=(first[0], first[1]),
        )

    def _run(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
        slots = np.full(N_COMPLIANT, -1)
        slots[list(columns)] = np.arange(len(columns))
        # A copy: for a read-only or strided array numba would compile every kernel once more.
        p = np.array(values, dtype=np.float64)
        return compliant_torque(
            p, slots, self._limb, self._arms, self._lengths, self._staged, self._emg,
            self._strain_lengths, self._factor, self._dt,
        )  # fmt: skip

    def _states(self, values: FloatArray) -> tuple[FloatArray, IntArray]:
        _, _, states, unsolved = self._run(values, ())
        return states, unsolved


class ThesisSimulator(MuscleTendonSimulator):
    """The same models by the thesis's explicit Euler scheme, at the rate of the recording.

    Its derivatives are central differences with a relative step of `DIFFERENCE`. Where the scheme
    chatters between its clamps, the torque jumps with the parameters and no derivative is of use.
    """

    def torque(self, values: FloatArray) -> FloatArray:
        """Modelled torque [Nm], shape (n,)."""
        states, _ = self._states(values)
        torque: FloatArray = values[M] * self._limb + (self._arms * states[:, FORCE]).sum(axis=0)
        return torque

    def torque_jacobian(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray]:
        """Modelled torque, shape (n,), and its derivatives, one row for each of `columns`."""
        jacobian = np.empty((len(columns), len(self._limb)))
        for row, j in zip(jacobian, columns, strict=True):
            step = DIFFERENCE * (abs(values[j]) or _STARTS[j])
            below, above = np.array(values), np.array(values)
            below[j] -= step
            above[j] += step
            row[:] = (self.torque(above) - self.torque(below)) / (above[j] - below[j])
        return self.torque(values), jacobian

    def _states(self, values: FloatArray) -> tuple[FloatArray, IntArray]:
        p = np.array(values, dtype=np.float64)
        return explicit_states(
            p, self._lengths, self._emg, self._strain_lengths, self._factor, self._dt
        )


def muscle_tendon_simulator(inputs: ModelInputs, options: ModelOptions) -> MuscleTendonSimulator:
    """The simulator whose integrator `options` name."""
    if options.integrator == "explicit-euler":
        return ThesisSimulator(inputs, options)
    return MuscleTendonSimulator(inputs, options)


def _at_first_stage(lengths: FloatArray, speeds: FloatArray, dt: float) -> FloatArray:
    """Lengths at the first stage of the step that ends at each sample: cubic Hermite."""
    s = GAMMA
    staged = lengths.copy()
    staged[:, 1:] = (
        (1 + 2 * s) * (1 - s) ** 2 * lengths[:, :-1]
        + s**2 * (3 - 2 * s) * lengths[:, 1:]
        + dt * s * (1 - s) * ((1 - s) * speeds[:, :-1] - s * speeds[:, 1:])
    )
    return staged
