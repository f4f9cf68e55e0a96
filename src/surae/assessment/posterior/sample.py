"""The posterior of a fit: what the recordings and prior knowledge say together of its parameters.

An interval from the covariance is that of a parabola, a profile follows the valley; the posterior
weighs the whole of it. It explores the valley of the fit's minimum: another one, far away, is for
the starts of the fit to find.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from surae.assessment.assess import described
from surae.assessment.posterior.chains import (
    EXACT,
    Convergence,
    convergence,
    require_sampler,
    run_chains,
    verdict,
)
from surae.assessment.posterior.density import SampledTarget, SamplingPrior, beliefs, make_target
from surae.assessment.posterior.of_family import FamilyTarget, family_target
from surae.assessment.uncertainty.covariance import Covariance, covariance, half_width
from surae.errors import InputError
from surae.estimation import FitResult
from surae.filed import filed
from surae.files import PathLike, write_atomic
from surae.frozen import Comparable, read_only
from surae.model import adapted
from surae.progress import Progress
from surae.records import to_plain
from surae.units import FloatArray
from surae.versions import versions

Status = Literal["converged", "not converged"]
#: Width of a posterior, as a part of its prior's, from which the data are said to add little.
_LITTLE = 0.7
#: Part of the steps to be accepted where gradients are only good to a percent: shorter steps would
#: not help.
_ROUGH = 0.6


@filed("name", "convergence")
@dataclass(frozen=True, slots=True)
class Marginal:
    """The posterior of one parameter."""

    #: `name`, `unit`: the parameter.
    name: str
    unit: str
    value: float  #: Estimate of the fit, which knows nothing of the wide defaults.
    median: float  #: Median of the draws.
    #: 95 % credible interval, its ends the 2.5 and 97.5 % quantiles of the draws.
    ci95: tuple[float, float]
    #: The 95 % interval of the covariance, widened as the posterior is; None where there is none.
    from_covariance: tuple[float, float] | None
    prior: SamplingPrior  #: What was known beforehand.
    #: Width of the posterior as a part of its prior's: near 1 the recordings added nothing.
    prior_part: float
    convergence: Convergence  #: Whether its draws can be believed.

    @property
    def of_prior(self) -> bool:
        """Whether the recordings add little to the prior."""
        return self.prior_part > _LITTLE

    @property
    def off_covariance(self) -> float | None:
        """How far the covariance's ends lie from the credible ones, in half-widths of these."""
        if self.from_covariance is None:
            return None
        ends = zip(self.ci95, self.from_covariance, strict=True)
        return 2 * max(abs(a - b) for a, b in ends) / (self.ci95[1] - self.ci95[0])


@filed(
    "names",
    "draws",
    "marginals",
    "covariance",
    "evaluations",
    "whole",
    inflation_reason="variance_inflation_reason",
)
@dataclass(frozen=True, slots=True, eq=False)
class Posterior(Comparable):
    """Draws from a posterior and what they say.

    Attributes
    ----------
    model : str
        Name of the model.
    names : tuple of str
        The free parameters.
    draws : ndarray, shape (chains, draws, p)
        Their values.
    marginals : mapping of str to Marginal
        By parameter.
    covariance : Covariance
        Of the fit, for comparison, widened by the variance inflation.
    status : {"converged", "not converged"}
        Whether the draws can be believed.
    message : str
        Why, with advice where they cannot.
    divergences : int
        Draws at which the sampler went astray: near them the posterior may be incomplete.
    evaluations : int
        Of the model and its Jacobian, without those of the tuning.
    variance_inflation : float
        By how much the variance of the noise counts more than that of white noise would.
    inflation_reason : str
        Why.
    seed, tune : int
        Of the sampler.
    seconds : float
        Wall time of the sampler.
    whole : bool
        False when the user stopped it before its end.
    versions : mapping of str to str
        Versions of surae, of the sampler and of what the numbers depend on.
    """

    model: str
    names: tuple[str, ...]
    draws: FloatArray
    marginals: Mapping[str, Marginal]
    covariance: Covariance
    status: Status
    message: str
    divergences: int
    evaluations: int
    variance_inflation: float
    inflation_reason: str
    seed: int
    tune: int
    seconds: float
    whole: bool
    versions: Mapping[str, str]

    def __getitem__(self, name: str) -> Marginal:
        return self.marginals[name]

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the draws, shape (p, p)."""
        flat = self.draws.reshape(-1, len(self.names))
        return np.atleast_2d(np.corrcoef(flat, rowvar=False))

    @property
    def noise(self) -> str:
        """What the noise was taken for, in a line."""
        return described({"all": self.variance_inflation}, self.inflation_reason)

    def of(self, name: str) -> FloatArray:
        """All draws of one parameter, chain after chain."""
        return self.draws[..., self.names.index(name)].ravel()

    def as_dict(self) -> dict[str, Any]:
        """The posterior as plain data, as it is saved."""
        return {
            "surae": self.versions["surae"],
            **to_plain(self),
            "parameters": {
                name: {**to_plain(marginal), **to_plain(marginal.convergence)}
                for name, marginal in self.marginals.items()
            },
            "correlation": {"names": list(self.names), "matrix": self.correlation.tolist()},
            "chains": self.draws.shape[0],
            "draws": self.draws.shape[1],
            "samples": {name: self.draws[..., j].tolist() for j, name in enumerate(self.names)},
        }

    def save(self, path: PathLike) -> None:
        """Write the posterior as JSON with all its draws, all of it or nothing.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        text = json.dumps(self.as_dict(), allow_nan=False, ensure_ascii=False)
        write_atomic(path, text + "\n")


def sample(
    result: FitResult,
    *,
    draws: int,
    tune: int,
    chains: int,
    seed: int = 0,
    priors: Mapping[str, tuple[float, float]] | None = None,
    variance_inflation: float = 1.0,
    inflation_reason: str = "",
    cores: int | None = None,
    progress: Progress | None = None,
) -> Posterior:
    """Draw from the posterior of a fit's free parameters.

    Fixed parameters stay fixed and weights hold; priors take the place of bounds: those of
    `priors`, else the fit's own, else the wide defaults of `beliefs`. Of a fit with `model="auto"`
    it is the posterior that was fitted, films included. Else the likelihood takes the noise for
    white; a residual that is correlated over time holds fewer independent samples than it
    has, so the variance of the noise counts `variance_inflation` times: n/n_effective is a rough
    value, the ratio of the squared standard errors with and without the correlation one for a
    parameter. All else is as of `surae.posterior`.
    """
    require_sampler()
    if not 0 < variance_inflation < np.inf:
        raise InputError(f"variance inflation is {variance_inflation!r}; give a number above zero")
    if not (np.isfinite(result.sse) and np.isfinite(result.R).all()):
        raise InputError("the fit failed without a finite torque: it has no posterior")
    if result.sse == 0:
        raise InputError("the fit leaves no residual: without noise there is no posterior")
    problem = result.problem
    target: SampledTarget | FamilyTarget
    if result.family is not None:
        target = family_target(result, priors or {}, variance_inflation)
        known = target.priors
    else:
        known = beliefs(problem, priors)
        target = make_target(result, known, variance_inflation)
    sampled = run_chains(
        target.density,
        len(target.root),
        draws=draws,
        tune=tune,
        chains=chains,
        seed=seed,
        cores=cores,
        progress=progress,
        accepted=_ROUGH if result.family is not None else EXACT,
    )
    values = read_only(target.parameters(sampled.draws))
    white = covariance(result.R, problem.free, result.sse, problem.n, result.bounded)
    wide = replace(
        white,
        matrix=variance_inflation * white.matrix,
        sigma2=variance_inflation * white.sigma2,
    )
    marginals = _marginals(result, values, known, wide)
    believed, message = verdict(
        {name: marginal.convergence for name, marginal in marginals.items()},
        sampled.diverging,
        values.shape[:2],
    )
    if not sampled.whole:
        message += "; stopped by the user"
    return Posterior(
        model=problem.spec.name,
        names=problem.free,
        draws=values,
        marginals=marginals,
        covariance=wide,
        status="converged" if believed else "not converged",
        message=message,
        divergences=sampled.diverging,
        evaluations=sampled.evaluations,
        variance_inflation=float(variance_inflation),
        inflation_reason=inflation_reason,
        seed=seed,
        tune=tune,
        seconds=sampled.seconds,
        whole=sampled.whole,
        versions=versions() | dict(sampled.versions),
    )


def _marginals(
    result: FitResult,
    values: FloatArray,
    known: Mapping[str, SamplingPrior],
    estimated: Covariance,
) -> dict[str, Marginal]:
    problem = result.problem
    table = adapted(problem.spec.parameters, problem.options, problem.inputs[0].emg_unit)
    half = {
        name: half_width(float(np.sqrt(variance)), estimated.dof)
        for name, variance in zip(estimated.names, np.diag(estimated.matrix), strict=True)
    }
    marginals = {}
    for j, name in enumerate(problem.free):
        drawn, prior, value = values[..., j], known[name], result.values[name]
        low, median, high = np.quantile(drawn, [0.025, 0.5, 0.975]).tolist()
        width = np.std(np.log(drawn) if prior.log else drawn)
        marginals[name] = Marginal(
            name=name,
            unit=table[name].unit,
            value=value,
            median=median,
            ci95=(low, high),
            from_covariance=(value - half[name], value + half[name]) if name in half else None,
            prior=prior,
            prior_part=float(width / prior.spread),
            convergence=convergence(drawn),
        )
    return marginals
