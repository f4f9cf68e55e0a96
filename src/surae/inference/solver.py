"""A problem solved by the estimator of its model: least squares, or the mode of a posterior."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from surae.base.progress import SearchProgress
from surae.effects import check_estimator
from surae.estimators import EstimatorOptions, LeastSquaresOptions, PosteriorOptions
from surae.inference.least_squares.fit import fit_problem
from surae.inference.least_squares.outliers import fit_robust
from surae.inference.least_squares.starts import Follow
from surae.inference.posterior.search import fit_family
from surae.inference.problem import FitProblem
from surae.inference.result import FitResult
from surae.model.jit import compile_all


@dataclass(frozen=True, slots=True)
class Estimator:
    """How problems are solved whose settings have options of one kind."""

    name: str  #: What it is called.
    options: type[EstimatorOptions]  #: What it is asked beside what every fit is.
    #: Solves a problem, given its options, `progress` and `follow`.
    fit: Callable[[FitProblem, Any, SearchProgress | None, Follow | None], FitResult]


def _least_squares(
    problem: FitProblem,
    options: LeastSquaresOptions,
    progress: SearchProgress | None,
    follow: Follow | None,
) -> FitResult:
    fit = fit_problem if options.loss is None else partial(fit_robust, loss=options.loss)
    seed = problem.settings.seed
    return fit(problem, starts=options.starts, seed=seed, progress=progress, follow=follow)


def _posterior(
    problem: FitProblem,
    _options: PosteriorOptions,
    progress: SearchProgress | None,
    follow: Follow | None,
) -> FitResult:
    return fit_family(problem, progress=progress, follow=follow)


#: Every estimator, by the type of its options.
ESTIMATORS = {
    each.options: each
    for each in (
        Estimator("least squares", LeastSquaresOptions, _least_squares),
        Estimator("posterior", PosteriorOptions, _posterior),
    )
}


def solve(
    problem: FitProblem,
    *,
    starts: int | None = None,
    progress: SearchProgress | None = None,
    follow: Follow | None = None,
) -> FitResult:
    """Find the best minimum of a problem, with the options and the seed of its settings.

    `starts` takes the place of the settings'; `progress` and `follow` are as of `fit_problem`, of a
    posterior as of `fit_family`. Ctrl-C keeps the best so far.

    Raises
    ------
    InputError
        `starts` are given of a posterior, which has its own.
    """
    compile_all()
    options: Any = problem.settings.estimator
    if starts is not None:
        check_estimator(problem.settings.model, ["starts"])
        options = replace(options, starts=starts)
    return ESTIMATORS[type(options)].fit(problem, options, progress, follow)
