"""Which nuisances the data ask for: evidence of every subset, from one Laplace approximation.

Around the mode −2 ln p is a quadratic, so the evidence of a model without some nuisances (each at
the value at which it is off, its prior not counted) is a matter of small matrices:

    −2 ln Z = cost at its own mode + ln|H| − Σ ln(1/sd²) of the nuisances that are in.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.linalg.lapack import dtrtri

from surae.base.units import FloatArray

#: Rounding of sums over samples, of a matrix with ones on its diagonal.
_ROUNDING = 1e-11


def root(covariance: FloatArray, unit: FloatArray | None = None) -> FloatArray:
    """Shifts whose outer products add up to a covariance, shape (r, q).

    In `unit`, shape (q,), all are of one size: what is in volts is then rounded as what is in mm.
    """
    unit = np.ones(len(covariance)) if unit is None else unit
    scaled = covariance / np.outer(unit, unit)
    values, vectors = np.linalg.eigh(0.5 * (scaled + scaled.T))
    kept = values > 1e-12 * max(float(values[-1]), 1e-300)
    return np.asarray((vectors[:, kept] * np.sqrt(values[kept])).T * unit)


def inverse_of(information: FloatArray) -> FloatArray:
    """Covariance of an information whose columns are of very different size, shape (q, q)."""
    scale = 1.0 / np.sqrt(np.diag(information))
    return np.asarray(np.linalg.inv(information * scale * scale[:, None]) * scale * scale[:, None])


@dataclass(frozen=True, slots=True)
class LaplaceApproximation:
    """−2 ln p of the data around a point, and the priors."""

    information: FloatArray  #: JᵀJ of the data, shape (q, q).
    gradient: FloatArray  #: Jᵀe of the data, shape (q,).
    cost: float  #: eᵀe of the data.
    #: `z`, `mean`, `weight`: the point, and the priors' means and 1/sd, shape (q,).
    z: FloatArray
    mean: FloatArray
    weight: FloatArray

    def solved(self) -> tuple[float, FloatArray, FloatArray]:
        """Evidence −2 ln Z, mode (q,) and covariance (q, q)."""
        weight2 = self.weight**2
        away = self.z - self.mean
        H = self.information + np.diag(weight2)
        g = self.gradient + weight2 * away
        # Columns of very different size: a factor of what is scaled keeps its digits.
        scale = 1.0 / np.sqrt(np.diag(H))
        scaled = H * scale * scale[:, None]
        try:
            factor = np.linalg.cholesky(scaled)
        except np.linalg.LinAlgError:  # data without noise outweigh every prior to the last digit
            factor = np.linalg.cholesky(scaled + _ROUNDING * np.eye(len(scaled)))
        inverse = dtrtri(factor, lower=1)[0] * scale
        solved = inverse @ g
        log_det = 2.0 * float(np.log(np.diag(factor) / scale).sum())
        evidence = self.cost + float(weight2 @ away**2 - solved @ solved)
        evidence += log_det - float(np.log(weight2).sum())
        return evidence, self.z - inverse.T @ solved, inverse.T @ inverse


@dataclass(frozen=True, slots=True)
class Subset:
    """A set of groups of nuisances and how well the data support it."""

    groups: tuple[str, ...]  #: Groups that are in.
    weight: float  #: Its posterior probability among the subsets.
    evidence: float  #: −2 ln Z.
    #: Where its parameters are, those that are out at their values of being off, shape (q,).
    mode: FloatArray
    variance: FloatArray  #: Of each of them, shape (q,).


def with_likely(
    scored: tuple[Subset, ...], asks: str, beside: str, likely: float
) -> tuple[Subset, ...]:
    """The sets, the best first that has a group whose probability is above `likely`.

    Of a group `asks` that is left out no interval has anything; one `beside` it that does nearly
    the same is in as well where it is as likely, so that the data decide between the two.
    """
    weight = {g: sum(s.weight for s in scored if g in s.groups) for g in (asks, beside)}
    there = {group for group, each in weight.items() if each > likely}
    if asks not in there:
        return scored
    chosen = next(s for s in scored if there <= {*s.groups})
    return chosen, *(s for s in scored if s is not chosen)


def subsets(
    laplace: LaplaceApproximation,
    groups: Mapping[str, Sequence[int]],
    off: Mapping[int, float],
    odds: Mapping[str, float] | None = None,
) -> tuple[Subset, ...]:
    """All subsets of the groups, given by their parameters' positions, the best supported first.

    `off` has the value at which each is off, `odds` those beforehand that a group is in, else 1.
    """
    least, mode, V = laplace.solved()
    at = [j for group in groups for j in groups[group]]
    sets = [chosen for n in range(len(groups) + 1) for chosen in combinations(groups, n)]
    held = np.array([[g not in chosen for g in groups for _ in groups[g]] for chosen in sets], bool)
    values = np.array([off[j] for j in at])
    mean = laplace.mean[at]
    weight = laplace.weight[at]
    # what all else does where some are held follows from the covariance of all
    sd = np.sqrt(np.diag(V))
    by = V[at] / np.outer(sd[at], sd)
    away = (values - mode[at]) / sd[at]
    both = held[:, :, None] & held[:, None, :]
    within = np.where(both, by[:, at], np.eye(len(at)))
    inverse = np.where(both, np.linalg.inv(within), 0.0)
    pulled = inverse @ away
    evidence = least + pulled @ away + np.linalg.slogdet(within)[1]
    evidence += held @ (2.0 * np.log(sd[at] * weight) - (weight * (values - mean)) ** 2)
    evidence -= [2.0 * sum(np.log((odds or {}).get(g, 1.0)) for g in chosen) for chosen in sets]
    modes = mode + sd * (pulled @ by)
    variances = sd**2 * (1.0 - (inverse @ by * by).sum(axis=1))
    modes[:, at] = np.where(held, values, modes[:, at])
    variances[:, at] *= ~held
    weights = np.exp(-0.5 * (evidence - evidence.min()))
    each = zip(sets, weights / weights.sum(), evidence, modes, variances, strict=True)
    scored = [Subset(s, float(w), float(e), *rest) for s, w, e, *rest in each]
    return tuple(sorted(scored, key=lambda subset: subset.evidence))
