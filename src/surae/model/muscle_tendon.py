"""The muscle-tendon models tied to a recording (thesis 2.4): one model, whatever is freed of it."""

from collections.abc import Sequence

import numpy as np

from surae.frozen import read_only
from surae.model.activation import ActiveState
from surae.model.compliant import (
    ELONGATION,
    EPS0,
    FORCE,
    GAMMA,
    LENGTH,
    SPEED,
    TISSUE,
    compliant_states,
)
from surae.model.euler import explicit_states
from surae.model.movement import MusclePath
from surae.model.muscle import GROUP_COLUMNS
from surae.model.options import ModelOptions
from surae.model.parameters import (
    MUSCLE_PARAMETERS,
    OPTIONAL,
    OPTIONAL_PARAMETERS,
    TENDON_PARAMETERS,
)
from surae.model.simulator import TendonLaw, TendonState
from surae.model.tendon import SLACK_TIB, SLACK_TRI, tendon_curve
from surae.model.tied import Sums, TiedModel
from surae.signals import ModelInputs
from surae.units import FloatArray

#: Relative step of the central differences that the explicit scheme's derivatives are made of.
DIFFERENCE = 1e-6
_OWN = MUSCLE_PARAMETERS + TENDON_PARAMETERS
_NAMES = tuple(p.name for p in _OWN)
#: What such a step is relative to where a parameter is 0: of an optional one a part of its range.
_SCALES = {p.name: p.start for p in _OWN} | {p.name: 0.1 * p.upper for p in OPTIONAL_PARAMETERS}
#: Nothing comes before it is caused.
_DELAYS = (*OPTIONAL["emd"], "reflex_delay")
#: Columns of each group's own parameters, in the order of `surae.model.compliant`.
_COLUMNS = tuple(
    np.concatenate([own, [_NAMES.index(f"{of}_{group}") for of in ("dlt", "pt", "kt", "fmax")]])
    for own, group in zip(GROUP_COLUMNS, ("tri", "tib"), strict=True)
)


class MuscleTendonSimulator(TiedModel):
    """Models 2.0, 2.1, 2.2 on one recording.

    The muscle-tendon length is lmt = lt0 + x of the rigid tendon, in either geometry. Where the
    force balance of a sample cannot be solved (see `TendonState.unsolved`), the torque is NaN from
    there on.
    """

    def __init__(
        self, inputs: ModelInputs, options: ModelOptions, optional: Sequence[str] = ()
    ) -> None:
        lags = ((1.0 - GAMMA) / inputs.rate_hz, 0.0)
        super().__init__(
            inputs, options, own=_NAMES, optional=optional, weights=("g1", "g2", "g3", "g4"),
            lags=lags,
        )  # fmt: skip
        self._slack = np.array([SLACK_TRI, SLACK_TIB])
        in_metres = options.tendon_strain == "thesis"
        self._strain_lengths = np.ones(2) if in_metres else self._slack
        self._staged: dict[int, tuple[FloatArray, FloatArray]] = {}

    def tendon(self, values: FloatArray) -> TendonState:  # type: ignore[override]
        """Lengths, velocities and forces of muscles and tendons over time."""
        p = np.array(values, dtype=np.float64)
        leg = self._movement.at(p)
        states = np.stack(
            [
                self._states(p, group, leg.muscles[group], active)
                for group, active in enumerate(self._active(p, leg))
            ]
        )
        speeds = np.stack([muscle.speed for muscle in leg.muscles])
        first = [_first_not_finite(group) for group in states]
        return TendonState(
            muscle_length=read_only(states[:, LENGTH]),
            muscle_velocity=read_only(states[:, SPEED]),
            tendon_length=read_only(self._slack[:, None] + states[:, ELONGATION]),
            elongation=read_only(states[:, ELONGATION]),
            tendon_velocity=read_only(speeds - states[:, SPEED]),
            tendon_force=read_only(states[:, FORCE]),
            tissue_force=read_only(states[:, TISSUE]),
            active_force=read_only(states[:, FORCE] - states[:, TISSUE]),
            laws=(self._law(p, 0), self._law(p, 1)),
            unsolved=(first[0], first[1]),
        )

    def _force(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        force: FloatArray = self._states(p, group, muscle, active)[FORCE]
        return force

    def _forces(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        states = self._states(p, group, muscle, active)
        return np.stack([states[TISSUE], states[FORCE] - states[TISSUE]])

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
        force = self._integrate(p, group, muscle, active, into)[FORCE]
        into.torque[:] += muscle.arm * force
        for row, slot in enumerate(into.turned):
            into.jacobian[slot] += muscle.arm_slopes[row] * force

    def _integrate(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState, into: Sums
    ) -> FloatArray:
        columns = _COLUMNS[group]
        lengths, slopes = self._stages(group, muscle)
        states = np.full((5, len(muscle.length)), np.nan)
        compliant_states(
            p[columns], into.slots[columns], float(self._strain_lengths[group]), muscle.arm,
            lengths, active.alpha, active.slopes, into.slots[active.columns], slopes, into.turned,
            self._factor, self._dt, states, into.jacobian,
        )  # fmt: skip
        return states

    def _stages(self, group: int, muscle: MusclePath) -> tuple[FloatArray, FloatArray]:
        """Lengths and their slopes at the stages; once, where no parameter touches them."""
        if group not in self._staged or not self._movement.is_fixed:
            self._staged[group] = (
                self._at_stages(muscle.length, muscle.speed),
                self._at_stages(muscle.length_slopes, muscle.speed_slopes),
            )
        return self._staged[group]

    def _at_stages(self, length: FloatArray, speed: FloatArray) -> FloatArray:
        """Lengths or slopes at both stages of every step, shape (…, 2, n): cubic Hermite."""
        s = GAMMA
        staged = np.stack([length, length], axis=-2)
        staged[..., 0, 1:] = (
            (1 + 2 * s) * (1 - s) ** 2 * length[..., :-1]
            + s**2 * (3 - 2 * s) * length[..., 1:]
            + self._dt * s * (1 - s) * ((1 - s) * speed[..., :-1] - s * speed[..., 1:])
        )
        return staged

    def _law(self, values: FloatArray, group: int) -> TendonLaw:
        eps0, *others = (float(value) for value in values[_COLUMNS[group][EPS0:]])
        strain_length = float(self._strain_lengths[group])
        return TendonLaw(float(self._slack[group]), tendon_curve(eps0 * strain_length, *others))


class ThesisSimulator(MuscleTendonSimulator):
    """The muscle-tendon models by the thesis's explicit Euler scheme, at the recording's rate.

    Its derivatives are central differences with a relative step of `DIFFERENCE`. Where the scheme
    chatters between its clamps, the torque jumps with the parameters and no derivative is of use.
    """

    def torque_jacobian(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray]:
        """Modelled torque, shape (n,), and its derivatives, one row for each of `columns`."""
        torque, names = self.torque(values), list(self._at)
        jacobian = np.empty((len(columns), len(torque)))
        for row, j in zip(jacobian, columns, strict=True):
            step = DIFFERENCE * (abs(values[j]) or _SCALES[names[j]])
            below, above = np.array(values), np.array(values)
            below[j] -= step
            above[j] += step
            if names[j] in _DELAYS:
                below[j] = max(below[j], 0.0)
            row[:] = (self.torque(above) - self.torque(below)) / (above[j] - below[j])
        return torque, jacobian

    def _states(
        self, p: FloatArray, group: int, muscle: MusclePath, active: ActiveState
    ) -> FloatArray:
        states = np.full((5, len(muscle.length)), np.nan)
        explicit_states(
            p[_COLUMNS[group]], float(self._strain_lengths[group]), muscle.length,
            active.alpha[-1], self._factor, self._dt, states,
        )  # fmt: skip
        return states


def muscle_tendon_simulator(
    inputs: ModelInputs, options: ModelOptions, optional: Sequence[str] = ()
) -> MuscleTendonSimulator:
    """The simulator whose integrator `options` name, with these optional parameters."""
    if options.integrator == "explicit-euler":
        return ThesisSimulator(inputs, options, optional)
    return MuscleTendonSimulator(inputs, options, optional)


def _first_not_finite(states: FloatArray) -> int | None:
    """First sample of a group's states, shape (5, n), that are not all finite numbers."""
    wrong = np.flatnonzero(~np.isfinite(states).all(axis=0))
    return int(wrong[0]) if wrong.size else None
