"""The posterior's density and gradient, in coordinates in which it is nearly a standard Gaussian.

The noise is Gaussian and white, of unknown variance σ² with Jeffreys' prior 1/σ², which is
integrated out: the likelihood is (sum of squares)^(−n/2). Where the model is linear and the
priors are wide, that makes the posterior of a parameter Student's t about the estimate, with the
standard error of equation (34). Parameters are on logarithmic scale, where their priors are
Gaussian; one that may be negative stays on its own.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surae.errors import InputError
from surae.estimation import FitProblem, FitResult
from surae.estimation.least_squares import minimise, sum_of_squares
from surae.estimation.population import checked_prior, wide_priors
from surae.estimation.residuals import Residuals
from surae.frozen import read_only
from surae.model import adapted
from surae.model.laboratory import Gaussian, laboratory
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
class SampledTarget:
    """A posterior: what it is of, and where and how wide it is."""

    problem: FitProblem  #: The question.
    log: npt.NDArray[np.bool_]  #: Which parameters are on logarithmic scale, shape (p,).
    #: `centre`, `spread`: mean and standard deviation of the priors, on the scale of each
    #: parameter, shape (p,).
    centre: FloatArray
    spread: FloatArray
    samples: float  #: Independent samples, n over the variance inflation.
    mode: FloatArray  #: Where the density is highest, on the scale of each parameter, shape (p,).
    sse: float  #: Sum of squares there [Nm²].
    root: FloatArray  #: Root W of the Laplace approximation's covariance WWᵀ, shape (p, p).

    def parameters(self, z: FloatArray) -> FloatArray:
        """Parameters in their units, shape (…, p), at whitened coordinates of the same shape."""
        return _natural(self.mode + z @ self.root.T, self.log)

    def density(self) -> Density:
        """Log-posterior of the whitened coordinates, for use by one thread."""
        residuals = Residuals(self.problem)

        def log_posterior(z: FloatArray) -> tuple[float, FloatArray]:
            scaled = self.mode + self.root @ z
            away = (scaled - self.centre) / self.spread
            if not np.abs(away).max() <= FAR:
                return -np.inf, np.zeros_like(z)
            x = _natural(scaled, self.log)
            with np.errstate(all="ignore"):  # what is not finite is refused below
                rows = residuals.data_rows(x)
                sse = sum_of_squares(rows[-1])
                gradient = rows[:-1] @ rows[-1] * np.where(self.log, x, 1.0)
            if not (0 < sse < np.inf and np.isfinite(gradient).all()):
                return -np.inf, np.zeros_like(z)
            value = -0.5 * (self.samples * np.log(sse / self.sse) + away @ away)
            slope = -self.samples / sse * gradient - away / self.spread
            return float(value), self.root.T @ slope

        return log_posterior


def make_target(
    result: FitResult, priors: Mapping[str, SamplingPrior], variance_inflation: float = 1.0
) -> SampledTarget:
    """The posterior of a fit's parameters, its mode found from the fit's minimum.

    The Laplace approximation takes the curvature as JᵀJ·n/sse plus that of the priors, so it has
    a width in the directions of which the recordings say nothing.

    `variance_inflation` is by how much the variance of the noise counts more than that of white
    noise would.
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
    minimum = minimise(
        rows, start, centre - FAR * spread, centre + FAR * spread, stall=0.1 / samples
    )
    sse = sum_of_squares(minimum.residual[:-p]) / weight**2
    if not (np.isfinite(minimum.R).all() and 0 < sse < np.inf):
        raise InputError(
            "the model gives no finite torque where the priors allow: widen those of the "
            f"parameters that lie far from them, of {', '.join(problem.free)}"
        )
    return SampledTarget(
        problem=problem,
        log=log,
        centre=read_only(centre),
        spread=read_only(spread),
        samples=samples,
        mode=read_only(minimum.x),
        sse=sse,
        root=read_only(np.linalg.inv(minimum.R)),
    )


def _natural(scaled: FloatArray, log: npt.NDArray[np.bool_]) -> FloatArray:
    """Parameters in their units from the scale on which they are sampled."""
    with np.errstate(over="ignore"):
        return np.where(log, np.exp(np.where(log, scaled, 0.0)), scaled)
