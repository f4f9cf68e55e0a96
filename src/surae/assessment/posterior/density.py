"""The posterior's density and gradient, in coordinates in which it is nearly a standard Gaussian.

Of a named model the noise is Gaussian and white, of unknown variance σ² with Jeffreys' prior
1/σ², which is integrated out: the likelihood is (sum of squares)^(−n/2). Where the model is linear
and the priors are wide, that makes the posterior of a parameter Student's t about the estimate,
with the standard error of equation (34). Parameters are on logarithmic scale, where their priors
are Gaussian; one that may be negative stays on its own.

Of a fit with `model="auto"` it is the posterior that was fitted, its latents integrated over
(Laplace), with its films and bounds.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr, ndtri

from surae.errors import InputError
from surae.estimation import FitProblem, FitResult
from surae.estimation.coordinates import is_straight
from surae.estimation.family import resumed
from surae.estimation.least_squares import minimise, sum_of_squares
from surae.estimation.population import checked_prior, wide_priors
from surae.estimation.residuals import Residuals
from surae.frozen import read_only
from surae.model import adapted
from surae.model.laboratory import laboratory
from surae.model.sources import Gaussian
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class SamplingPrior:
    """What is known of one parameter beforehand."""

    #: `median`, `spread`: median, and standard deviation of the logarithm; of the parameter itself,
    #: in its unit, where it may be negative.
    median: float
    spread: float
    log: bool  #: Whether it is on the logarithm.
    #: "population", "fit", "given": Whether it is a default, was a prior of the fit, or was given
    #: for the posterior.
    origin: str


def beliefs(
    problem: FitProblem, priors: Mapping[str, tuple[float, float]] | None = None
) -> dict[str, SamplingPrior]:
    """The prior of every free parameter: given now, else the fit's, else the wide default.

    `priors` holds (median, spread) by parameter.
    """
    table = adapted(problem.spec.parameters, problem.options, problem.inputs[0].emg_unit)
    wide = wide_priors(problem.options, problem.inputs[0].emg_unit)
    beliefs = {}
    for name in problem.free:
        p = table[name]
        if p.signed:
            # Its bounds as two standard deviations to either side.
            beliefs[name] = SamplingPrior((p.lower + p.upper) / 2, (p.upper - p.lower) / 4, False,
                                 "population")  # fmt: skip
        elif name in wide:
            beliefs[name] = SamplingPrior(*wide[name], True, "population")
        else:
            known = laboratory(joint=problem.options.anatomy)[name]
            beliefs[name] = _of_nuisance(known)
    for name, prior in problem.priors.items():
        beliefs[name] = SamplingPrior(prior.median, prior.spread, True, "fit")
    for name, pair in (priors or {}).items():
        prior = checked_prior(name, pair, problem.free)
        if table[name].signed:
            raise InputError(f"prior of {name}: it is on a logarithm, and {name} may be negative")
        beliefs[name] = SamplingPrior(prior.median, prior.spread, True, "given")
    return beliefs


def _of_nuisance(prior: Gaussian) -> SamplingPrior:
    """A nuisance's prior; on a logarithm where its mean is above zero."""
    if not prior.mean > 0.0:
        return SamplingPrior(prior.mean, prior.sd, False, "population")
    variance = float(np.log1p((prior.sd / prior.mean) ** 2))  # of the same mean and deviation
    median = prior.mean * float(np.exp(-0.5 * variance))
    return SamplingPrior(median, variance**0.5, True, "population")


#: Logarithm of a density, and its gradient; minus infinity where the model has no finite torque,
#: and where no prior reaches.
Density = Callable[[FloatArray], tuple[float, FloatArray]]

#: Nothing lies further than so many spreads from its prior; the mode is looked for from within
#: `_NEAR` of them.
FAR, _NEAR = 12.0, 3.0


@dataclass(frozen=True, slots=True)
class Target:
    """A posterior: what it is of, where and how wide it is.

    Its coordinates u are a standard Gaussian's as far as the Laplace approximation goes: t = L·u
    has the correlations of the posterior, and each element of t becomes a Gaussian of the mode and
    standard deviation of its coordinate, truncated at the bounds.
    """

    priors: Mapping[str, SamplingPrior]  #: Of every free parameter.
    mode: FloatArray  #: Where the density is highest, in the coordinates of the search, shape (q,).
    covariance: FloatArray  #: Of the Laplace approximation there, shape (q, q).
    #: `lower`, `upper`: bounds of the coordinates, shape (q,).
    lower: FloatArray
    upper: FloatArray
    #: Makes the density of the coordinates of the search, for use by one thread.
    density_of_search: Callable[[], Density]
    #: Parameters in their units, shape (p,), at coordinates of the search.
    natural: Callable[[FloatArray], FloatArray]
    #: Positions of a stiffness k and slack length x0 that trade off, and the longest muscle [m].
    valleys: tuple[tuple[int, int, float], ...] = ()

    def parameters(self, points: FloatArray) -> FloatArray:
        """Parameters in their units, shape (n, p), at coordinates u, shape (n, q)."""
        root = self._root()
        return np.array([self.natural(self._searched(root @ u)[0]) for u in points])

    def density(self) -> Density:
        """Log-posterior of the coordinates u, zero at the mode, for use by one thread."""
        inside, root = self.density_of_search(), self._root()
        top = inside(self.mode)[0]

        def log_posterior(u: FloatArray) -> tuple[float, FloatArray]:
            z, volume, slope, change = self._searched(root @ u)
            if not ((z >= self.lower) & (z <= self.upper)).all():
                return -np.inf, np.zeros_like(u)
            height, gradient = inside(z)
            return height - top + volume, root.T @ (change.T @ gradient + slope)

        return log_posterior

    def _root(self) -> FloatArray:
        sd = np.sqrt(np.diag(self.covariance))
        return np.asarray(np.linalg.cholesky(self.covariance / np.outer(sd, sd)))

    def _searched(self, t: FloatArray) -> tuple[FloatArray, float, FloatArray, FloatArray]:
        """Coordinates of the search, ln |dz/dt| but for a constant, its slope, and dz/dt."""
        sd = np.sqrt(np.diag(self.covariance))
        below = ndtr((self.lower - self.mode) / sd)
        beyond = ndtr((self.mode - self.upper) / sd)
        mass = 1.0 - below - beyond
        # each half from its own tail, which keeps its digits
        s = np.where(
            t < 0.0,
            ndtri(below + ndtr(np.minimum(t, 0.0)) * mass),
            -ndtri(beyond + ndtr(-np.maximum(t, 0.0)) * mass),
        )
        stretch = np.exp(0.5 * (s**2 - t**2)) * mass
        volume, slope = float(0.5 * np.sum(s**2 - t**2)), s * stretch - t
        d, change = sd * s, np.diag(sd * stretch)
        z = self.mode + d
        for k, x0, longest in self.valleys:  # k·(longest − x0) moves straight, as in the search
            reach, shrunk = longest - self.mode[x0], float(np.exp(-d[k]))
            away = reach * (1.0 + d[k]) - d[x0]
            z[x0] = longest - away * shrunk
            change[x0, k] = (away - reach) * shrunk * change[k, k]
            change[x0, x0] *= shrunk
            volume -= float(d[k])
            slope[k] -= change[k, k]
        return z, volume, slope, change


def make_target(
    result: FitResult,
    priors: Mapping[str, tuple[float, float]] | None = None,
    variance_inflation: float = 1.0,
) -> Target:
    """The posterior of a fit's parameters, its mode found from the fit's minimum.

    `priors` are (median, spread) by parameter, in place of the fit's own. `variance_inflation` is
    by how much the variance of the noise counts more than that of white noise would.
    """
    if result.family is not None:
        return _of_family(result, priors or {}, variance_inflation)
    return _of_model(result, beliefs(result.problem, priors), variance_inflation)


def _of_model(
    result: FitResult, priors: Mapping[str, SamplingPrior], variance_inflation: float
) -> Target:
    """Of a named model.

    The Laplace approximation takes the curvature as JᵀJ·n/sse plus that of the priors, so it has
    a width in the directions of which the recordings say nothing.
    """
    problem = result.problem
    known = [priors[name] for name in problem.free]
    log = np.array([belief.log for belief in known])
    centre = np.array([np.log(belief.median) if belief.log else belief.median for belief in known])
    spread = np.array([belief.spread for belief in known])
    samples = problem.n / variance_inflation
    residuals, p = Residuals(problem), len(known)
    weight = np.sqrt(samples / result.sse)

    def rows(scaled: FloatArray) -> FloatArray:
        x = _natural(scaled, log)
        with np.errstate(all="ignore"):
            data = residuals.data_rows(x) * weight
            data[:-1] *= np.where(log, x, 1.0)[:, None]
        away = ((scaled - centre) / spread)[None, :]
        return np.hstack([data, np.vstack([np.diag(1 / spread), away])])

    x = np.array([result.values[name] for name in problem.free])
    with np.errstate(divide="ignore"):  # a weight may be zero
        start = np.where(log, np.log(np.where(log, x, 1.0)), x)
    start = np.clip(start, centre - _NEAR * spread, centre + _NEAR * spread)
    lower, upper = centre - FAR * spread, centre + FAR * spread
    minimum = minimise(rows, start, lower, upper, stall=0.1 / samples)
    least = sum_of_squares(minimum.residual[:-p]) / weight**2
    if not (np.isfinite(minimum.R).all() and 0 < least < np.inf):
        raise InputError(
            "the model gives no finite torque where the priors allow: widen those of the "
            f"parameters that lie far from them, of {', '.join(problem.free)}"
        )

    def make_density() -> Density:
        residuals = Residuals(problem)

        def log_posterior(scaled: FloatArray) -> tuple[float, FloatArray]:
            away = (scaled - centre) / spread
            x = _natural(scaled, log)
            with np.errstate(all="ignore"):  # what is not finite is refused below
                rows = residuals.data_rows(x)
                sse = sum_of_squares(rows[-1])
                gradient = rows[:-1] @ rows[-1] * np.where(log, x, 1.0)
            if not (0 < sse < np.inf and np.isfinite(gradient).all()):
                return -np.inf, np.zeros_like(scaled)
            value = -0.5 * (samples * np.log(sse / least) + away @ away)
            return float(value), -samples / sse * gradient - away / spread

        return log_posterior

    root = np.linalg.inv(minimum.R)
    return Target(
        priors, read_only(minimum.x), read_only(root @ root.T), lower, upper, make_density,
        lambda z: _natural(z, log),
    )  # fmt: skip


def _natural(scaled: FloatArray, log: npt.NDArray[np.bool_]) -> FloatArray:
    """Parameters in their units from the scale on which they are sampled."""
    with np.errstate(over="ignore"):
        return np.where(log, np.exp(np.where(log, scaled, 0.0)), scaled)


def _of_family(
    result: FitResult, given: Mapping[str, tuple[float, float]], variance_inflation: float
) -> Target:
    """The posterior of a family's fit, under other priors of some parameters."""
    post, point = resumed(result)
    known = dict(post.priors)
    for name, pair in given.items():
        prior = checked_prior(name, pair, post.names)
        known[name] = (
            Gaussian(prior.median, prior.spread * prior.median)
            if is_straight(name)
            else Gaussian(float(np.log(prior.median)), prior.spread)
        )
    if given:
        names = [*post.names, *["torque_zero"] * post.zeros]
        mean = np.array([known[name].mean for name in names])
        weight = np.array([1.0 / known[name].sd for name in names])
        post = post.having(priors=known, mean=mean, weight=weight).apart()
        point = post.descend(point.z, point.c, point.w, evaluations=20, tolerance=1e-3)

    def make_density() -> Density:
        own = post.apart()

        def log_posterior(z: FloatArray) -> tuple[float, FloatArray]:
            try:
                blocks = own.blocks(z, *point.latents_at(z))
            except (FloatingPointError, np.linalg.LinAlgError):
                return -np.inf, np.zeros_like(z)
            # latents are within one step of their mode; their width changes the integral
            cost = sum(b.cost - b.latent_gain for b in blocks) / variance_inflation
            cost += sum(b.log_width for b in blocks)
            slope = own.reduced(blocks)[1] / variance_inflation + own.weight**2 * (z - own.mean)
            return -0.5 * (cost + own.prior_cost(z)), -slope

        return log_posterior

    priors = {}
    for name in post.problem.free:
        belief, straight = known[name], is_straight(name)
        origin = "given" if name in given else "population"
        if name not in given and name in (*post.problem.priors, *post.beliefs):
            origin = "fit"
        median = belief.mean if straight else float(np.exp(belief.mean))
        priors[name] = SamplingPrior(median, belief.sd, not straight, origin)
    H, _ = post.reduced(point.blocks)
    return Target(
        priors, read_only(point.z.copy()),
        read_only(np.linalg.inv(H / variance_inflation + np.diag(post.weight**2))),
        post.lower, post.upper, make_density,
        lambda z: np.asarray(post.values(z)[post.problem.columns]), tuple(post.valleys),
    )  # fmt: skip
