"""Draws from a density by adaptive importance sampling, and how far they can be believed.

Proposals are Student's t. The first is about the mode with the covariance there (Laplace). Each
next one has the curvature that the gradients at all draws so far show over the width of the
posterior, which kinks make another than at the mode: a regression of gradients on draws, as in
score matching (Hyvärinen 2005), their weights tempered while few of them count (population Monte
Carlo, Cappé, Guillin, Marin and Robert 2004). Every draw is weighed against the mixture of all
proposals (Cornuet, Marin, Mira and Robert 2012), and the largest weights are smoothed by a
generalised Pareto distribution, whose shape k̂ says whether the weights have a mean that draws can
estimate (Vehtari, Simpson, Gelman, Yao and Gabry, Pareto smoothed importance sampling, JMLR 25,
2024).
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import gammaln, logsumexp

from surae.base.progress import Progress
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.sampling.density import Density

#: Degrees of freedom of the proposals, and the part of the draws from each: heavy tails show what a
#: proposal is too narrow for, but in many dimensions few of their draws count.
_TAILS = np.array([30.0, 3.0])
_PARTS = np.array([0.75, 0.25])
#: Effective draws for each coordinate that a proposal rests on, the part of them that the curvature
#: at the mode counts for, and limits of the curvature in units of it.
_TEMPERED = 3.0
_BELIEVED = 0.05
_CURVATURES = (0.2, 20.0)
#: Shape from which weights are not believed, and effective draws below which quantiles are not.
K_HAT = 0.7
ENOUGH = 200
#: Draws below which nothing is kept of what the user stops.
_FEWEST = 50
#: Draws between two looks at the progress.
_BATCH = 20


@dataclass(frozen=True, slots=True)
class Weighted:
    """Draws with their weights."""

    points: FloatArray  #: Coordinates, shape (n, q); those without a density are left out.
    weights: FloatArray  #: Smoothed; their sum is 1, shape (n,).
    k_hat: float  #: Shape of the largest weights' distribution; infinite where none is finite.
    #: Independent draws that the weighted ones are worth.
    effective: float
    evaluations: int  #: Of the density.
    whole: bool  #: False when the user stopped it before its end.

    @property
    def limit(self) -> float:
        """Shape up to which so many draws can be believed."""
        return min(1.0 - 1.0 / float(np.log10(max(len(self.weights), 20))), K_HAT)

    def resampled(self, draws: int, rng: np.random.Generator) -> FloatArray:
        """Draws of equal weight, shape (draws, q); systematic, in random order."""
        ends = np.cumsum(self.weights)
        at = np.searchsorted(ends / ends[-1], (np.arange(draws) + rng.uniform()) / draws)
        return np.asarray(self.points[rng.permutation(at)])


def weighted_draws(
    densities: Sequence[Density],
    q: int,
    *,
    rounds: int,
    size: int,
    seed: int,
    progress: Progress | None = None,
) -> Weighted:
    """Draw in rounds of `size`, each from a proposal that those before have adapted.

    In its coordinates the density is about a standard Gaussian; each of `densities` is the same one
    for another thread, how many does not matter. Ctrl-C keeps the draws so far, if there are some.
    """
    rng = np.random.default_rng(seed)
    mean = np.zeros(q)
    root = np.eye(q)
    points = np.zeros((0, q))
    heights = np.zeros(0)
    slopes = np.zeros((0, q))
    proposals: list[tuple[int, FloatArray, FloatArray]] = []
    weighted: Weighted | None = None
    for number in range(rounds):
        tails = rng.choice(_TAILS, (size, 1), p=_PARTS)
        normal = rng.standard_normal((size, q)) / np.sqrt(rng.chisquare(tails) / tails)
        drawn = mean + normal @ root.T
        values, whole = _evaluated(densities, drawn, progress, (number * size, rounds * size))
        points = np.concatenate([points, drawn[: len(values)]])
        heights = np.concatenate([heights, [height for height, _ in values]])
        slopes = np.concatenate([slopes, np.reshape([slope for _, slope in values], (-1, q))])
        if values:
            proposals.append((len(values), mean, root))
        if not whole and len(points) < max(2 * q, _FEWEST):
            raise KeyboardInterrupt
        logs = heights - logsumexp(
            [np.log(n) + _proposed(points, *at) for n, *at in proposals], axis=0
        )
        weighted = _smoothed(points, logs, whole=whole)
        if not whole or not weighted.effective:
            break
        mean, root = _adapted(points, slopes, logs)
    assert weighted is not None
    return weighted


def _evaluated(
    densities: Sequence[Density],
    drawn: FloatArray,
    progress: Progress | None,
    done: tuple[int, int],
) -> tuple[list[tuple[float, FloatArray]], bool]:
    """The density and its gradient at draws, and whether the user let it come to its end."""
    values: list[tuple[float, FloatArray]] = []
    parts = len(densities)
    with one_blas_thread(), ThreadPoolExecutor(parts) as pool:
        try:
            for at in range(0, len(drawn), _BATCH):
                batch = drawn[at : at + _BATCH]
                shares = [batch[i::parts] for i in range(parts)]
                each = list(pool.map(lambda f, rows: [f(u) for u in rows], densities, shares))
                values += [each[i % parts][i // parts] for i in range(len(batch))]
                if progress is not None:
                    progress(done[0] + len(values), done[1])
        except KeyboardInterrupt:
            return values, False
    return values, True


def _proposed(points: FloatArray, mean: FloatArray, root: FloatArray) -> FloatArray:
    """Logarithm of a proposal's density, but for a constant, shape (n,)."""
    q = len(root)
    squares = np.sum(solve_triangular(root, (points - mean).T, lower=True) ** 2, axis=0)
    logs = [
        np.log(part)
        + gammaln((tail + q) / 2)
        - gammaln(tail / 2)
        - q / 2 * np.log(tail)
        - (tail + q) / 2 * np.log1p(squares / tail)
        for tail, part in zip(_TAILS, _PARTS, strict=True)
    ]
    return np.asarray(logsumexp(logs, axis=0) - np.log(np.diag(root)).sum())


def _smoothed(points: FloatArray, logs: FloatArray, *, whole: bool) -> Weighted:
    """Draws with smoothed weights; those at which there is no density are left out."""
    from arviz_stats.base import array_stats

    some = np.isfinite(logs)
    if some.sum() < _BATCH:
        even = np.full(len(points), 1.0 / len(points))
        return Weighted(points, even, np.inf, 0.0, len(points), whole)
    smooth, k = array_stats.psislw(-logs[some])  # it asks for the logarithms of 1/weight
    weights = np.exp(smooth - logsumexp(smooth))
    k_hat = float(k) if np.isfinite(k) else np.inf
    effective = float(1.0 / np.sum(weights**2))
    return Weighted(points[some], weights, k_hat, effective, len(points), whole)


def _adapted(
    points: FloatArray, slopes: FloatArray, logs: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Mean and root of the covariance of the next proposal."""
    some = np.isfinite(logs)
    points = points[some]
    slopes = slopes[some]
    logs = logs[some] - logs[some].max()
    q = points.shape[1]
    low = 1e-6
    high = 1.0
    for _ in range(20):
        power = 0.5 * (low + high)
        weights = np.exp(power * logs)
        enough = weights.sum() ** 2 / np.sum(weights**2) >= _TEMPERED * q
        low, high = (power, high) if enough else (low, power)
    weights = np.exp(low * logs)
    weights /= weights.sum()
    mean = weights @ points
    slope = weights @ slopes
    away = (points - mean) * weights[:, None]
    curvature = np.linalg.solve(
        away.T @ (points - mean) + _BELIEVED * np.eye(q),
        _BELIEVED * np.eye(q) - away.T @ (slopes - slope),
    )
    values, vectors = np.linalg.eigh(0.5 * (curvature + curvature.T))
    covariance = vectors / np.clip(values, *_CURVATURES) @ vectors.T
    return mean + covariance @ slope, np.linalg.cholesky(covariance)
