"""Variable projection: the parameters in which the torque is linear are solved, not searched.

Given k, tau_rel, k_rel, l0, f0 and beta, the torque of model 1.0 is linear in m, g1 … g4 and in
exp(−k·x0) of each muscle group: seven of the fifteen. A start needs the other eight only, and
the long valleys in which weights trade with filter and lengths are gone (Golub and Pereyra 1973).
Which parameters these are, each model's `ModelSpec` says.
"""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.inference.least_squares.minimise import (
    box_quadratic,
    column_norms,
    compress,
    sum_of_squares,
)
from surae.inference.problem import FitProblem

#: The rows of `Rows` (`minimise.py`), of those free parameters alone that are named.
SomeRows = Callable[[FloatArray, Sequence[int]], FloatArray]
_SCAN_POINTS = 5
#: Relative ridge that keeps the linear problem solvable when a channel is silent.
_RIDGE = 1e-10


def solve_linear(problem: FitProblem, rows: SomeRows, x: FloatArray) -> tuple[FloatArray, float]:
    """`x` with its linear parameters solved within the bounds, and the sum of squares there.

    Where the model gives no finite numbers it is `x` as it is, and the sum is infinite.
    """
    names = problem.free
    spec = problem.spec
    linear = [j for j, name in enumerate(names) if name in spec.linear or name in spec.slack]
    slack = {i: spec.slack[names[j]] for i, j in enumerate(linear) if names[j] in spec.slack}
    # From the greatest slack length on, passive torque only grows: at a small one it may be so
    # large that nothing else is left in the digits of the residual.
    base = x.copy()
    for i in slack:
        base[linear[i]] = problem.upper[linear[i]]
    basis = rows(base, linear)
    if not np.isfinite(basis).all():
        return x, np.inf
    if not linear:
        return x, sum_of_squares(basis[-1])
    low = (problem.lower - base)[linear]
    high = (problem.upper - base)[linear]
    stiffness = {}
    for i, k_name in slack.items():
        # The unknown is the factor s = exp(−k·(x0' − x0)) on the passive torque, which is −J/k;
        # s − 1 falls as x0' grows, so the bounds change places.
        k = stiffness[i] = problem.by_name(x)[k_name]
        basis[i] /= -k
        factor = np.array([-k * high[i], -k * low[i]])
        low[i], high[i] = np.expm1(np.minimum(np.maximum(factor, -700.0), 700.0))
    R, q, rest = compress(basis)
    norms = column_norms(R)
    scale = np.where(norms > 0, norms, 1.0)
    A = R / scale
    H = A.T @ A + _RIDGE * np.eye(len(linear))
    change = box_quadratic(H, A.T @ q, low * scale, high * scale)
    sse = sum_of_squares(A @ change + q) + rest
    change /= scale
    for i, k in stiffness.items():
        change[i] = -np.log1p(change[i]) / k
    base[linear] += change
    return np.minimum(np.maximum(base, problem.lower), problem.upper), sse


def scan_lengths(problem: FitProblem, rows: SomeRows, x: FloatArray) -> FloatArray:
    """The best of a coarse scan of the optimal lengths, linear parameters solved at each point.

    A start whose optimal length lies far outside the lengths the muscle reaches ends in a valley
    where f_l is little more than an exponential; a few evaluations along each length avoid it.
    """
    best = solve_linear(problem, rows, x)
    for j in (problem.free.index(name) for name in problem.spec.scanned if name in problem.free):
        lengths = np.linspace(problem.lower[j], problem.upper[j], _SCAN_POINTS + 2)[1:-1]
        best = best_along(problem, rows, best, j, lengths)
    return best[0]


def best_along(
    problem: FitProblem,
    rows: SomeRows,
    here: tuple[FloatArray, float],
    j: int,
    values: Iterable[float],
) -> tuple[FloatArray, float]:
    """A point and its sum of squares, or better ones with parameter j at one of the values."""
    solved = [here]
    for value in values:
        point = here[0].copy()
        point[j] = np.clip(value, problem.lower[j], problem.upper[j])
        solved.append(solve_linear(problem, rows, point))
    return min(solved, key=lambda each: each[1])
