"""Two relaxed curves laid upon each other: by how much one is larger, and by how much it is turned.

A foot that is mounted anew moves the whole curve along the device's angle, and tissue that became
stiffer or softer makes it larger or smaller. An exponential alone looks alike after both; a curve
with a tibialis' side, a toe or a stop does not, as a shift moves both its ends one way. Of every
shift δ and size a,

    E₂(θ) − a·E₁(θ − δ) − c ~ N(0, V₂ + a²·V₁ − a·(C + C') + D),

V and C the covariances of the pairs of possible legs, c the zero of the torque, D what visits of
one leg differ in beyond the equations.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaincc, ndtri

from surae.base.units import FloatArray
from surae.inference.relaxed.curve import BEYOND, RelaxedCurve
from surae.inference.relaxed.pair import REMOUNTED, LegPairs, paired_legs

#: Shifts [deg] and logarithms of sizes that are tried.
_DEGREES = 0.5
_LOGS = 0.05
SHIFTS: FloatArray = _DEGREES * np.arange(-20.0, 21.0)
SIZES: FloatArray = _LOGS * np.arange(-18.0, 19.0)
#: Angles between two at which curves are laid upon each other [deg], and how many are needed.
_STEP = 2.0
_FEWEST = 7
#: What two visits of one leg differ in beyond the equations, one standard deviation, as a part of
#: what the curve rises; over so many degrees alike, and by a little at every angle.
_DIFFERS = 0.012
_ALIKE = 8.0
_ROUGH = 0.003
#: A curve counts as rising by so many Nm at least.
_FLAT = 0.01
#: Probability below which two curves are of no one form, so that neither size nor shift is told.
_UNLIKE = 0.01
#: What may have become of a leg: probabilities that nothing has, that its size has, that the curve
#: lies elsewhere, and that both have. Assumed: treatments act on one of them, mostly.
_NOTHING, _SIZED, _SHIFTED, _BOTH = 0.4, 0.25, 0.25, 0.1
#: By how much then, one standard deviation: logarithm of the size, and shift [deg].
_SIZE_SD = 0.35
_SHIFT_SD = 4.0
#: Seed of what is drawn.
_SEED = 29


@dataclass(frozen=True, slots=True)
class Alignment:
    """How well every shift and size lays the curve before upon the curve after."""

    likelihood: FloatArray  #: Of `SHIFTS` and `SIZES`, shape (41, 37); the largest is 1.
    is_one_form: bool  #: Whether any does, as well as two curves of one form would be laid.

    def sizes(self, mounting: "Remounting") -> FloatArray:
        """Density over `SIZES`, the shift what `mounting` and slack may make it; its sum is one."""
        slack = math.hypot(mounting.sd, _SHIFT_SD)
        share = (_SHIFTED + _BOTH) / (_NOTHING + _SIZED + _SHIFTED + _BOTH)
        away = SHIFTS - mounting.expected
        prior = (1.0 - share) * _normal(away, mounting.sd) + share * _normal(away, slack)
        made = prior @ self.likelihood
        return np.asarray(made / made.sum())

    def shifts(self, *, sized: bool = True) -> FloatArray:
        """Density over `SHIFTS` on the device, nothing known of the mounting; its sum is one."""
        made = self.likelihood.sum(axis=1) if sized else self._of_one_size
        return np.asarray(made / made.sum())

    def mountings(self, mounting: "Remounting") -> FloatArray:
        """Density over `SHIFTS` of how much the second mounting is turned from the first.

        p(m) ∝ p₀(m)·Σₕ πₕ·∫∫ L(m + x, a)·pₕ(x)·pₕ(a) over what may have become of the leg: x the
        shift of its curve, a its size; p₀ what is expected of the `mounting`, and all where the
        curves are not of one form.
        """
        prior = _normal(SHIFTS - mounting.expected, mounting.sd)
        if not self.is_one_form:
            return np.asarray(prior / prior.sum())
        size = _normal(SIZES, _SIZE_SD, _LOGS)
        sized = self.likelihood @ size
        one = self._of_one_size
        moves = _normal(SHIFTS[None, :] - SHIFTS[:, None], _SHIFT_SD)
        evidence = _NOTHING * one + _SIZED * sized + moves @ (_SHIFTED * one + _BOTH * sized)
        made = prior * evidence
        return np.asarray(made / made.sum())

    @property
    def _of_one_size(self) -> FloatArray:
        return self.likelihood[:, len(SIZES) // 2]


@dataclass(frozen=True, slots=True)
class Remounting:
    """What is expected of the second visit's mounting beside the first's, without the curves."""

    sd: float  #: By how much it is turned [deg], one standard deviation.
    expected: float = 0.0  #: By how much, as the zeros that were stated of both say [deg].

    @classmethod
    def of(cls, before: RelaxedCurve, after: RelaxedCurve, remounted: float) -> "Remounting":
        """Of two visits; `remounted` is of each, where no zero was stated better [deg]."""
        sds = (min(curve.zero_sd, remounted) for curve in (before, after))
        return cls(math.hypot(*sds), before.zero_deg - after.zero_deg)


def laid_pairs(
    before: RelaxedCurve, after: RelaxedCurve, *, remounted: float = REMOUNTED
) -> tuple[LegPairs, Alignment | None]:
    """Possible legs of two visits of a leg in pairs, the mounting as both curves tell it.

    Parameters
    ----------
    before, after : RelaxedCurve
        Of each visit.
    remounted : float
        By how much a foot is turned as it is mounted anew [deg], one standard deviation.

    Returns
    -------
    tuple of LegPairs and Alignment or None
        As of `paired_legs`, their zeros redrawn; and how well the curves lie upon each other, None
        where they overlap too little.
    """
    pairs = paired_legs(before, after, remounted=remounted)
    alignment = aligned(before, after, pairs)
    sds = [min(curve.zero_sd, remounted) for curve in (before, after)]
    mounting = Remounting.of(before, after, remounted)
    sd = mounting.sd
    if alignment is None or not sd > 0.0:
        return pairs, alignment
    n = len(pairs.before.zero)
    random = np.random.default_rng(_SEED)
    even = [random.permutation((np.arange(n) + 0.5) / n) for _ in range(3)]
    turned = quantiles_of(SHIFTS, alignment.mountings(mounting), even[0]) - mounting.expected
    both = sds[0] * sds[1] / sd * ndtri(even[1])
    lasting = math.sqrt(max(before.zero_sd**2 - sds[0] ** 2, 0.0)) * ndtri(even[2])
    other = math.sqrt(max(after.zero_sd**2 - sds[1] ** 2, 0.0)) * ndtri(even[2])
    first = lasting + both - (sds[0] / sd) ** 2 * turned
    second = other + both + (sds[1] / sd) ** 2 * turned
    pairs = replace(
        pairs,
        before=replace(pairs.before, zero=first),
        after=replace(pairs.after, zero=second),
    )
    return pairs, alignment


def quantiles_of(at: FloatArray, density: FloatArray, parts: FloatArray) -> FloatArray:
    """Where the parts of a density over an even grid lie, between its points."""
    return np.asarray(np.interp(parts, np.cumsum(density) - 0.5 * density, at))


def aligned(before: RelaxedCurve, after: RelaxedCurve, pairs: LegPairs) -> Alignment | None:
    """Lay both curves upon each other over what both rested at.

    Parameters
    ----------
    before, after : RelaxedCurve
        Of each visit.
    pairs : LegPairs
        Their possible legs.

    Returns
    -------
    Alignment or None
        None where they overlap too little.
    """
    low = max(before.low, after.low)
    degrees = np.arange(low, min(before.high, after.high), _STEP)
    if len(degrees) < _FEWEST:
        return None
    n = len(degrees)
    free = np.linalg.svd(np.eye(n) - 1.0 / n)[0][:, : n - 1].T  # without the zero of the torque
    sides = [side.scale[:, None] * side.weights for side in (pairs.before, pairs.after)]
    means = [side.mean(axis=0) for side in sides]
    p = len(means[0])
    whole = np.cov(np.hstack(sides).T)
    to = free @ after.basis.features(degrees)
    second = to @ means[1]
    within = to @ whole[p:, p:] @ to.T + _beyond(degrees, free, float(np.ptp(free.T @ second)))
    a = np.exp(SIZES)[:, None, None]
    logs = np.empty((len(SHIFTS), len(SIZES)))
    distance = np.empty_like(logs)
    for k, shift in enumerate(SHIFTS):
        at = np.clip(degrees - shift, before.low - BEYOND, before.high + BEYOND)
        laid = free @ before.basis.features(at)
        cross = laid @ whole[:p, p:] @ to.T
        covariance = within + a**2 * (laid @ whole[:p, :p] @ laid.T) - a * (cross + cross.T)
        left = second - a[:, 0] * (laid @ means[0])
        factor = np.linalg.cholesky(covariance)
        white = np.linalg.solve(factor, left[:, :, None])[:, :, 0]
        distance[k] = (white**2).sum(axis=1)
        logs[k] = -0.5 * distance[k] - np.log(np.einsum("kii->ki", factor)).sum(axis=1)
    best = np.unravel_index(np.argmax(logs), logs.shape)
    fits = float(gammaincc(0.5 * (n - 3), 0.5 * distance[best]))
    return Alignment(np.exp(logs - logs.max()), fits > _UNLIKE)


def _beyond(degrees: FloatArray, free: FloatArray, rise: float) -> FloatArray:
    """Covariance of what visits differ in beyond the equations [Nm²], along `free`."""
    apart = (degrees[:, None] - degrees[None, :]) / _ALIKE
    differs = _DIFFERS**2 * np.exp(-0.5 * apart**2) + _ROUGH**2 * np.eye(len(degrees))
    return np.asarray(max(rise, _FLAT) ** 2 * free @ differs @ free.T)


def _normal(at: FloatArray, sd: float, step: float = _DEGREES) -> FloatArray:
    """A normal density about 0 times the step of an even grid: over all of it the sum is one."""
    sd = max(sd, 0.5 * step)
    return np.asarray(step * np.exp(-0.5 * (at / sd) ** 2) / (sd * math.sqrt(2.0 * math.pi)))
