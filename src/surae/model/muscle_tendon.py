"""The muscle-tendon models tied to a recording (thesis 2.4): one model, whatever is freed of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.model import compliant
from surae.model.activation import ActiveState, IntArray
from surae.model.compliant_stage import EPS0, GAMMA, LINEAR, STIFFNESS
from surae.model.movement import MusclePath
from surae.model.muscle import GROUP_COLUMNS
from surae.model.options import ModelOptions
from surae.model.parameters import MUSCLE_PARAMETERS, TENDON_PARAMETERS
from surae.model.recorded_model import Simulator, Sums
from surae.model.rigid import K_REL, TAU
from surae.model.simulator import TendonLaw, TendonState
from surae.model.tendon import tendon_curve
from surae.signals import ModelInputs

_OWN = MUSCLE_PARAMETERS + TENDON_PARAMETERS
_NAMES = tuple(p.name for p in _OWN)
#: Columns of each group's own parameters, in the order of `surae.model.compliant`.
COLUMNS = tuple(
    np.concatenate([own, [_NAMES.index(f"{of}_{group}") for of in ("dlt", "pt", "kt", "fmax")]])
    for own, group in zip(GROUP_COLUMNS, ("tri", "tib"), strict=True)
)
#: What shapes the curves of each group and makes its bridges hold, in the same order.
_CURVES = tuple(
    (
        f"fl_short_{group}",
        f"fl_long_{group}",
        "fv_speed",
        "fv_curve",
        "fv_stretch",
        "bridge_stiffness",
        "bridge_reach",
    )
    for group in ("tri", "tib")
)


@dataclass(frozen=True, slots=True)
class DriveResponse:
    """What short changes of the muscles' drives do to the torque of one recording."""

    drives: FloatArray  #: What each muscle adds to its group's excitation [N], shape (4, n).
    #: `steps`, `back`, `linear`, `arms`, `keep`: as `surae.model.compliant.drive_columns` takes
    #: them; the last two but one of both groups, (2, 2, 8, n) and (2, n).
    steps: FloatArray
    back: IntArray
    linear: FloatArray
    arms: FloatArray
    keep: float

    def columns(
        self, muscle: int, shapes: FloatArray, first: IntArray, size: int, *, lengths: bool = False
    ) -> FloatArray:
        """Derivatives of the torque by logarithmic gains of a drive, of TA, GL, SOL or GM.

        `shapes`, shape (c, w), are the gains' courses, each from its `first` sample on, (c,); given
        back are `size` samples from there on, (c, size) [Nm], or `lengths` of the group [m].
        """
        group = int(muscle == 0)
        n = self.drives.shape[1]
        width = shapes.shape[1]
        at = np.minimum(first[:, None] + np.arange(width), n - 1)
        inputs = np.where(first[:, None] + np.arange(width) < n, self.drives[muscle][at], 0.0)
        out = np.empty((len(first), size))
        arm = self.arms[group]
        if lengths:  # the torque is −arm·stiffness times the length
            stiffness = self.linear[group, 1, STIFFNESS]
            arm = np.divide(-1.0, stiffness, out=np.zeros(n), where=stiffness > 0.0)
        compliant.drive_columns(
            inputs * shapes, first, self.steps, self.back, self.linear[group], arm, self.keep, out
        )
        return out


@dataclass(frozen=True, slots=True)
class Tangent:
    """The model at one point, and how everything moves it there, to first order."""

    torque: FloatArray  #: [Nm], shape (n,).
    jacobian: FloatArray  #: Its derivatives by the wanted columns, shape (c, n).
    #: `active`, `tissue`: torque of contractile elements and tissue of both groups [Nm], (2, n).
    active: FloatArray
    tissue: FloatArray
    lengths: FloatArray  #: Of both muscle groups [m], shape (2, n).
    length_jacobian: FloatArray  #: Their derivatives, (2, c, n); (2, 0, n) where not wanted.
    response: DriveResponse  #: To the muscles' drives.


class MuscleTendonSimulator(Simulator):
    """Models 2.0, 2.1, 2.2 on one recording, of length lmt = lt0 + x of the rigid tendon.

    From a sample on whose balance cannot be solved (`TendonState.unsolved`) the torque is NaN.
    """

    def __init__(
        self, inputs: ModelInputs, options: ModelOptions, optional: Sequence[str] = ()
    ) -> None:
        lags = ((1.0 - GAMMA) / inputs.rate_hz, 0.0)
        super().__init__(inputs, options, names=_NAMES, optional=optional, lags=lags)
        self._n = inputs.n
        self._slack = np.array(options.anatomy.slack)
        in_metres = options.tendon_strain == "thesis"
        self._strain_lengths = np.ones(2) if in_metres else self._slack
        self._staged: dict[int, tuple[MusclePath, FloatArray, FloatArray, IntArray]] = {}
        self._curves = [[self._at.get(name, -1) for name in names] for names in _CURVES]
        #: Active state over which it reaches zero [N]; 0 is the model, with its kink.
        self.rest = 0.0

    def tendon(self, values: FloatArray) -> TendonState:
        """Lengths, velocities and forces of muscles and tendons over time."""
        p = np.array(values, dtype=np.float64)
        leg = self._movement.at(p)
        active = self._active(p, leg)
        states = np.stack([self._states(p, g, leg.muscles[g], active[g]) for g in range(2)])
        speeds = np.stack([muscle.speed for muscle in leg.muscles])
        wrong = np.asarray(~np.isfinite(states).all(axis=1))
        first = [int(group.argmax()) if group.any() else None for group in wrong]
        length, speed, elongation, force, tissue = np.swapaxes(states, 0, 1)
        return TendonState(
            read_only(length),
            read_only(speed),
            read_only(self._slack[:, None] + elongation),
            read_only(elongation),
            read_only(speeds - speed),
            read_only(force),
            read_only(tissue),
            read_only(force - tissue),
            (self._law(p, 0), self._law(p, 1)),
            (first[0], first[1]),
        )

    def muscles(self, values: FloatArray) -> FloatArray:
        """Muscle length [m], tendon elongation [m] and force [N] of both groups, (3, 2, n)."""
        state = self.tendon(values)
        return np.stack([state.muscle_length, state.elongation, state.tendon_force])

    def _force(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        return np.asarray(self._states(p, group, muscle, active)[compliant.FORCE])

    def _forces(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        *_, force, tissue = self._states(p, group, muscle, active)
        return np.stack([tissue, force - tissue])

    def _states(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        """States of a muscle group, shape (5, n)."""
        slots = np.zeros(len(p), dtype=np.int64)
        no_sums = Sums(np.empty(0), np.empty((1, 0)), slots, slots[:0])
        return self._integrate(p, group, muscle, active, no_sums)

    def _contract(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState, into: Sums
    ) -> None:
        states = self._integrate(p, group, muscle, active, into)
        into.states.append(states)
        force = states[compliant.FORCE]
        into.torque[:] += muscle.arm * force
        for row, slot in enumerate(into.turned):
            into.jacobian[slot] += muscle.arm_slopes[row] * force

    def _integrate(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState, into: Sums
    ) -> FloatArray:
        lengths, slopes, moving = self._stages(group, muscle)
        states = np.full((5, len(muscle.length)), np.nan)
        # the last value and the last row are of what the model does not have
        columns = np.concatenate([COLUMNS[group], self._curves[group]])
        linear = np.empty((0, LINEAR, 0)) if into.linear is None else into.linear[group]
        seen = np.empty((0, 0)) if into.seen is None else into.seen[group]
        constants = float(self._strain_lengths[group]), self._factor, self._dt, self.rest
        compliant.compliant_states(
            np.append(p, 0.0)[columns],
            np.append(into.slots, len(into.jacobian) - 1)[columns],
            constants,
            (muscle.arm, lengths, slopes, into.turned[moving]),
            (active.alpha, active.slopes, into.slots[active.columns]),
            (states, into.jacobian, linear, seen),
        )
        return states

    def tangent(
        self, values: FloatArray, columns: Sequence[int], *, lengths: bool = False
    ) -> Tangent:
        """The model and its derivatives by columns and drives, of `lengths` too, in one pass."""
        p = np.array(values, dtype=np.float64)
        n = self._n
        leg = self._movement.at(p, columns)
        linear = np.zeros((2, 2, LINEAR, n))
        seen = np.zeros((2, len(columns) + 1, n)) if lengths else None
        into = self._summed(p, columns, leg, linear, seen)
        length, _, _, force, tissue = np.swapaxes(np.stack(into.states), 0, 1)
        arms = np.stack([muscle.arm for muscle in leg.muscles])
        return Tangent(
            into.torque,
            into.jacobian[:-1],
            active=arms * (force - tissue),
            tissue=arms * tissue,
            lengths=length,
            length_jacobian=np.empty((2, 0, n)) if seen is None else seen[:, :-1],
            response=self._response(p, linear, arms),
        )

    def _response(self, p: FloatArray, linear: FloatArray, arms: FloatArray) -> DriveResponse:
        delay = float(p[self._at["emd"]]) if "emd" in self._at else 0.0
        steps, back = self.activation(p).instants(delay)
        k_rel = p[COLUMNS[0][K_REL]]
        tau = p[COLUMNS[0][TAU]]
        return DriveResponse(
            self._excitation.weighted(p),
            steps,
            back,
            linear,
            arms,
            keep=1.0 / (1.0 + GAMMA * self._dt * (1.0 + k_rel) / tau),
        )

    def _stages(self, group: int, muscle: MusclePath) -> tuple[FloatArray, FloatArray, IntArray]:
        """Lengths at the stages, slopes by what moves them, and of what; of the last path kept."""
        if group not in self._staged or self._staged[group][0] is not muscle:
            slopes = np.stack([muscle.length_slopes, muscle.speed_slopes])
            moving = np.flatnonzero(slopes.any(axis=(0, 2)))  # nothing of the other group does
            by = compliant.stages(slopes[0, moving], slopes[1, moving], self._dt)
            lengths = compliant.stages(muscle.length, muscle.speed, self._dt)
            self._staged[group] = muscle, lengths, by, moving
        return self._staged[group][1:]

    def _law(self, values: FloatArray, group: int) -> TendonLaw:
        eps0, *others = (float(value) for value in values[COLUMNS[group][EPS0:]])
        strain_length = float(self._strain_lengths[group])
        return TendonLaw(float(self._slack[group]), tendon_curve(eps0 * strain_length, *others))
