"""The posterior of a fit: what the recordings and prior knowledge say together of its parameters.

An interval from the covariance is that of a parabola, a profile follows the valley; the posterior
weighs the whole of it. It explores the valley of the fit's minimum: another one, far away, is for
the starts of the fit to find.
"""

import os
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.formatting import NO_NUMBER, significant
from surae.base.frozen import Comparable, read_only
from surae.base.progress import Progress
from surae.base.records import Saved
from surae.base.tables import Tabular, TextTable
from surae.base.units import FloatArray
from surae.base.versions import versions
from surae.inference import FitResult, LeastSquares
from surae.inference.judging.assessed import described
from surae.inference.uncertainty.arms_and_paths import ArmsAndPaths, arms_and_paths
from surae.inference.uncertainty.covariance import Covariance, covariance, half_width
from surae.model.prior import Prior
from surae.recording.frames import library
from surae.sampling.density import Target
from surae.sampling.importance import ENOUGH, Weighted, weighted_draws
from surae.sampling.profiles import open_ends

Status = Literal["reliable", "not reliable"]
#: Width of a posterior, as a part of its prior's, from which the data are said to add little.
_LITTLE = 0.7
#: Ends of intervals agree when they lie within this part of the credible interval's half-width;
#: with enough draws, chance moves them by less than a third of it.
_AGREE = 0.25
#: Proposals.
_ROUNDS = 6


@filed("name")
@dataclass(frozen=True, slots=True)
class Marginal:
    """The posterior of one parameter."""

    #: `name`, `unit`: the parameter.
    name: str
    unit: str
    value: float  #: Estimate of the fit, which knows nothing of the wide defaults.
    #: Median of the draws; None where they cannot be believed, which the posterior's message says.
    median: float | None
    #: 95 % credible interval, its ends the 2.5 and 97.5 % quantiles of the draws, or None likewise.
    ci95: tuple[float, float] | None
    #: The 95 % interval of the covariance, widened as the posterior is; None where there is none.
    from_covariance: tuple[float, float] | None
    prior: Prior  #: What was known beforehand.
    #: Width of the posterior as a part of its prior's: near 1 the recordings added nothing. None
    #: without an interval.
    prior_part: float | None

    @property
    def of_prior(self) -> bool:
        """Whether the recordings add little to the prior."""
        return self.prior_part is not None and self.prior_part > _LITTLE

    @property
    def off_covariance(self) -> float | None:
        """How far the covariance's ends lie from the credible ones, in half-widths of these."""
        if self.from_covariance is None or self.ci95 is None:
            return None
        ends = zip(self.ci95, self.from_covariance, strict=True)
        return 2 * max(abs(a - b) for a, b in ends) / (self.ci95[1] - self.ci95[0])


@filed(
    "names",
    "draws",
    "covariance",
    "evaluations",
    "whole",
    marginals="parameters",
    inflation_reason="variance_inflation_reason",
)
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Posterior(Tabular, Saved, Comparable):
    """Draws from a posterior and what they say."""

    model: str  #: Name of the model.
    names: tuple[str, ...]  #: The free parameters.
    #: Their values, of equal weight; some are there more than once. Shape (draws, p).
    draws: FloatArray
    marginals: Mapping[str, Marginal]  #: By parameter.
    covariance: Covariance  #: Of the fit, for comparison, widened by the variance inflation.
    status: Status  #: Whether the draws can be believed.
    message: str  #: Why, with advice where they cannot.
    #: Shape of the distribution of the largest importance weights: above 0.7 no number of draws
    #: would do. None where no weight is finite.
    k_hat: float | None
    effective: float  #: Independent draws that the weighted ones are worth.
    evaluations: int  #: Of the density.
    variance_inflation: float  #: How much more than of white noise the noise's variance counts.
    inflation_reason: str  #: Why.
    seed: int  #: Of the draws.
    seconds: float  #: Wall time.
    whole: bool  #: False when the user stopped it before its end.
    versions: Mapping[str, str]  #: Versions of surae and of what the numbers depend on.

    def __getitem__(self, name: str) -> Marginal:
        return self.marginals[name]

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the draws, shape (p, p)."""
        return np.atleast_2d(np.corrcoef(self.draws, rowvar=False))

    @property
    def noise(self) -> str:
        """What the noise was taken for, in a line."""
        return described({"all": self.variance_inflation}, self.inflation_reason)

    def as_table(self) -> TextTable:
        """The intervals of posterior and covariance beside each other, and whether they agree."""
        heads = ("parameter", "median", "95 % credible", "95 % covariance", "unit")
        rows = [
            (
                name,
                NO_NUMBER if m.median is None else significant(m.median, 4),
                open_ends(m.ci95),
                open_ends(m.from_covariance),
                m.unit,
            )
            for name, m in self.marginals.items()
        ]
        off = ((name, m.off_covariance) for name, m in self.marginals.items())
        known = {name: value for name, value in off if value is not None}
        apart = [f"{n} by {100 * value:.0f} %" for n, value in known.items() if value > _AGREE]
        notes = []
        if apart:
            notes.append(
                "other than the covariance (an end differs, in half-widths of the "
                f"credible interval): {', '.join(apart)}"
            )
        elif known:
            notes.append(f"as the covariance: all ends within {100 * _AGREE:.0f} % of a half-width")
        if prior := [name for name, m in self.marginals.items() if m.of_prior]:
            notes.append(f"mostly from the prior, the recordings add little: {', '.join(prior)}")
        end = f"{self.status}: {self.message} ({self.seconds:.1f} s)"
        return TextTable(heads, tuple(rows), below=(*notes, self.noise, end), numbers=heads[1:4])

    def of(self, name: str) -> FloatArray:
        """All draws of one parameter.

        Parameters
        ----------
        name : str
            Its name.

        Returns
        -------
        ndarray, shape (draws,)
            In its unit.
        """
        return self.draws[:, self.names.index(name)]

    def to_inference_data(self) -> Any:
        """The draws for ArviZ, with draws of their priors, units and the status as attributes.

        Returns
        -------
        xarray.DataTree or arviz.InferenceData
            As the installed ArviZ has it: groups ``posterior`` and ``prior`` by (chain, draw), and
            ``sample_stats``. Independent draws are dealt to four chains.

        Raises
        ------
        InputError
            The package xarray is not installed.
        """
        from surae.sampling import arviz_data

        xarray = library("xarray", "InferenceData")
        units = {name: self.marginals[name].unit for name in self.names}
        priors = {name: m.prior for name, m in self.marginals.items()}
        worth = {"k_hat": self.k_hat, "effective": self.effective}
        stats = {name: ((), value) for name, value in worth.items() if value is not None}
        groups = {
            "posterior": arviz_data.drawn(self.draws, units),
            "prior": arviz_data.prior_draws(priors, units, len(self.draws), self.seed),
            "sample_stats": xarray.Dataset(stats),
        }
        made_by = self.versions["surae"]
        return arviz_data.inference_data(groups, made_by, self.status, self.message)

    def as_dict(self) -> dict[str, Any]:
        """The posterior as plain data, as it is saved."""
        return {
            **Saved.as_dict(self),
            "correlation": {"names": list(self.names), "matrix": self.correlation.tolist()},
            "draws": len(self.draws),
            "samples": {name: self.of(name).tolist() for name in self.names},
        }


def sample(
    result: FitResult,
    *,
    draws: int,
    evaluations: int,
    seed: int = 0,
    priors: Mapping[str, tuple[float, float]] | None = None,
    variance_inflation: float = 1.0,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Posterior:
    """Draw from the posterior of a fit's free parameters.

    Fixed parameters stay fixed and weights hold. Priors take the place of bounds: those of
    `priors`, else the fit's own, else the wide defaults of `beliefs`. The likelihood takes the
    noise for white, its variance `variance_inflation` times what it is. All
    else is as of `surae.posterior`.
    """
    if not isinstance(result.solution, LeastSquares):
        raise InputError(
            "a fit of auto is a posterior already, of which `ci95` is the interval: profile the "
            "parameters to see more of it, or fit with a named model (model='muscle-tendon')"
        )
    if not 0 < variance_inflation < np.inf:
        raise InputError(f"variance inflation is {variance_inflation!r}; give a number above zero")
    if not (np.isfinite(result.sse) and np.isfinite(result.R).all()):
        raise InputError("the fit failed without a finite torque: it has no posterior")
    if result.sse == 0:
        raise InputError("the fit leaves no residual: without noise there is no posterior")
    begin = time.perf_counter()
    problem = result.problem
    target = Target(result, priors, variance_inflation)
    densities = [target.density() for _ in range(workers or os.cpu_count() or 1)]
    size = evaluations // _ROUNDS
    weighted = weighted_draws(
        densities, len(problem.free), rounds=_ROUNDS, size=size, seed=seed, progress=progress
    )
    points = weighted.resampled(draws, np.random.default_rng([seed, 1]))
    values = read_only(target.parameters(points))
    geometry = arms_and_paths(result)
    moved = values
    if geometry is not None:
        columns = geometry.legs(dict(zip(problem.free, values.T, strict=True)), seed)
        moved = read_only(np.stack(list(columns.values()), axis=1))
    reliable, message = _verdict(weighted)
    white = covariance(result.R, problem.free, result.sse, problem.n, result.bounded)
    matrix = variance_inflation * white.matrix
    sigma2 = variance_inflation * white.sigma2
    wide = replace(white, matrix=matrix, sigma2=sigma2)
    return Posterior(
        model=problem.spec.name,
        names=problem.free,
        draws=moved,
        marginals=_marginals(
            result, (values, moved) if reliable else None, target.priors, wide, geometry
        ),
        covariance=wide,
        status="reliable" if reliable else "not reliable",
        message=message,
        k_hat=weighted.k_hat if np.isfinite(weighted.k_hat) else None,
        effective=weighted.effective,
        evaluations=weighted.evaluations,
        variance_inflation=float(variance_inflation),
        inflation_reason="",
        seed=seed,
        seconds=time.perf_counter() - begin,
        whole=weighted.whole,
        versions=versions(),
    )


def _verdict(weighted: Weighted) -> tuple[bool, str]:
    """Whether draws can be believed, and a sentence that says why or what to do."""
    shape = f"k-hat of the weights {weighted.k_hat:.2f}"
    worth = f"{weighted.effective:.0f} effective draws"
    reliable = False
    text = f"{worth}, {shape}"
    if not weighted.k_hat <= weighted.limit:
        text = (
            f"the posterior is not near enough to a Gaussian ({shape}, at most "
            f"{weighted.limit:.2f} wanted): profile the parameters instead"
        )
    elif weighted.effective < ENOUGH:
        text = f"only {worth}, {ENOUGH} wanted: allow more evaluations, or profile the parameters"
    else:
        reliable = True
    return reliable, text if weighted.whole else f"{text}; stopped by the user"


def _marginals(
    result: FitResult,
    values: tuple[FloatArray, FloatArray] | None,
    known: Mapping[str, Prior],
    estimated: Covariance,
    geometry: ArmsAndPaths | None,
) -> dict[str, Marginal]:
    """What is known of each, of draws at the fit's arms and paths, and of such as may be."""
    problem = result.problem
    table = problem.table
    sems = dict(zip(estimated.names, np.sqrt(np.diag(estimated.matrix)).tolist(), strict=True))
    marginals = {}
    for j, name in enumerate(problem.free):
        prior = known[name]
        value = result.values[name]
        median = ci95 = part = around = None
        if name in sems:
            half = half_width(sems[name], estimated.dof)
            around = value - half, value + half
            if geometry is not None:
                low, high = geometry.about(name, around)
                around = (low or 0.0, high or 0.0)
        if values is not None:
            drawn = values[0][:, j]
            low, median, high = np.quantile(values[1][:, j], [0.025, 0.5, 0.975]).tolist()
            ci95 = low, high
            part = float(np.std(np.log(drawn) if prior.log else drawn) / prior.spread)
        marginals[name] = Marginal(
            name=name,
            unit=table[name].unit,
            value=value,
            median=median,
            ci95=ci95,
            from_covariance=around,
            prior=prior,
            prior_part=part,
        )
    return marginals
