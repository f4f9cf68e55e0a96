"""Profile likelihood: how the best sum of squares grows as one parameter is held elsewhere.

An interval from the covariance is the one of a parabola. The profile asks the model itself: it
holds the parameter at value after value, minimises over all others, and takes as interval the
values at which the sum of squares rises by no more than the threshold (Venzon and Moolgavkar 1988;
Raue et al. 2009). It follows curved valleys, is not symmetric, and has an open end where the data
set no limit.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from surae.assessment.likelihood.conditional import Conditional, ConditionalPosterior
from surae.assessment.likelihood.search import ProfileSearch
from surae.errors import InputError
from surae.estimation import FitResult, fit_problem
from surae.estimation.family import resumed
from surae.estimation.least_squares import Outcome
from surae.filed import filed
from surae.frozen import Comparable, read_only
from surae.model import adapted
from surae.records import Listed
from surae.units import FloatArray

Status = Literal["closed", "open", "lower-minimum"]
Stopped = Callable[[], bool] | None
#: Makes what finds the minima with one parameter held, of its name.
Surface = Callable[[str, Stopped], Conditional | ConditionalPosterior]


@filed(
    "name",
    "path",
    "others",
    reasons="open",
    from_covariance="from_covariance",
    lower="lower_minimum",
    values="grid",
    chi2="delta_chi2",
    along="others",
)
@dataclass(frozen=True, slots=True, eq=False)
class ParameterProfile(Comparable):
    """Profile of one parameter."""

    #: `name`, `unit`: the parameter.
    name: str
    unit: str
    value: float  #: Estimate of the fit.
    #: Standard error from the covariance, widened as Δχ² is; None where there is none.
    sem: float | None
    values: Listed  #: Where the parameter was held, ascending, shape (k,).
    #: Least sum of squares there, weighted and with priors [Nm²], or −2 ln p of a posterior, (k,).
    sse: Listed
    chi2: Listed  #: Δχ²: (sse − lowest)/(σ²·variance_inflation), of −2 ln p without σ², (k,).
    others: tuple[str, ...]  #: The other free parameters.
    path: FloatArray  #: Their values along the profile, shape (k, len(others).
    variance_inflation: float  #: What the variance of the noise was multiplied by.
    threshold: float  #: Δχ² at the ends of the 95 % interval.
    #: Lower and upper end; None where that side is open.
    interval: tuple[float | None, float | None]
    reasons: tuple[str, str]  #: Why each end is open; empty where it is not.
    #: Whether both ends were found, and whether the profile met a lower minimum than the fit's.
    status: Status
    message: str  #: What a reader has to know.
    lower: Mapping[str, float] | None  #: Free parameters of the lower minimum.
    evaluations: int  #: Of the model and its Jacobian.

    @property
    def along(self) -> dict[str, list[float]]:
        """The other free parameters along the profile, by name."""
        return dict(zip(self.others, self.path.T.tolist(), strict=True))

    @property
    def from_covariance(self) -> tuple[float, float] | None:
        """The 95 % interval of the covariance, for comparison."""
        if self.sem is None:
            return None
        half = float(np.sqrt(self.threshold)) * self.sem
        return self.value - half, self.value + half


def profile(
    result: FitResult,
    name: str,
    *,
    variance_inflation: float = 1.0,
    over: Surface | None = None,
    stopped: Stopped = None,
) -> ParameterProfile:
    """Profile one parameter of a fit, from the minimum outwards to both sides.

    Of a fit with `model="auto"` it is the posterior's: with its films, priors, and all that differs
    from moment to moment. Δχ² is then that of −2 ln p.

    Every point starts from its neighbour, first on the way out, then again on the way in, and
    keeps the lower minimum, so that a valley which only shows from afar is not missed.

    Fixed parameters stay fixed, bounds and priors hold. `variance_inflation` is by how much the
    variance of the noise counts more than that of white noise would; it divides Δχ². A residual
    that is correlated over time holds fewer independent samples than it has: n/n_effective is a
    rough value, the ratio of the squared standard errors with and without the correlation one for
    this parameter. `over` is what `surface_of` makes of the fit; `stopped` ends the work with
    KeyboardInterrupt where it is True. The threshold is t²(0.975; n − p), which is F₁ and, for many
    samples, χ²₁(0.95) = 3.84: σ² is estimated from the residual, and where the model is linear the
    interval is that of the covariance.
    """
    check_profiled(result, name, variance_inflation)
    problem = result.problem
    table = adapted(problem.spec.parameters, problem.options, problem.inputs[0].emg_unit)
    minima = (surface_of(result) if over is None else over)(name, stopped)
    search = ProfileSearch(result, name, minima, variance_inflation)
    sse = np.array([point.sse for point in search.points])
    others = [i for i, free in enumerate(problem.free) if free != name]
    (low, why_low), (high, why_high) = search.ends
    status: Status = "open" if low is None or high is None else "closed"
    lower = None
    if search.lower is not None:
        lower = dict(zip(problem.free, search.lower.x.tolist(), strict=True))
        status = "lower-minimum"
    return ParameterProfile(
        name=name,
        unit=table[name].unit,
        value=result.values[name],
        sem=search.sem,
        values=read_only(np.array([point.value for point in search.points])),
        sse=read_only(sse),
        chi2=read_only((sse - sse.min()) / search.unit),
        others=tuple(problem.free[i] for i in others),
        path=read_only(np.array([point.x[others] for point in search.points])),
        variance_inflation=float(variance_inflation),
        threshold=search.threshold,
        interval=(low, high),
        reasons=(why_low, why_high),
        status=status,
        message=_message(name, search),
        lower=lower,
        evaluations=search.evaluations,
    )


def check_profiled(result: FitResult, name: str, variance_inflation: float = 1.0) -> None:
    """Refuse what has no profile; see `profile`.

    Raises
    ------
    InputError
        The parameter is unknown or fixed, or the variance inflation is no number above zero.
    """
    problem = result.problem
    if name not in problem.spec.names:
        raise InputError(
            f"model {problem.spec.name!r} has no parameter {name!r}; this fit estimated: "
            f"{', '.join(problem.free)}"
        )
    known = profiled(result)
    if name not in known:
        why = "is fixed in this fit" if name not in problem.free else "is another in each recording"
        raise InputError(
            f"{name} {why} and has no profile; fit again with it free, or choose from: "
            f"{', '.join(known)}"
        )
    if not 0 < variance_inflation < np.inf:
        raise InputError(f"variance inflation is {variance_inflation!r}; give a number above zero")
    if not (np.isfinite(result.sse) and np.isfinite(result.R).all()):
        raise InputError("the fit failed without a finite torque: there is nothing to profile")
    if result.sse == 0:
        raise InputError("the fit leaves no residual: without noise there is no interval")


def profiled(result: FitResult) -> tuple[str, ...]:
    """Parameters of a fit that have a profile: those that all its recordings share."""
    several = result.family is not None and result.family.zeros
    return tuple(n for n in result.problem.free if not (several and n == "torque_zero"))


def surface_of(result: FitResult) -> Surface:
    """What profiles of a fit go over: its sum of squares, or the posterior of its family."""
    if result.family is not None:
        return partial(ConditionalPosterior, *resumed(result))
    return partial(Conditional, result.problem, _prior_noise(result))


def _prior_noise(result: FitResult) -> float:
    """Standard deviation of the residual [Nm] that priors are weighed against, as in the fit."""
    problem = result.problem
    if not problem.priors:
        return 0.0
    plain = fit_problem(replace(problem, priors={}), starts=1)
    if plain.starts[-1].outcome == Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    return float(np.sqrt(plain.sse / (problem.n - len(problem.free))))


def _message(name: str, search: ProfileSearch) -> str:
    """What a reader has to know of a profile."""
    sentences = []
    if search.lower is not None:
        sentences.append(
            f"met a lower minimum than the fit's, at {name} = {search.lower.value:g} (Δχ² lower by "
            f"{search.lower_by:.2g}): fit again from there, or with more starts"
        )
    for side, (_, why) in zip(("downwards", "upwards"), search.ends, strict=True):
        if why:
            sentences.append(f"open {side}: {why}")
    inside = search.inside
    if inside[-1] - inside[0] + 1 > len(inside):
        sentences.append("Δχ² exceeds the threshold between the ends too: the region has parts")
    astray = sum(not point.converged for point in search.points)
    if astray:
        sentences.append(
            f"{astray} of {len(search.points)} points met the iteration limit: Δχ² there may be "
            "too high"
        )
    return "; ".join(sentences) or "both ends found"
