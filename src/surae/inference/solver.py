"""A problem solved as its settings ask: least squares, or with outliers counting less."""

from functools import partial

from surae.base.errors import InputError
from surae.base.progress import SearchProgress
from surae.inference.least_squares.fit import fit_problem
from surae.inference.least_squares.outliers import fit_robust
from surae.inference.least_squares.starts import Follow
from surae.inference.posterior.search import fit_family
from surae.inference.problem import FitProblem
from surae.inference.result import FitResult
from surae.model.jit import compile_all
from surae.model.laboratory import AUTO


def solve(
    problem: FitProblem,
    *,
    starts: int | None = None,
    progress: SearchProgress | None = None,
    follow: Follow | None = None,
) -> FitResult:
    """Find the best minimum of a problem, with the loss, starts and seed of its settings.

    `starts` takes the place of the settings'; `progress` and `follow` are as of `fit_problem`.
    Ctrl-C keeps the best so far.

    Raises
    ------
    InputError
        A loss is asked for of no named model.
    """
    compile_all()
    settings = problem.settings
    if settings.model == AUTO:
        if settings.loss is not None:
            raise InputError(
                "a loss that spares outliers goes with a named model; give model='muscle' (--model "
                "muscle), or leave it out"
            )
        return fit_family(problem, progress=progress)
    count = settings.starts if starts is None else starts
    fit = fit_problem if settings.loss is None else partial(fit_robust, loss=settings.loss)
    return fit(problem, starts=count, seed=settings.seed, progress=progress, follow=follow)
