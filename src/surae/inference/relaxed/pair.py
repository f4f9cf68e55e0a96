"""Two visits of one leg together: possible legs in pairs, what both share drawn once.

The posteriors of both curves are mixtures of Gaussians of weights w and g = ln γ, each with the
prior p(g). Of one leg the tissue relaxes alike, so that jointly

    p(w₁, g₁, w₂, g₂) ∝ p₁(w₁, g₁)·p₂(w₂, g₂)·p(g₁, g₂)/(p(g₁)·p(g₂)),

where p(g₁, g₂) is that of a leg that relaxes as before, or of one that does not, by their
evidence. A plate that nobody took off, and a reflex, are there at both visits or at neither, but
for small odds: readings of the parts are paired by p(r₁, r₂)/(p(r₁)·p(r₂)) alike. What the
equations leave out is in part the leg's own, and the same at both visits, and so is by how much the
device's zero misses the ankle's; foot and axis are mounted anew, and noise is.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.inference.relaxed.context import GAMMA, ODDS_PLATE, ODDS_REFLEX
from surae.inference.relaxed.curve import LEFT_OUT, PossibleLegs, RelaxedCurve
from surae.inference.relaxed.regressors import TAUS

#: By how much ln γ of one leg differs between two visits, and how likely it does no more.
_ALIKE_SD = 0.15
_ALIKE = 0.9
#: What the equations leave out: the part that each visit has anew, one standard deviation; the
#: rest of `LEFT_OUT` is the leg's own.
_ANEW = 0.015
#: By how much the foot is turned on its plate as it is mounted anew [deg], one standard deviation:
#: the part of a zero that nobody measured which two visits do not share (assumed; goniometers of
#: one rater repeat within 1.3 to 2.8°, Konor et al. 2012, and a strapped foot at least as well).
REMOUNTED = 1.5
#: How many visits that is worth when baselines show how a foot was mounted.
_BELIEVED = 4
#: Probability that a plate, or a reflex, which one visit has is there at the other too.
_STAYS = 0.95
#: Pairs that are drawn, half of them mirrored; their seed. Parts less likely are left out.
_PAIRS = 2048
_SEED = 23
#: Numbers drawn beside the curves: zeros anew, what is left out anew, and what both share of each.
_LAST = 6
_TINY = 1e-3


@dataclass(frozen=True, slots=True)
class LegPairs:
    """Possible legs before and after, row by row."""

    before: PossibleLegs
    after: PossibleLegs
    alike: float  #: Posterior probability that the tissue relaxes as before.
    #: Posterior probability that one visit has a plate, or a reflex, and the other has none.
    unlike: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class _Joint:
    """One part of the joint posterior."""

    share: float
    first: int  #: Number of its part before.
    second: int  #: Of that after.
    mean: FloatArray  #: Of ln γ of both, shape (6,).
    covariance: FloatArray


def paired_legs(
    before: RelaxedCurve,
    after: RelaxedCurve,
    *,
    one_leg: bool = True,
    remounted: float = REMOUNTED,
) -> LegPairs:
    """Possible legs of two visits in pairs.

    Parameters
    ----------
    before, after : RelaxedCurve
        Posteriors of each alone.
    one_leg : bool
        Whether they are one leg's; two legs share nothing here.
    remounted : float
        By how much a foot is turned as it is mounted anew [deg], one standard deviation.

    Returns
    -------
    LegPairs
        Always the same for the same curves; every pair weighs the same.
    """
    joint, told = _joint_parts(before, after, one_leg=one_leg)
    random = np.random.default_rng(_SEED)
    count = len(TAUS)
    sizes = [curve.basis.size for curve in (before, after)]
    half = random.standard_normal((_PAIRS // 2, 2 * count + sum(sizes) + _LAST))
    normal = np.vstack([half, -half])
    chosen = random.permutation(_stratified([part.share for part in joint], _PAIRS // 2))
    chosen = np.tile(chosen, 2)
    gammas = np.empty((_PAIRS, 2 * count))
    weights = [np.empty((_PAIRS, size)) for size in sizes]
    for k, part in enumerate(joint):
        rows = chosen == k
        drawn = part.mean + normal[rows, : 2 * count] @ _factor(part.covariance).T
        gammas[rows] = drawn
        begin = 2 * count
        for into, curve, at, own in zip(
            weights,
            (before, after),
            (part.first, part.second),
            (drawn[:, :count], drawn[:, count:]),
            strict=True,
        ):
            size = into.shape[1]
            into[rows] = _weights_given(curve, at, own, normal[rows, begin : begin + size])
            begin += size
    last = normal[:, -_LAST:]
    shared = math.sqrt(LEFT_OUT**2 - _ANEW**2) if one_leg else 0.0
    anew = _ANEW if one_leg else LEFT_OUT
    turned = [
        min(curve.zero_sd, remounted) if one_leg else curve.zero_sd for curve in (before, after)
    ]
    sides = [
        PossibleLegs(
            np.full(_PAIRS, 1.0 / _PAIRS),
            weights[k],
            np.exp(np.clip(gammas[:, k * count : (k + 1) * count], -9.0, 2.0)),
            turned[k] * last[:, k] + math.sqrt(curve.zero_sd**2 - turned[k] ** 2) * last[:, 5],
            1.0 + shared * last[:, 4] + anew * last[:, 2 + k],
        )
        for k, curve in enumerate((before, after))
    ]
    return LegPairs(sides[0], sides[1], told, _unlike(before, after, joint))


def remounted_by(shifts: Sequence[float], variances: Sequence[float]) -> float:
    """By how much a foot is turned as it is mounted anew [deg], as unchanged visits have it.

    Parameters
    ----------
    shifts, variances : sequence of float
        By how much the curve of each further visit lies beside that of the first [deg], and how
        unsure that is [deg²].

    Returns
    -------
    float
        √((ν·s² + Σ(δ − δ̄)² − Σv)/(ν + n)) over all visits, the first with δ = 0: what is assumed,
        s, counts as ν visits (the mean of a scaled inverse χ², nearly).
    """
    if not shifts:
        return REMOUNTED
    every = np.array([0.0, *shifts])
    seen = float(((every - every.mean()) ** 2).sum()) - 0.5 * sum(variances)
    known = _BELIEVED * REMOUNTED**2 + max(seen, 0.0)
    return math.sqrt(known / (_BELIEVED + len(shifts)))


def _joint_parts(
    before: RelaxedCurve, after: RelaxedCurve, *, one_leg: bool
) -> tuple[list[_Joint], float]:
    """Parts of the joint posterior, and the probability that the tissue relaxes alike."""
    alike = _ALIKE if one_leg else 0.0
    count = len(TAUS)
    made = []
    likely = 0.0
    for i, first in enumerate(before.share):
        for j, second in enumerate(after.share):
            share = first * second * _staying(before, i, after, j, one_leg=one_leg)
            if share < _TINY:
                continue
            mean = np.concatenate([before.mean[i, -count:], after.mean[j, -count:]])
            covariance = np.zeros((2 * count, 2 * count))
            covariance[:count, :count] = before.covariance[i, -count:, -count:]
            covariance[count:, count:] = after.covariance[j, -count:, -count:]
            apart = share * (1.0 - alike)
            if apart > 0.0:
                made.append(_Joint(apart, i, j, mean, covariance))
            if alike > 0.0:
                log_factor, mean, covariance = coupled(mean, covariance)
                kin = share * alike * math.exp(log_factor)
                likely += kin
                made.append(_Joint(kin, i, j, mean, covariance))
    total = sum(part.share for part in made)
    return [
        _Joint(part.share / total, part.first, part.second, part.mean, part.covariance)
        for part in made
    ], likely / total


def _unlike(
    before: RelaxedCurve, after: RelaxedCurve, joint: Sequence[_Joint]
) -> tuple[float, float]:
    """Probability that plate, or reflex, are there at one visit alone."""
    if not before.parts or not after.parts:
        return 0.0, 0.0
    plate, reflex = (
        sum(
            part.share
            for part in joint
            if before.parts[part.first][k] != after.parts[part.second][k]
        )
        for k in (0, 1)
    )
    return plate, reflex


def _staying(before: RelaxedCurve, i: int, after: RelaxedCurve, j: int, *, one_leg: bool) -> float:
    """By how much likelier two parts are together than apart, by plate and reflex.

    Two legs of a person have one device, and each its own nerve.

    p(r₁, r₂)/(p(r₁)·p(r₂)) of what is there with probability p and stays with probability s: s/p of
    both, (1 − s)/(1 − p) of one, and of neither what makes them sum to one.
    """
    if not before.parts or not after.parts:
        return 1.0
    made = 1.0
    odds = (ODDS_PLATE, ODDS_REFLEX)[: 2 if one_leg else 1]
    for first, second, p in zip(before.parts[i], after.parts[j], odds, strict=False):
        if first and second:
            made *= _STAYS / p
        elif first or second:
            made *= (1.0 - _STAYS) / (1.0 - p)
        else:
            made *= (1.0 - 2.0 * p + p * _STAYS) / (1.0 - p) ** 2
    return made


def coupled(mean: FloatArray, covariance: FloatArray) -> tuple[float, FloatArray, FloatArray]:
    """Log Bayes factor of relaxing alike, and the posterior of ln γ of both with it.

    Parameters
    ----------
    mean, covariance : ndarray
        Of ln γ before and after, each visit alone, shapes (6,) and (6, 6).

    Returns
    -------
    tuple
        ln ∫ N(g; mean, covariance)·p(g₁, g₂)/(p(g₁)·p(g₂)) dg, and the mean and covariance of what
        is integrated, by Gaussian algebra.
    """
    middle, sd = GAMMA
    count = len(mean) // 2
    variance = sd**2
    common = variance - 0.5 * _ALIKE_SD**2
    prior = np.kron(np.array([[variance, common], [common, variance]]), np.eye(count))
    more = np.linalg.inv(prior) - np.eye(2 * count) / variance
    precision = np.linalg.inv(covariance)
    joint = precision + more
    away = mean - middle
    along = precision @ away
    posterior: FloatArray = np.asarray(np.linalg.inv(joint), dtype=float)
    moved = posterior @ along
    log_factor = 0.5 * float(along @ moved - along @ away)
    log_factor += 0.5 * float(np.linalg.slogdet(precision)[1] - np.linalg.slogdet(joint)[1])
    log_factor += 0.5 * float(2 * count * math.log(variance) - np.linalg.slogdet(prior)[1])
    return log_factor, middle + moved, posterior


def _weights_given(
    curve: RelaxedCurve, part: int, gammas: FloatArray, normal: FloatArray
) -> FloatArray:
    """Weights of the curve drawn from a part, given ln γ; shape (n, p)."""
    p = curve.basis.size
    mean = curve.mean[part]
    whole = curve.covariance[part]
    gain = np.linalg.solve(whole[p:, p:], whole[p:, :p]).T
    inner = whole[:p, :p] - gain @ whole[p:, :p]
    given: FloatArray = mean[:p] + (gammas - mean[p:]) @ gain.T
    return given + normal @ _factor(0.5 * (inner + inner.T)).T


def _factor(covariance: FloatArray) -> FloatArray:
    """A square root of a covariance, which may be singular by rounding."""
    values, vectors = np.linalg.eigh(covariance)
    made: FloatArray = vectors * np.sqrt(np.maximum(values, 0.0))
    return made


def _stratified(shares: Sequence[float], count: int) -> FloatArray:
    """Numbers of parts, as often as their shares say, by systematic sampling."""
    edges = np.cumsum(shares)
    places = (np.arange(count) + 0.5) / count
    return np.asarray(np.minimum(np.searchsorted(edges, places), len(edges) - 1))
