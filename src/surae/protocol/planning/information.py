"""What a trial tells of a leg: the Fisher information of torque and films, by exact sensitivities.

The torque's noise is white, so the information is JᵀJ/σ². Priors of nuisances are added by whoever
uses it: those that the trials of a session share count once, however many trials there are.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.assessment.uncertainty.covariance import Covariance, covariance
from surae.frozen import Comparable, read_only
from surae.model.laboratory import EACH_TRIAL, group_of
from surae.protocol import Trajectory
from surae.protocol.planning.filming import rows_of_films
from surae.protocol.planning.legs import Legs
from surae.signals import ModelInputs, inputs_as_given, thinned
from surae.units import FloatArray

#: A trial is judged at this rate at least [Hz]: it moves below 10 Hz.
RATE = 100.0
#: A direction's information below this part of the strongest one's is rounding, where each
#: parameter's own is 1: nothing is known there.
SINGULAR = 1e-13


@dataclass(frozen=True, slots=True, eq=False)
class Information(Comparable):
    """Information of one trial on each leg."""

    names: tuple[str, ...]  #: Parameters of the leg, then nuisances.
    matrices: FloatArray  #: Without the priors of the latter, shape (n_legs, p, p).
    #: Least and greatest torque that each leg asks of the device [Nm], shape (n_legs, 2).
    torque: FloatArray


def model_inputs(trajectory: Trajectory, legs: Legs, rate_hz: float = RATE) -> ModelInputs:
    """What a model of these legs reads of a trial, thinned to no less than `rate_hz`."""
    inputs = inputs_as_given(
        trajectory.settings.profile, trajectory.settings.rate_hz, trajectory.time,
        trajectory.motion, legs.inputs(trajectory.effort), emg_unit=legs.emg_unit,
    )  # fmt: skip
    factor = max(int(inputs.rate_hz / rate_hz + 1e-9), 1)
    return inputs if factor == 1 else thinned(inputs, factor)


def information(
    trajectory: Trajectory, legs: Legs, noise: float, rate_hz: float = RATE
) -> Information:
    """Information of a trial on each of the legs.

    `noise` is the standard deviation of the torque's white noise [Nm], sample by sample at the rate
    of the trajectory; the torque is simulated at `rate_hz` at least, where the trajectory has it.
    """
    inputs = model_inputs(trajectory, legs, rate_hz)
    variance = noise**2 * inputs.rate_hz / trajectory.settings.rate_hz
    simulator = legs.spec.simulator(inputs, legs.options)
    columns = [legs.spec.names.index(name) for name in legs.free]
    matrices = np.full((len(legs.values), len(columns), len(columns)), np.nan)
    torques = np.full((len(legs.values), 2), np.nan)
    with np.errstate(over="ignore", invalid="ignore"):
        for k, values in enumerate(legs.values):
            torque, jacobian = simulator.torque_jacobian(values, columns)
            torques[k] = torque.min(), torque.max()
            matrices[k] = jacobian @ jacobian.T / variance
            if legs.films:
                seen = legs.films, simulator, legs.spec, legs.free, values, inputs.time
                matrices[k] += sum(rows @ rows.T for rows in rows_of_films(*seen))
    return Information(legs.free, read_only(matrices), read_only(torques))


def shared(trial: Information, legs: Legs) -> Information:
    """The same, with the trial's own nuisances eliminated: what can be added to other trials."""
    own = {n for n in trial.names if n in legs.beliefs and group_of(n) in EACH_TRIAL}
    each = [j for j, name in enumerate(trial.names) if name in own]
    common = [j for j, name in enumerate(trial.names) if name not in own]
    if not each:
        return trial
    within = trial.matrices[:, each][:, :, each] + np.diag(
        [legs.beliefs[trial.names[j]].sd ** -2.0 for j in each]
    )
    cross = trial.matrices[:, each][:, :, common]
    remaining = trial.matrices[:, common][:, :, common]
    remaining = remaining - np.swapaxes(cross, 1, 2) @ np.linalg.solve(within, cross)
    return Information(tuple(trial.names[j] for j in common), read_only(remaining), trial.torque)


def estimated(names: Sequence[str], precision: FloatArray) -> Covariance | None:
    """Covariance of estimates with this information; what trades off has no variance in it.

    None where the model gave no numbers.
    """
    if not np.isfinite(precision).all():
        return None
    scale = np.sqrt(np.maximum(np.diag(precision), 0.0))
    scale = np.where(scale > 0.0, scale, 1.0)
    level, axes = np.linalg.eigh(precision / np.outer(scale, scale))
    level = np.where(level > SINGULAR * level[-1], level, 0.0)
    R = np.sqrt(level)[:, None] * axes.T * scale
    many = 10**9  # degrees of freedom: the noise is known
    return covariance(R, names, float(many), many + len(names))


def prior_precision(names: tuple[str, ...], legs: Legs) -> FloatArray:
    """What is known beforehand of the nuisances, shape (p, p)."""
    return np.diag([legs.beliefs[n].sd ** -2.0 if n in legs.beliefs else 0.0 for n in names])
