"""Fits near a solution that is known, many of them, in threads: the kernels release the GIL."""

import threading
from collections.abc import Callable, Iterable
from contextlib import nullcontext
from typing import TypeVar

from surae.errors import InputError
from surae.estimation import FitProblem
from surae.estimation.curved import curved_move
from surae.estimation.interrupt import postponed_interrupt
from surae.estimation.least_squares import Outcome, minimise
from surae.estimation.residuals import Residuals
from surae.threads import one_blas_thread
from surae.units import FloatArray

Item = TypeVar("Item")
Found = TypeVar("Found")

#: Evaluations of one fit at most.
_EVALUATIONS = 60


def refit(
    problem: FitProblem, x: FloatArray, noise: float = 0.0, *, stall: float = 0.1
) -> FloatArray | None:
    """Minimum next to a point, from that point only.

    Parameters
    ----------
    problem : FitProblem
        The problem.
    x : ndarray, shape (p,)
        Free parameters of the minimum of a problem like it.
    noise : float
        Standard deviation [Nm] that priors are weighed against.
    stall : float
        Gain [noise variances] that is not worth another evaluation.

    Returns
    -------
    ndarray, shape (p,), or None
        None where the model gives no finite numbers.
    """
    found = minimise(
        Residuals(problem, noise).rows, x, problem.lower, problem.upper,
        move=curved_move(problem), max_iterations=_EVALUATIONS, stall=stall / problem.n,
    )  # fmt: skip
    if found.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    return None if found.outcome is Outcome.NOT_FINITE else found.x


def in_threads(
    work: Callable[[Item], Found],
    items: Iterable[Item],
    workers: int | None,
    take: Callable[[Found], None],
) -> None:
    """Do independent pieces of work and hand over what they give, as it comes.

    Parameters
    ----------
    work : callable
        One piece; its result must not depend on the others.
    items : iterable
        What to work on.
    workers : int or None
        Threads; None: one for each processor.
    take : callable
        Called with every result, in this thread. Ctrl-C ends the work early, without an error:
        whoever takes counts what came.
    """
    from joblib import Parallel, cpu_count, delayed

    if workers is not None and workers < 1:
        raise InputError(f"workers is {workers}; give at least 1")
    threads, stop = workers or cpu_count(), threading.Event()

    def one(item: Item) -> Found | None:
        if stop.is_set():
            return None
        try:
            return work(item)
        except KeyboardInterrupt:
            stop.set()
            return None

    # A single worker is the main thread, where Ctrl-C must not come within compiled code; several
    # are not, and the main thread, which only waits, tells them to stop.
    patience = postponed_interrupt() if threads == 1 else nullcontext()
    with one_blas_thread(), patience:
        try:
            pool = Parallel(n_jobs=threads, backend="threading", return_as="generator_unordered")
            for found in pool(delayed(one)(item) for item in items):
                if found is not None:
                    take(found)
        except KeyboardInterrupt:
            stop.set()
