"""What each recording of a joint fit says of the leg by itself, and how much trials differ.

With the parameters of trial i at θ + bᵢ, what recording i finds scatters about θ by its own
errors and by the standard deviation τ of b, another one for each parameter (random effects,
DerSimonian and Laird 1986). Two or three trials do not tell τ, so that all values of it are weighed
by how well they agree with what the recordings say. The scale up to which τ is alike likely is
sought among all parameters; few of them may be much greater (Gelman 2006).

What enters the common estimate is what recording i pulls it by, V·Jᵢᵀeᵢ, of which noise makes the
variance V·JᵢᵀJᵢ·V (Liang and Zeger 1986).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

from surae.estimation.evidence import Quadratic
from surae.estimation.mode import Mode, Target
from surae.estimation.noisy_emg import NoisyEmg
from surae.estimation.result import OfRecording
from surae.estimation.shifts import shaken, sized
from surae.frozen import FrozenDict
from surae.model.laboratory import group_of
from surae.units import FloatArray

#: Standard deviations τ that are weighed, as parts of the value, and scales of them all.
_SPREADS, _SCALES = np.geomspace(1e-5, 1.0, 110), np.geomspace(2e-3, 0.3, 20)
#: Power with which the prior of τ falls beyond the scale: three recordings tell a great τ from the
#: others themselves; two cannot, and would have any interval wide.
_FALLS, _OF_TWO = 1.0, 2.0
_NORMAL = 1.959964


class Each:
    """What each recording of a joint fit finds by itself.

    What trials share is held at the joint mode. `shift` is what was added to that against the bias
    by noise of the EMG: it is all recordings' alike.
    """

    def __init__(self, target: Target, mode: Mode, shift: FloatArray, noisy: NoisyEmg) -> None:
        self._target = target
        #: Each recording by itself, its mode, and what its data say around that.
        self.owns: list[tuple[Target, Mode, Quadratic]] = []
        estimates, errors = [], []
        for number in range(len(target.problem.inputs)):
            alone, there = target.alone(mode.z, number)
            quadratic = alone.quadratic(there)
            self.owns.append((alone, there, quadratic))
            of_it = replace(noisy, changes=tuple((draw[number],) for draw in noisy.changes))
            emg = shaken(alone, there, quadratic, of_it)["emg_noise"]
            whole = quadratic.solved({})[2]
            less = noisy.part * whole @ quadratic.information @ whole
            sd = np.sqrt(np.maximum(np.diag(whole - less), 0.0) + np.sum(emg**2, axis=0))
            at = [j for j, name in enumerate(alone.names) if name in target.names]
            self.names = tuple(alone.names[j] for j in at)
            self._at = [target.names.index(name) for name in self.names]
            estimates.append(there.z[at] + shift[self._at])
            errors.append(sd[at])
        self._estimates, self._errors = np.stack(estimates), np.stack(errors)
        self._leg = np.array([group_of(name) is None for name in self.names])

    def told(self) -> tuple[OfRecording, ...]:
        """Values of the leg's parameters by each recording, in their units."""
        log = self._target.log[self._at]
        lower, upper = (bound[self._at] for bound in (self._target.lower, self._target.upper))
        recordings = []
        for z, sd in zip(np.clip(self._estimates, lower, upper), self._errors, strict=True):
            values = np.where(log, np.exp(np.where(log, z, 0.0)), z)
            sems = np.where(log, values, 1.0) * sd
            both = zip(self.names, values.tolist(), sems.tolist(), self._leg, strict=True)
            leg = [(name, value, sem) for name, value, sem, is_leg in both if is_leg]
            recordings.append(
                OfRecording(
                    FrozenDict((name, value) for name, value, _ in leg),
                    FrozenDict((name, sem) for name, _, sem in leg),
                )
            )
        return tuple(recordings)

    def shifts(self, mode: Mode, quadratic: Quadratic) -> FloatArray:
        """What differences between trials do to the estimates.

        Of shape (r, q), as they are searched; see `Family.spread`.
        """
        covariance, named = quadratic.solved({})[2], slice(len(self._target.names))
        pulls, expected = [], []
        for rows in self._target.data_rows(mode.z):
            pulls.append((covariance @ (rows[:-1] @ rows[-1]))[named])
            expected.append(np.sum((covariance @ rows[:-1]) ** 2, axis=1)[named])
        pulled, noise = np.stack(pulls), np.maximum(np.stack(expected), 1e-300)
        total = noise.sum(axis=0)
        leg = np.array([group_of(name) is None for name in self._target.names])
        size = np.where(leg, np.abs(mode.z[named]), 1.0 / quadratic.weight[named])
        size = np.where(self._target.log, 1.0, np.maximum(size, 1e-12))
        weights = _weighed(pulled * total / noise / size, total / np.sqrt(noise) / size, leg)
        share = np.sum((noise / total) ** 2, axis=0)
        known = np.diag(covariance)[named] / size**2
        deviations = size * np.sqrt(share * _effective(known, share, weights))
        shifts = np.zeros((len(pulled), len(mode.z)))
        shifts[:, named] = sized(pulled - pulled.mean(axis=0), deviations)
        return shifts


def trial_spread(recordings: Sequence[OfRecording]) -> dict[str, tuple[float, float]]:
    """Standard deviation from trial to trial of each parameter, in its unit.

    The likeliest half lies below the first number, 95 % below the second.
    """
    names = [n for n in recordings[0].values if all(n in each.values for each in recordings)]
    values = np.array([[each.values[name] for name in names] for each in recordings])
    sems = np.array([[each.sem[name] for name in names] for each in recordings])
    size = np.maximum(np.abs(values.mean(axis=0)), 1e-12)
    below = np.cumsum(_weighed(values / size, sems / size, np.ones(len(names), bool)), axis=1)
    middle, most = (
        size * _SPREADS[np.minimum((below < part).sum(axis=1), len(_SPREADS) - 1)]
        for part in (0.5, 0.95)
    )
    return {n: (float(a), float(b)) for n, a, b in zip(names, middle, most, strict=True)}


def _weighed(estimates: FloatArray, errors: FloatArray, leg: npt.NDArray[np.bool_]) -> FloatArray:
    """Probability of each τ of each parameter, shape (p, τ), their scale sought among the leg's."""
    precision = 1.0 / (errors[:, :, None] ** 2 + _SPREADS**2)
    total = precision.sum(axis=0)
    away = estimates[:, :, None] - (precision * estimates[:, :, None]).sum(axis=0) / total
    ln_l = 0.5 * (np.log(precision).sum(axis=0) - np.log(total) - (precision * away**2).sum(axis=0))
    likely = np.exp(ln_l - ln_l.max(axis=1, keepdims=True))
    falls = _OF_TWO if len(estimates) == 2 else _FALLS
    prior = (_SCALES[:, None] + _SPREADS) ** -falls * np.gradient(_SPREADS)
    prior /= prior.sum(axis=1, keepdims=True)
    met = likely @ prior.T
    ln_p = np.log(np.maximum(met[leg], 1e-300)).sum(axis=0)
    scale = np.exp(ln_p - ln_p.max())
    weights = likely * ((scale / np.maximum(met, 1e-300)) @ prior)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


def _effective(known: FloatArray, own: FloatArray, weights: FloatArray) -> FloatArray:
    """The τ² that makes a normal 95 % interval as wide as that over all τ, shape (p,).

    `known` is the variance without differences, to which they add own·τ².
    """
    deviations = np.sqrt(known[:, None] + own[:, None] * _SPREADS**2)
    low, high = _NORMAL * np.sqrt(known), _NORMAL * deviations[:, -1]
    for _ in range(60):
        end = 0.5 * (low + high)
        beyond = 2.0 * (weights * ndtr(-end[:, None] / deviations)).sum(axis=1)
        low, high = np.where(beyond > 0.05, end, low), np.where(beyond > 0.05, high, end)
    more = np.maximum((high / _NORMAL) ** 2 - known, 0.0)
    return np.asarray(more / np.maximum(own, 1e-300))
