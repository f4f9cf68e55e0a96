"""How much trials of a joint fit differ, from what each says by itself.

With the parameters of trial i at θ + bᵢ, what recording i says scatters about θ by its own errors
and by the standard deviation τ of b, another one for each parameter (random effects, DerSimonian
and Laird 1986). Two or three trials do not tell τ, so that all values of it are weighed by how well
they agree with what the recordings say. The scale up to which τ is alike likely is sought among all
parameters; few of them may be much greater (Gelman 2006).
"""

from collections.abc import Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.inference.result import OfRecording

#: Standard deviations τ that are weighed, as parts of the value, and scales of them all.
_SPREADS = np.geomspace(1e-5, 1.0, 110)
_SCALES = np.geomspace(2e-3, 0.3, 20)
#: Power with which the prior of τ falls beyond the scale: three recordings tell a great τ from the
#: others themselves; two cannot estimate one.
_FALLS = 1.0
_OF_TWO = 2.0


def trial_spread(recordings: Sequence[OfRecording]) -> dict[str, tuple[float, float]]:
    """Standard deviation from trial to trial of each parameter, in its unit.

    The likeliest half lies below the first number, 95 % below the second.
    """
    names = [n for n in recordings[0].values if all(n in each.values for each in recordings)]
    values = np.array([[each.values[name] for name in names] for each in recordings])
    sems = np.array([[each.sem[name] for name in names] for each in recordings])
    size = np.maximum(np.abs(values.mean(axis=0)), 1e-12)
    below = np.cumsum(_weighed(values / size, sems / size), axis=1)
    middle, most = (
        size * _SPREADS[np.minimum((below < part).sum(axis=1), len(_SPREADS) - 1)]
        for part in (0.5, 0.95)
    )
    return {n: (float(a), float(b)) for n, a, b in zip(names, middle, most, strict=True)}


def farthest_apart(recordings: Sequence[OfRecording]) -> tuple[str, float]:
    """The parameter that trials of one leg tell least alike, and how rarely they do by chance.

    Q = Σ(θᵢ − θ̄)²/sᵢ² is χ² of n − 1 (Cochran 1954, Biometrics 10:101-129), or less, as one prior
    holds all together; the farthest of k is so far apart in 1 − (1 − p)ᵏ (Šidák 1967).
    """
    from scipy.special import gammaincc

    names = [n for n, sem in recordings[0].sem.items() if sem > 0.0]
    values, sems = (
        np.array([[of[n] for n in names] for of in each])
        for each in ([r.values for r in recordings], [r.sem for r in recordings])
    )
    away = values - (values / sems**2).sum(axis=0) / (1.0 / sems**2).sum(axis=0)
    alike = gammaincc(0.5 * (len(recordings) - 1), 0.5 * ((away / sems) ** 2).sum(axis=0))
    return names[int(alike.argmin())], 1.0 - (1.0 - float(alike.min())) ** len(names)


def _weighed(estimates: FloatArray, errors: FloatArray) -> FloatArray:
    """Probability of each τ of each parameter, shape (p, τ), their scale sought among them all."""
    precision = 1.0 / (errors[:, :, None] ** 2 + _SPREADS**2)
    total = precision.sum(axis=0)
    away = estimates[:, :, None] - (precision * estimates[:, :, None]).sum(axis=0) / total
    ln_l = 0.5 * (np.log(precision).sum(axis=0) - np.log(total) - (precision * away**2).sum(axis=0))
    likely = np.exp(ln_l - ln_l.max(axis=1, keepdims=True))
    falls = _OF_TWO if len(estimates) == 2 else _FALLS
    prior = (_SCALES[:, None] + _SPREADS) ** -falls * np.gradient(_SPREADS)
    prior /= prior.sum(axis=1, keepdims=True)
    met = likely @ prior.T
    ln_p = np.log(np.maximum(met, 1e-300)).sum(axis=0)
    scale = np.exp(ln_p - ln_p.max())
    weights = likely * ((scale / np.maximum(met, 1e-300)) @ prior)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))
