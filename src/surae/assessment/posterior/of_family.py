"""The posterior of a fit with `model="auto"` as a density: the one that was fitted, with its films.

Latents are eliminated at every point, as in the fit. Bounds are mirrors: what lies beyond stands
for what lies as far inside. Passive stiffness and slack length trade off along a curve: the data
know φ = k·reach, the reach from x0 to where the muscle is longest, so that a step is taken in φ.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.assessment.posterior.density import FAR, Density, SamplingPrior
from surae.estimation import FitResult
from surae.estimation.coordinates import is_straight
from surae.estimation.family import resumed
from surae.estimation.population import checked_prior
from surae.estimation.posterior import LogPosterior, Point
from surae.estimation.residuals import stiffness_valleys
from surae.frozen import read_only
from surae.model.laboratory import Gaussian
from surae.units import FloatArray

#: Growth of a stiffness, on its logarithm, from which on a step is no longer bent.
_MOST = 2.0


@dataclass(frozen=True, slots=True)
class _Valley:
    """A stiffness k and slack length x0 that trade off."""

    k: int  #: Position of k.
    x0: int  #: Of x0.
    reach: float  #: From x0 to where the data know the force best [m].
    longer: FloatArray  #: How it grows with the other coordinates, shape (q,).

    def bend(self, step: FloatArray) -> tuple[float, float, float]:
        """How x0 moves along a step; 1/growth of k; and how φ moves against k's part of it."""
        shrunk = float(np.exp(-min(step[self.k], _MOST)))
        more = float(self.longer @ step)
        away = self.reach * step[self.k] + more - step[self.x0]
        return self.reach + more - (self.reach + away) * shrunk, shrunk, away


@dataclass(frozen=True, slots=True)
class FamilyTarget:
    """The posterior of a family's fit, with its films; latents are eliminated at every point."""

    posterior: LogPosterior
    point: Point  #: Its mode.
    root: FloatArray  #: Root W of the Laplace approximation's covariance WWᵀ, shape (q, q).
    inflation: float  #: What the data's part of −2 ln p is divided by.
    valleys: tuple[_Valley, ...]
    given: frozenset[str]  #: Parameters whose priors were given for the posterior.

    @property
    def priors(self) -> dict[str, SamplingPrior]:
        """The prior of every free parameter."""
        known = {}
        post = self.posterior
        for name in post.problem.free:
            prior, straight = post.priors[name], is_straight(name)
            median = prior.mean if straight else float(np.exp(prior.mean))
            fitted = name in (*post.problem.priors, *post.beliefs)
            origin = "given" if name in self.given else "fit" if fitted else "population"
            known[name] = SamplingPrior(median, prior.sd, not straight, origin)
        return known

    def parameters(self, z: FloatArray) -> FloatArray:
        """Parameters in their units, shape (…, p), at whitened coordinates, shape (…, q)."""
        post = self.posterior
        flat = [
            post.values(self._within(row)[0])[post.problem.columns]
            for row in (z @ self.root.T).reshape(-1, z.shape[-1])
        ]
        return np.reshape(flat, (*z.shape[:-1], -1))

    def _within(self, step: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Where a step leads, mirrored at the bounds, and the signs of its derivatives."""
        post = self.posterior
        z = self.point.z + step
        for valley in self.valleys:
            z[valley.x0] = self.point.z[valley.x0] + valley.bend(step)[0]
        inside = np.where(z < post.lower, 2 * post.lower - z, z)
        inside = np.where(inside > post.upper, 2 * post.upper - inside, inside)
        return inside, np.where(inside == z, 1.0, -1.0)

    def _by_step(self, step: FloatArray, slope: FloatArray) -> tuple[FloatArray, float]:
        """The slope by a step of what has this slope where it leads, and ln of how it stretches."""
        volume = 0.0
        for valley in self.valleys:
            _, shrunk, away = valley.bend(step)
            by = slope[valley.x0]
            slope = slope + by * (1.0 - shrunk) * valley.longer
            slope[valley.x0] = by * shrunk
            slope[valley.k] += by * shrunk * away - 1.0
            volume -= float(step[valley.k])
        return slope, volume

    def density(self) -> Density:
        """Log-posterior of the whitened coordinates, for use by one thread."""
        post, point = self.posterior.apart(), self.point

        def log_posterior(u: FloatArray) -> tuple[float, FloatArray]:
            step = self.root @ u
            z, sign = self._within(step)
            away = post.weight * (z - post.mean)
            if not (np.abs(away).max() <= FAR and (z >= post.lower).all()):
                return -np.inf, np.zeros_like(u)
            try:
                blocks = post.blocks(z, *point.latents_at(z))
            except (FloatingPointError, np.linalg.LinAlgError):
                return -np.inf, np.zeros_like(u)
            cost = sum(b.cost - b.latent_gain for b in blocks) / self.inflation
            slope = post.reduced(blocks)[1] / self.inflation + post.weight * away
            slope, volume = self._by_step(step, -sign * slope)
            return volume - 0.5 * (cost + float(away @ away)), self.root.T @ slope

        return log_posterior


def family_target(
    result: FitResult, priors: Mapping[str, tuple[float, float]], variance_inflation: float = 1.0
) -> FamilyTarget:
    """The posterior of a family's fit, under other priors of some parameters."""
    post, point = resumed(result)
    known = dict(post.priors)
    for name, pair in priors.items():
        prior = checked_prior(name, pair, post.names)
        known[name] = (
            Gaussian(prior.median, prior.spread * prior.median)
            if is_straight(name)
            else Gaussian(float(np.log(prior.median)), prior.spread)
        )
    if priors:
        names = [*post.names, *["torque_zero"] * post.zeros]
        mean = np.array([known[name].mean for name in names])
        weight = np.array([1.0 / known[name].sd for name in names])
        post = post.having(priors=known, mean=mean, weight=weight).apart()
        point = post.descend(point.z, point.c, point.w, evaluations=20, tolerance=1e-3)
    H, _ = post.reduced(point.blocks)
    valleys = tuple(
        _Valley(k, x0, float(-h[k]), np.where(np.isin(np.arange(len(h)), (k, x0)), 0.0, -h))
        for k, x0 in _pairs(post)
        if (h := H[x0] / H[x0, x0])[k] < 0.0
    )
    H = H / variance_inflation + np.diag(post.weight**2)
    root = np.linalg.inv(np.linalg.cholesky(H)).T
    return FamilyTarget(
        post, point, read_only(root), variance_inflation, valleys, frozenset(priors)
    )


def _pairs(post: LogPosterior) -> list[tuple[int, int]]:
    return [
        (post.names.index(k), post.names.index(x0))
        for k, x0, _ in stiffness_valleys(post.problem)
        if {k, x0} <= {*post.names}
    ]
