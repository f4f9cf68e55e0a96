"""The muscle-tendon models tied to a recording (thesis 2.4): one model, whatever is freed of it."""

from collections.abc import Sequence

import numpy as np

from surae.model import limb
from surae.model.compliant import (
    ELONGATION,
    EPS0,
    F_MAX,
    FORCE,
    K_TOE,
    LENGTH,
    N_COMPLIANT,
    SPEED,
    TISSUE,
    TOE,
    IntArray,
    compliant_torque,
)
from surae.model.drives import DrivenActivation, Drives
from surae.model.explicit import explicit_states
from surae.model.geometry import paths
from surae.model.options import ModelOptions
from surae.model.parameters import DRIVE_PARAMETERS, MUSCLE_PARAMETERS, TENDON_PARAMETERS
from surae.model.rigid import BETA, F0, G, M
from surae.model.simulator import TorqueParts
from surae.model.stages import ALPHA, GAMMA, staged_activation
from surae.model.tendon import SLACK_TIB, SLACK_TRI, tendon_curve
from surae.model.tendon_state import TendonLaw, TendonState
from surae.recording import read_only
from surae.signals import ModelInputs
from surae.units import FloatArray

#: Relative step of the central differences that the explicit scheme's derivatives are made of.
DIFFERENCE = 1e-6
_STARTS = np.array([p.start for p in MUSCLE_PARAMETERS + TENDON_PARAMETERS])
#: What such a step is relative to where a drive is off: a part of its range.
_DRIVE_SCALES = {p.name: 0.1 * p.upper for p in DRIVE_PARAMETERS}


class MuscleTendonSimulator:
    """Models 2.0, 2.1, 2.2 on one recording; whatever no parameter touches is computed here, once.

    The muscle-tendon length is lmt = lt0 + x of the rigid tendon, in either geometry. Columns of a
    jacobian are to be distinct. Where the force balance of a sample cannot be solved (see
    `TendonState.unsolved`), the torque is NaN from there on.
    """

    def __init__(
        self, inputs: ModelInputs, options: ModelOptions, drives: Sequence[str] = ()
    ) -> None:
        tri, tib = paths(inputs.angle, inputs.velocity, options)
        self._inertia = limb.inertia_torque(inputs.acceleration)
        self._gravity = limb.gravity_torque(inputs.angle, options.theta_foot)
        self._limb = self._inertia + self._gravity
        self._arms = np.stack([tri.arm, tib.arm])
        self._lengths = np.stack([tri.length, tib.length])
        self._emg = np.array(inputs.emg.T, dtype=np.float64, order="C")
        self._factor = float(options.vmax_factor)
        self._dt = 1.0 / inputs.rate_hz
        self._speeds = np.stack([tri.speed, tib.speed])
        self._staged = _at_first_stage(self._lengths, self._speeds, self._dt)
        self._slack = np.array([SLACK_TRI, SLACK_TIB])
        in_metres = options.tendon_strain == "thesis"
        self._strain_lengths = np.ones(2) if in_metres else self._slack
        lags = (1.0 - GAMMA) * self._dt, 0.0
        self._names = tuple(drives)
        self._drives = (
            Drives(self._emg, self._speeds, self._dt, drives, lags) if self._names else None
        )
        self._undriven = np.zeros((2, 0, inputs.n, 2))

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
        states = self._states(values)
        tissue = states[:, TISSUE]
        tissue, neural = self._arms * tissue, self._arms * (states[:, FORCE] - tissue)
        reflex = self._reflex_share(values)
        if reflex is not None:
            reflex *= neural
        return TorqueParts(
            tissue_tri=tissue[0],
            tissue_tib=tissue[1],
            neural_tri=neural[0],
            neural_tib=neural[1],
            inertial=values[M] * self._inertia,
            gravitational=values[M] * self._gravity,
            reflex_tri=None if reflex is None else reflex[0],
            reflex_tib=None if reflex is None else reflex[1],
        )

    def tendon(self, values: FloatArray) -> TendonState:
        """Lengths, velocities and forces of muscles and tendons over time."""
        states = self._states(values)
        first = [_first_not_finite(group) for group in states]
        return TendonState(
            muscle_length=read_only(states[:, LENGTH]),
            muscle_velocity=read_only(states[:, SPEED]),
            tendon_length=read_only(self._slack[:, None] + states[:, ELONGATION]),
            elongation=read_only(states[:, ELONGATION]),
            tendon_velocity=read_only(self._speeds - states[:, SPEED]),
            tendon_force=read_only(states[:, FORCE]),
            tissue_force=read_only(states[:, TISSUE]),
            active_force=read_only(states[:, FORCE] - states[:, TISSUE]),
            laws=(self._law(values, 0), self._law(values, 1)),
            unsolved=(first[0], first[1]),
        )

    def _run(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
        slots = np.full(N_COMPLIANT + len(self._names), -1)
        slots[list(columns)] = np.arange(len(columns))
        # A copy: for a read-only or strided array numba would compile every kernel once more.
        p = np.array(values, dtype=np.float64)
        alphas, by_drive = self._activation(p, len(columns) > 0)
        return compliant_torque(
            p, slots, self._limb, self._arms, self._lengths, self._staged, alphas, by_drive,
            self._strain_lengths, self._factor, self._dt,
        )  # fmt: skip

    def _activation(self, p: FloatArray, derivatives: bool) -> tuple[FloatArray, FloatArray]:
        """Active states at the stages with their derivatives, and those by the drives."""
        if self._drives is not None:
            driven = self._driven(self._drives, p)
            return driven.signals, driven.by_drive
        weights = p[G : G + 4]
        alphas = staged_activation(self._emg, weights, p[F0], p[BETA], self._dt, derivatives)
        return alphas, self._undriven

    def _driven(self, drives: Drives, p: FloatArray) -> DrivenActivation:
        return drives.activation(p[N_COMPLIANT:], p[G : G + 4], float(p[F0]), float(p[BETA]))

    def _reflex_share(self, values: FloatArray) -> FloatArray | None:
        """The reflex's part of both active states, shape (2, n); None without a reflex."""
        driven = None if self._drives is None else self._driven(self._drives, values)
        if driven is None or driven.reflex is None:
            return None
        alpha = driven.signals[ALPHA : ALPHA + 2, :, 1]
        share: FloatArray = np.divide(
            driven.reflex[..., 1], alpha, out=np.zeros_like(alpha), where=alpha > 0.0
        )
        return share

    def _states(self, values: FloatArray) -> FloatArray:
        return self._run(values, ())[2]

    def _law(self, values: FloatArray, group: int) -> TendonLaw:
        eps0 = values[EPS0 + group] * self._strain_lengths[group]
        others = (float(values[first + group]) for first in (TOE, K_TOE, F_MAX))
        return TendonLaw(float(self._slack[group]), tendon_curve(float(eps0), *others))


class ThesisSimulator(MuscleTendonSimulator):
    """The same models by the thesis's explicit Euler scheme, at the rate of the recording.

    Its derivatives are central differences with a relative step of `DIFFERENCE`. Where the scheme
    chatters between its clamps, the torque jumps with the parameters and no derivative is of use.
    """

    def torque(self, values: FloatArray) -> FloatArray:
        """Modelled torque [Nm], shape (n,)."""
        states = self._states(values)
        torque: FloatArray = values[M] * self._limb + (self._arms * states[:, FORCE]).sum(axis=0)
        return torque

    def torque_jacobian(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray]:
        """Modelled torque, shape (n,), and its derivatives, one row for each of `columns`."""
        jacobian = np.empty((len(columns), len(self._limb)))
        scales = [*_STARTS, *(_DRIVE_SCALES[name] for name in self._names)]
        for row, j in zip(jacobian, columns, strict=True):
            step = DIFFERENCE * (abs(values[j]) or scales[j])
            below, above = np.array(values), np.array(values)
            below[j] -= step
            above[j] += step
            if j >= N_COMPLIANT:  # nothing comes before it is caused
                below[j] = max(below[j], 0.0)
            row[:] = (self.torque(above) - self.torque(below)) / (above[j] - below[j])
        return self.torque(values), jacobian

    def _states(self, values: FloatArray) -> FloatArray:
        p = np.array(values, dtype=np.float64)
        alphas, _ = self._activation(p, False)
        return explicit_states(
            p, self._lengths, alphas, self._strain_lengths, self._factor, self._dt
        )[0]


def muscle_tendon_simulator(
    inputs: ModelInputs, options: ModelOptions, drives: Sequence[str] = ()
) -> MuscleTendonSimulator:
    """The simulator whose integrator `options` name, with the drives of these parameters."""
    if options.integrator == "explicit-euler":
        return ThesisSimulator(inputs, options, drives)
    return MuscleTendonSimulator(inputs, options, drives)


def _first_not_finite(states: FloatArray) -> int | None:
    """First sample of a group's states, shape (5, n), that are not all finite numbers."""
    wrong = np.flatnonzero(~np.isfinite(states).all(axis=0))
    return int(wrong[0]) if wrong.size else None


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
