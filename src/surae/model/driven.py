"""The models of rigid tendons with optional drives: the quiet leg, and its muscles on top.

On rigid tendons the torque is that of a leg without EMG plus r·f_l·f_v·α of each muscle group, so
the model as it is computes the first, and only the second is new.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.model import rigid, rigid_2010
from surae.model.contraction import contraction_gains
from surae.model.drives import DrivenActivation, Drives
from surae.model.geometry import length_tib, length_tri, paths
from surae.model.muscle import MuscleSimulator
from surae.model.muscle_2010 import Muscle2010Simulator, integrated
from surae.model.options import ModelOptions
from surae.model.simulator import Simulator, TorqueParts
from surae.model.stages import ALPHA, BY_BETA, BY_F0, CHANNEL, GROUPS
from surae.recording import read_only
from surae.signals import ModelInputs
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class _Roles:
    """Positions of a model's parameters: how many there are, and which of them the muscles have."""

    own: int
    weights: int
    f0: int
    beta: int | None
    l0: int | None


_MUSCLE = _Roles(rigid.N_MUSCLE, rigid.G, rigid.F0, rigid.BETA, rigid.L0)
_MUSCLE_2010 = _Roles(rigid_2010.N_2010, rigid_2010.E, rigid_2010.F, None, None)


class DrivenSimulator:
    """A model of rigid tendons with drives on one recording; see the module.

    Parameters
    ----------
    quiet : Simulator
        The model tied to the recording without EMG.
    drives : Drives
        What takes the EMG's place, at the samples.
    inputs, options : ModelInputs, ModelOptions
        Of the recording.
    roles : _Roles
        Positions of the parameters; where l0 has none, it is the length at θ = 0.
    """

    def __init__(
        self,
        quiet: Simulator,
        drives: Drives,
        inputs: ModelInputs,
        options: ModelOptions,
        roles: _Roles,
    ) -> None:
        self._quiet, self._drives, self._roles = quiet, drives, roles
        self._paths = paths(inputs.angle, inputs.velocity, options)
        self._factor = float(options.vmax_factor)
        neutral = np.zeros(1)
        lengths = length_tri(neutral, options)[0], length_tib(neutral, options)[0]
        self._neutral = np.concatenate(lengths)

    def torque(self, values: FloatArray) -> FloatArray:
        """Modelled torque [Nm], shape (n,)."""
        alpha = self._activation(values).signals[ALPHA : ALPHA + 2, :, 0]
        quiet = self._quiet.torque(values[: self._roles.own])
        torque: FloatArray = quiet + (self._gains(values)[:, 0] * alpha).sum(axis=0)
        return torque

    def torque_jacobian(
        self, values: FloatArray, columns: Sequence[int]
    ) -> tuple[FloatArray, FloatArray]:
        """Modelled torque, shape (n,), and its derivatives, one row for each of `columns`."""
        roles = self._roles
        active = self._activation(values)
        signals, gains = active.signals[..., 0], self._gains(values)
        gain = gains[:, 0]
        rows: dict[int, FloatArray] = {
            roles.own + row: (gain * by).sum(axis=0)
            for row, by in enumerate(np.swapaxes(active.by_drive[..., 0], 0, 1))
        }
        for muscle, channels in enumerate(GROUPS):
            for c in channels:
                rows[roles.weights + c] = gain[muscle] * signals[CHANNEL + c]
            if roles.l0 is not None:
                rows[roles.l0 + muscle] = gains[muscle, 1] * signals[ALPHA + muscle]
        rows[roles.f0] = (gain * signals[BY_F0 : BY_F0 + 2]).sum(axis=0)
        if roles.beta is not None:
            rows[roles.beta] = (gain * signals[BY_BETA : BY_BETA + 2]).sum(axis=0)

        passive = [column for column in columns if column < roles.own and column not in rows]
        torque, quiet = self._quiet.torque_jacobian(values[: roles.own], passive)
        rows |= dict(zip(passive, quiet, strict=True))
        alpha = signals[ALPHA : ALPHA + 2]
        jacobian = np.stack([rows[column] for column in columns]) if len(columns) else quiet
        return torque + (gain * alpha).sum(axis=0), jacobian

    def parts(self, values: FloatArray) -> TorqueParts:
        """The torque split into its parts."""
        active, gain = self._activation(values), self._gains(values)[:, 0]
        neural = gain * active.signals[ALPHA : ALPHA + 2, :, 0]
        parts = replace(
            self._quiet.parts(values[: self._roles.own]),
            neural_tri=neural[0],
            neural_tib=neural[1],
        )
        if active.reflex is None:
            return parts
        reflex = gain * active.reflex[..., 0]
        return replace(parts, reflex_tri=reflex[0], reflex_tib=reflex[1])

    def tendon(self, values: FloatArray) -> None:
        """Nothing: the tendons are rigid."""

    def _activation(self, values: FloatArray) -> DrivenActivation:
        roles = self._roles
        beta = 1.0 if roles.beta is None else float(values[roles.beta])
        weights = values[roles.weights : roles.weights + 4]
        return self._drives.activation(values[roles.own :], weights, float(values[roles.f0]), beta)

    def _gains(self, values: FloatArray) -> FloatArray:
        """Of both groups, shape (2, 2, n): active torque per active state, and that by l0."""
        l0 = self._neutral if self._roles.l0 is None else values[self._roles.l0 :]
        return np.stack(
            [
                contraction_gains(one.arm, one.length, one.speed, float(l0[muscle]), self._factor)
                for muscle, one in enumerate(self._paths)
            ]
        )


def driven_muscle(
    inputs: ModelInputs, options: ModelOptions, names: Sequence[str]
) -> DrivenSimulator:
    """Model 1.0 with the drives whose parameters are `names`."""
    quiet = MuscleSimulator(_silent(inputs), options)
    drives = _drives(inputs, options, inputs.emg.T, names)
    return DrivenSimulator(quiet, drives, inputs, options, _MUSCLE)


def driven_muscle_2010(
    inputs: ModelInputs, options: ModelOptions, names: Sequence[str]
) -> DrivenSimulator:
    """The model of 2010 with the drives whose parameters are `names`; its EMG is integrated."""
    quiet = Muscle2010Simulator(_silent(inputs), options)
    drives = _drives(inputs, options, integrated(inputs), names)
    return DrivenSimulator(quiet, drives, inputs, options, _MUSCLE_2010)


def _silent(inputs: ModelInputs) -> ModelInputs:
    """The recording without EMG."""
    return replace(inputs, emg=read_only(np.zeros_like(inputs.emg)))


def _drives(
    inputs: ModelInputs, options: ModelOptions, emg: FloatArray, names: Sequence[str]
) -> Drives:
    speeds = np.stack([one.speed for one in paths(inputs.angle, inputs.velocity, options)])
    return Drives(emg, speeds, 1.0 / inputs.rate_hz, names, (0.0,))
