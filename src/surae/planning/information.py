"""What a trial tells of a leg: the Fisher information of torque and films, by exact sensitivities.

The torque's noise is white, so the information is JᵀJ/σ². Priors of nuisances are added by whoever
uses it: those that the trials of a session share count once, however many trials there are.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import Comparable, FrozenDict, read_only
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import FitResult
from surae.inference.posterior.film import DRIFT, DRIFT_S, group_of_film, names_of_film
from surae.inference.uncertainty.combined import Uncertainty
from surae.inference.uncertainty.covariance import Covariance, covariance
from surae.model import ModelSpec, with_optional
from surae.model.laboratory import laboratory
from surae.model.symmetry import GROUPS, PATH
from surae.planning.legs import Legs
from surae.protocol import Trajectory
from surae.recording.recording import PLACES
from surae.signals import ModelInputs, inputs_as_given, thinned

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
        trajectory.settings.profile,
        trajectory.settings.rate_hz,
        trajectory.time,
        trajectory.motion,
        legs.inputs(trajectory.effort),
        emg_unit=legs.emg_unit,
    )
    factor = max(int(inputs.rate_hz / rate_hz + 1e-9), 1)
    return inputs if factor == 1 else thinned(inputs, factor)


def information(
    trajectory: Trajectory, legs: Legs, noise: float, rate_hz: float = RATE
) -> Information:
    """A trial's information on each leg; `noise` [Nm] is that of one sample of the trajectory."""
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
    each = [j for j, name in enumerate(trial.names) if name in legs.each_trial]
    common = [j for j, name in enumerate(trial.names) if name not in legs.each_trial]
    if not each:
        return trial
    within = trial.matrices[:, each][:, :, each] + np.diag(
        [legs.priors[trial.names[j]].sd ** -2.0 for j in each]
    )
    cross = trial.matrices[:, each][:, :, common]
    remaining = trial.matrices[:, common][:, :, common]
    remaining = remaining - np.swapaxes(cross, 1, 2) @ np.linalg.solve(within, cross)
    return Information(tuple(trial.names[j] for j in common), read_only(remaining), trial.torque)


def estimated(names: Sequence[str], precision: FloatArray) -> Covariance | None:
    """Covariance of estimates with this information; None where the model gave no numbers."""
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
    return np.diag([legs.priors[n].sd ** -2.0 if n in legs.priors else 0.0 for n in names])


#: Frames a second that are counted, and their noise beside the drift [m].
_RATE = 5.0
_NOISE = 5e-4
#: Rate [Hz] at least at which a fit's recordings are simulated for it.
_SIMULATED = 64.0


def filmed(legs: Legs, muscles: Sequence[str]) -> Legs:
    """The same legs with films of these muscles, whose scales and zeros are estimated along."""
    if not muscles:
        return legs
    for muscle in muscles:
        if muscle not in PLACES:
            raise InputError(f"film: no muscle {muscle!r}; use {', '.join(PLACES)}")
    if "dlt_tri" not in legs.spec.names:
        raise InputError(f"{legs.spec.name} has rigid tendons, of which a film shows nothing new")
    names = [n for m in muscles for n in names_of_film(m) if n not in legs.free]
    spec = with_optional(legs.spec, names)
    values = np.zeros((len(legs.values), len(spec.names)))
    values[:, [spec.names.index(n) for n in legs.spec.names]] = legs.values
    known = laboratory()
    return replace(
        legs,
        name=Message("legs/filmed", legs=legs.name, names=", ".join(muscles)),
        spec=spec,
        free=(*legs.free, *names),
        values=read_only(values),
        films=tuple(muscles),
        priors=FrozenDict({**{n: known[n] for n in names}, **legs.priors}),
    )


def rows_of_films(
    muscles: Sequence[str],
    simulator: object,
    spec: ModelSpec,
    free: Sequence[str],
    values: FloatArray,
    time: FloatArray,
) -> list[FloatArray]:
    """Whitened derivatives of each film by the free parameters, shape (p, frames) each."""
    step = max(round(len(time) / ((time[-1] - time[0]) * _RATE)), 1)
    at = np.arange(0, len(time), step)
    columns = [spec.names.index(name) for name in free]
    at_point = simulator.tangent(values, columns, lengths=True)  # type: ignore[attr-defined]
    lengths = at_point.lengths
    slopes = at_point.length_jacobian
    apart = np.abs(time[at][:, None] - time[at]) / DRIFT_S
    factor = np.linalg.cholesky(DRIFT**2 * np.exp(-apart) + _NOISE**2 * np.eye(len(at)))
    whitened = []
    for muscle in muscles:
        group = group_of_film(f"fascicle_{muscle}")
        rows = slopes[group][:, at].copy()
        for name, by in zip(names_of_film(muscle), (lengths[group][at], 1.0), strict=True):
            if name in free:
                rows[list(free).index(name)] = by
        whitened.append(np.linalg.solve(factor, rows.T).T)
    return whitened


def covariance_if_filmed(result: FitResult, known: Uncertainty, muscle: str) -> FloatArray | None:
    """Covariance of a fit's parameters, had a muscle been filmed; None if it was, or named."""
    names = names_of_film(muscle)
    problem = result.problem
    if known.is_of_noise_alone or names[0] in problem.free:
        return None
    spec = with_optional(problem.spec, names)
    free = (*problem.free, *names)
    values = spec.vector({**result.values, **dict.fromkeys(names, 0.0)}, problem.options)
    p = len(problem.free)
    here = known.at_assumed
    group = group_of_film(f"fascicle_{muscle}")
    path = f"{PATH}_{GROUPS[group]}"
    scales = [] if known.geometry is None else [path] * (path in known.geometry.by)
    priors = laboratory()
    V = np.diag([0.0] * p + [priors[name].sd ** 2 for name in names] + [0.0] * len(scales))
    V[:p, :p] = here.covariance(*problem.free)
    if scales:
        V[-1, -1] = known.covariance(path)[0, 0]
    for whole in problem.inputs:
        recording = thinned(whole, max(int(whole.rate_hz / _SIMULATED + 1e-9), 1))
        simulator = spec.simulator(recording, problem.options)
        (J,) = rows_of_films((muscle,), simulator, spec, free, values, recording.time)
        if scales:  # all of a muscle's length goes with its path, as with the film's scale
            J = np.concatenate([J, J[[free.index(names[0])]]])
        gain = V @ J
        V = V - gain @ np.linalg.solve(J.T @ gain + np.eye(J.shape[1]), gain.T)
    filmed = V[:p, :p].copy()
    if known.geometry is not None:
        along = {
            scale: np.array([of.get(name, 0.0) for name in problem.free])
            for scale, of in known.geometry.by.items()
        }
        others = [scale for scale in along if scale not in scales]
        moved = np.array([along[scale] for scale in others])
        filmed += moved.T @ known.covariance(*others) @ moved if others else 0.0
        for scale in scales:
            with_path = np.outer(V[:p, -1], along[scale])
            filmed += with_path + with_path.T + V[-1, -1] * np.outer(along[scale], along[scale])
    return np.asarray(filmed)
