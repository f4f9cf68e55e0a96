"""From a problem to its best minimum: projected starts, then all parameters together."""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.progress import SearchProgress
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.base.versions import versions
from surae.base.words import Message
from surae.estimators import STARTS
from surae.inference.interrupt import postponed_interrupt
from surae.inference.least_squares.drive_starts import own_columns
from surae.inference.least_squares.minimise import Ends, Minimum, Outcome, minimise
from surae.inference.least_squares.residuals import Residuals
from surae.inference.least_squares.starts import Follow, from_start, stopped
from surae.inference.problem import FitProblem
from surae.inference.result import FitResult, LeastSquares, Start, at_bounds

#: A sum below this part of the torque's own is an exact fit.
_EXACT = 1e-12
#: How often a search that is the best, and not yet at rest, goes on; the variances of the noise
#: that such a search must gain.
_CONTINUED = 3
_AT_REST = 1e-2


def fit_problem(
    problem: FitProblem,
    *,
    starts: int = STARTS,
    seed: int = 0,
    progress: SearchProgress | None = None,
    noise: float | None = None,
    follow: Follow | None = None,
) -> FitResult:
    """Find the parameters that bring the modelled torque closest to the measured one.

    The first of the `starts` is the problem's own, the others are random within the bounds by
    `seed`; `progress` hears of each. Priors are weighed against the torque's `noise` [Nm], by
    default what a fit without them leaves. `follow` hears of every better point: the model, which
    is a simpler one at first where the problem's has a parent, all its parameters, and the sum of
    squares. Ctrl-C keeps the best so far; its message says so.

    Raises
    ------
    InputError
        `starts` is less than 1.
    """
    if starts < 1:
        raise InputError(f"starts is {starts}; give at least 1")
    begin = time.perf_counter()
    if noise is None and problem.priors:
        plain = fit_problem(replace(problem, priors={}), starts=1, seed=seed)
        if plain.solution.is_interrupted:
            message = Message("ended/priors", message=plain.message)
            return replace(plain, problem=problem, message=message)
        noise = float(np.sqrt(plain.sse / (problem.n - len(problem.free))))
    residuals = Residuals(problem, noise or 0.0)
    minimum = from_start(problem, residuals, follow)
    minima: list[Minimum] = []
    initials = _initials(problem, starts, seed)
    with one_blas_thread(), postponed_interrupt():
        try:
            for number, initial in enumerate(initials):
                # The first start is where the user, or the literature, expects the lengths.
                minima.append(minimum(initial, number > 0))
                if minima[-1].outcome is Outcome.INTERRUPTED:
                    break
                if progress is not None:
                    progress(len(minima), starts, min(map(_finite_sum, minima)))
            # The best may be in the middle of a long flat valley: it goes on from there.
            best = min(range(len(minima)), key=lambda k: _finite_sum(minima[k]))
            for _ in range(_CONTINUED):
                if minima[best].outcome is not Outcome.ITERATIONS:
                    break
                minima[best] = minimise(
                    residuals.rows,
                    minima[best].x,
                    problem.lower,
                    problem.upper,
                    ends=Ends(stall=_AT_REST / problem.n),
                )
        except KeyboardInterrupt:
            if len(minima) == number:  # and not while the caller learnt of a whole start
                minima.append(stopped(problem, residuals, initial))
    result = _result(problem, residuals, initials, minima, seed)
    return replace(result, seconds=time.perf_counter() - begin)


def _finite_sum(minimum: Minimum) -> float:
    """A minimum's sum of squares, infinite where there is none."""
    return minimum.sse if np.isfinite(minimum.sse) else np.inf


def _initials(problem: FitProblem, starts: int, seed: int) -> list[FloatArray]:
    """The default start, then random ones, uniform within the bounds.

    Drives are drawn apart: everything else starts where a fit without them does.
    """
    rng = np.random.default_rng(seed)
    apart = np.random.default_rng([seed, 1])
    spread = problem.upper - problem.lower
    plain = len(own_columns(problem))
    random = [
        problem.lower
        + spread * np.concatenate([rng.random(plain), apart.random(len(spread) - plain)])
        for _ in range(starts - 1)
    ]
    return [problem.start, *random]


def _result(
    problem: FitProblem,
    residuals: Residuals,
    initials: Sequence[FloatArray],
    minima: Sequence[Minimum],
    seed: int,
) -> FitResult:
    """The best of the minima, in how many of them, and what each start came to."""
    best = min(minima, key=_finite_sum)
    # Sums that differ by less than the variance of the noise cannot be told apart by the data;
    # on data without noise, all that is left is rounding and how far the iteration went.
    power = sum(float(np.sum(r.torque**2)) for r in problem.inputs if r.torque is not None)
    limit = max(best.sse * (1 + 1 / (problem.n - len(problem.free))), _EXACT * power)
    # Of points that agree, one where the iteration came to rest is the better one.
    rested = [m for m in minima if m.sse <= limit and m.outcome is Outcome.CONVERGED]
    best = min(rested, key=_finite_sum, default=best)
    agreeing = sum(m.sse <= limit for m in minima)
    status, message = _status(problem, best, minima, agreeing, len(initials))
    left = residuals.of(best.x)
    last = minima[-1].outcome

    def of_free(x: FloatArray) -> dict[str, float]:
        return dict(zip(problem.free, x.tolist(), strict=True))

    return FitResult(
        problem=problem,
        status=status,
        message=message,
        values=problem.by_name(best.x),
        residuals=tuple(read_only(residual) for residual in left),
        sse=residuals.sse(left),
        R=read_only(best.R),
        solution=LeastSquares(
            starts=tuple(
                Start(of_free(initial), of_free(m.x), m.sse, str(m.outcome), m.iterations)
                for initial, m in zip(initials, minima, strict=False)
            ),
            agreeing=agreeing,
            stages=residuals.stages,
            outcome=str(last if last is Outcome.INTERRUPTED else best.outcome),
        ),
        seed=seed,
        seconds=0.0,
        versions=versions(),
    )


def _status(
    problem: FitProblem, best: Minimum, minima: Sequence[Minimum], agreeing: int, starts: int
) -> tuple[str, Message]:
    """Status and message of the best minimum."""
    alone = len(minima) > 1 and agreeing == 1
    message = Message("ended/one-start" if alone else "ended/starts", n=agreeing, all=len(minima))
    status = "converged"
    bound = at_bounds(problem, problem.by_name(best.x))
    if best.outcome is not Outcome.CONVERGED:
        status = "failed"
        why = best.outcome.name.lower().replace("_", "-")
        message = Message(f"ended/{why}", outcome=Message(str(best.outcome)))
    elif bound:
        status = "at-bounds"
        message = Message("ended/at-bound", message=message, names=", ".join(bound))
    if (within := minima[-1].outcome is Outcome.INTERRUPTED) or len(minima) < starts:
        where = "ended/stopped-in" if within else "ended/stopped-after"
        message = Message(where, message=message, n=len(minima), all=starts)
    return status, message
