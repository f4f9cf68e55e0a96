"""The posterior's density and gradient, in coordinates in which it is nearly a standard Gaussian.

The noise is Gaussian and white, of unknown variance σ² with Jeffreys' prior 1/σ², which is
integrated out: the likelihood is (sum of squares)^(−n/2). Where the model is linear and the priors
are wide, that makes the posterior of a parameter Student's t about the estimate, with the standard
error of equation (34). Parameters are on logarithmic scale, where their priors are Gaussian; one
that may be negative stays on its own.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.inference import FitProblem, FitResult
from surae.inference.least_squares.minimise import Ends, minimise, sum_of_squares
from surae.inference.least_squares.residuals import Residuals
from surae.inference.population_priors import checked_prior, wide_priors
from surae.model.laboratory import laboratory
from surae.model.prior import Prior
from surae.model.source import Gaussian
from surae.signals import emg_sizes


def beliefs(
    problem: FitProblem, priors: Mapping[str, tuple[float, float]] | None = None
) -> dict[str, Prior]:
    """The prior of every free parameter: given now (median, spread), else the fit's, else wide."""
    table = problem.table
    first = problem.inputs[0]
    wide = wide_priors(problem.options, first.emg_unit, emg_sizes(problem.inputs))
    known = {}
    for name in problem.free:
        p = table[name]
        source = "population"
        if p.signed:  # its bounds as two standard deviations to either side
            known[name] = Prior((p.lower + p.upper) / 2, (p.upper - p.lower) / 4, source, log=False)
        elif name in wide:
            known[name] = Prior(*wide[name], source)
        else:
            known[name] = _of_nuisance(laboratory(joint=problem.options.anatomy)[name], source)
    known |= {name: replace(prior, source="fit") for name, prior in problem.priors.items()}
    for name, pair in (priors or {}).items():
        known[name] = checked_prior(name, pair, problem.free, "given")
        if table[name].signed:
            raise InputError(f"prior of {name}: it is on a logarithm, and {name} may be negative")
    return known


def _of_nuisance(prior: Gaussian, source: str) -> Prior:
    """The prior of a nuisance, on a logarithm where its mean is above zero."""
    if not prior.mean > 0.0:
        return Prior(prior.mean, prior.sd, source, log=False)
    on_log = prior.on_logarithm()
    return Prior(float(np.exp(on_log.mean)), on_log.sd, source)


#: Logarithm of a density, and its gradient; minus infinity where the model has no finite torque.
Density = Callable[[FloatArray], tuple[float, FloatArray]]

#: Nothing lies further than `_FAR` spreads from its prior, where the model may overflow; the mode
#: is looked for from within `_NEAR` of them.
_FAR = 12.0
_NEAR = 3.0


class Target:
    """The posterior of a fit of a named model, its mode found from the fit's minimum.

    Its coordinates u are a standard Gaussian's as far as the Laplace approximation goes. That takes
    the curvature as JᵀJ·n/sse plus that of the priors, so it has a width in the directions of which
    the recordings say nothing. `given` are (median, spread) by parameter, in place of the fit's.
    """

    def __init__(
        self,
        result: FitResult,
        given: Mapping[str, tuple[float, float]] | None = None,
        variance_inflation: float = 1.0,
    ) -> None:
        self._problem = problem = result.problem
        self.priors = beliefs(problem, given)  #: Of every free parameter.
        known = self.priors.values()
        self._log = log = np.array([prior.log for prior in known])
        self._centre = centre = np.array([prior.centre for prior in known])
        self._spread = spread = np.array([prior.spread for prior in known])
        self._samples = problem.n / variance_inflation
        residuals = Residuals(problem)
        weight = np.sqrt(self._samples / result.sse)

        def rows(z: FloatArray) -> FloatArray:
            data = self._rows(residuals, z) * weight
            away = ((z - centre) / spread)[None, :]
            return np.hstack([data, np.vstack([np.diag(1 / spread), away])])

        x = np.array([result.values[name] for name in problem.free])
        with np.errstate(divide="ignore"):  # a weight may be zero
            start = np.where(log, np.log(np.where(log, x, 1.0)), x)
        start = np.clip(start, centre - _NEAR * spread, centre + _NEAR * spread)
        lower = centre - _FAR * spread
        upper = centre + _FAR * spread
        minimum = minimise(rows, start, lower, upper, ends=Ends(stall=0.1 / self._samples))
        self._least = sum_of_squares(minimum.residual[: -len(known)]) / weight**2
        if not (np.isfinite(minimum.R).all() and 0 < self._least < np.inf):
            raise InputError(
                "the model gives no finite torque where the priors allow: widen those of the "
                f"parameters that lie far from them, of {', '.join(problem.free)}"
            )
        self._mode, inverse = minimum.x, np.linalg.inv(minimum.R)
        #: Of the Laplace approximation, on the scale of the priors, shape (p, p).
        self.covariance = inverse @ inverse.T
        self._root = np.linalg.cholesky(self.covariance)

    def parameters(self, points: FloatArray) -> FloatArray:
        """Parameters in their units, shape (n, p), at coordinates u, shape (n, p)."""
        return self._natural(self._mode + points @ self._root.T)

    def density(self) -> Density:
        """Log-posterior of the coordinates u, but for a constant, for use by one thread."""
        residuals = Residuals(self._problem)

        def log_posterior(u: FloatArray) -> tuple[float, FloatArray]:
            z = self._mode + self._root @ u
            away = (z - self._centre) / self._spread
            if not np.abs(away).max() <= _FAR:
                return -np.inf, np.zeros_like(u)
            rows = self._rows(residuals, z)
            sse = sum_of_squares(rows[-1])
            with np.errstate(all="ignore"):  # what is not finite is refused below
                slope = rows[:-1] @ rows[-1]
            if not (0 < sse < np.inf and np.isfinite(slope).all()):
                return -np.inf, np.zeros_like(u)
            height = -0.5 * float(self._samples * np.log(sse / self._least) + away @ away)
            return height, self._root.T @ (-self._samples / sse * slope - away / self._spread)

        return log_posterior

    def _rows(self, residuals: Residuals, z: FloatArray) -> FloatArray:
        """Derivatives on the scale of the priors and, last, the residual."""
        x = self._natural(z)
        with np.errstate(all="ignore"):
            rows = residuals.data_rows(x)
            rows[:-1] *= np.where(self._log, x, 1.0)[:, None]
        return rows

    def _natural(self, z: FloatArray) -> FloatArray:
        """Parameters in their units from the scale on which their priors are Gaussian."""
        with np.errstate(over="ignore"):
            return np.where(self._log, np.exp(np.where(self._log, z, 0.0)), z)
