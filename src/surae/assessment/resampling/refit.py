"""Fits near a solution that is known."""

from surae.estimation import FitProblem
from surae.estimation.curved import curved_move
from surae.estimation.least_squares import Outcome, minimise
from surae.estimation.residuals import Residuals
from surae.units import FloatArray

#: Evaluations of one fit at most.
_EVALUATIONS = 60


def refit(
    problem: FitProblem, x: FloatArray, noise: float = 0.0, *, stall: float = 0.1
) -> FloatArray | None:
    """Minimum next to a point, from that point only.

    `noise` is the standard deviation [Nm] that priors are weighed against, `stall` the gain [noise
    variances] that is not worth another evaluation. None where the model gives no finite numbers.
    """
    minimum = minimise(
        Residuals(problem, noise).rows, x, problem.lower, problem.upper,
        move=curved_move(problem), max_iterations=_EVALUATIONS, stall=stall / problem.n,
    )  # fmt: skip
    if minimum.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    return None if minimum.outcome is Outcome.NOT_FINITE else minimum.x
