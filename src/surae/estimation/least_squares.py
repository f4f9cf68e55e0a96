"""Non-linear least squares within bounds: Levenberg–Marquardt on the compressed Jacobian."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.linalg.lapack import dgeqrf

from surae.estimation.box import box_quadratic
from surae.units import FloatArray

#: Relative ridge under which the undamped step is judged.
_RIDGE = 1e-12
#: How a point moves along a step; beyond first order it is free to follow the problem's curves.
Move = Callable[[FloatArray, FloatArray], FloatArray]
#: A function of the parameters that returns the (p + 1, n) rows of the Jacobian and, last, the
#: residual. It may be overwritten.
Rows = Callable[[FloatArray], FloatArray]


class Outcome(StrEnum):
    """Why the iteration ended."""

    CONVERGED = "converged"
    ITERATIONS = "iteration limit"
    NOT_FINITE = "not finite at the start"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True, slots=True)
class Minimum:
    """Where an iteration ended.

    Attributes
    ----------
    x : ndarray, shape (p,)
        Parameters.
    sse : float
        Sum of squared residuals.
    residual : ndarray, shape (n,)
        Residual at `x`.
    R : ndarray, shape (p, p)
        Triangular factor of the Jacobian at `x`: RᵀR = JᵀJ.
    outcome : Outcome
        Why it ended.
    iterations : int
        Evaluations of the residual and its Jacobian.
    """

    x: FloatArray
    sse: float
    residual: FloatArray
    R: FloatArray
    outcome: Outcome
    iterations: int


def compress(rows: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """R of the Jacobian and Qᵀ·residual: all that a step needs, p × p instead of n × p.

    Parameters
    ----------
    rows : ndarray, shape (p + 1, n)
        Jacobian rows and the residual; overwritten.

    Returns
    -------
    R : ndarray, shape (p, p)
        Upper triangular factor.
    q : ndarray, shape (p,)
        Projection of the residual on the Jacobian's columns.
    rest : float
        Sum of squares of the residual that no combination of the columns can take away.
    """
    p, n = rows.shape[0] - 1, rows.shape[1]
    factored = dgeqrf(rows.T, lwork=64 * (p + 1), overwrite_a=True)[0]
    full = np.zeros((p + 1, p + 1))
    full[: min(p + 1, n)] = np.triu(factored[: p + 1])
    return full[:p, :p], full[:p, p], float(full[p, p] ** 2)


def minimise(
    rows: Rows,
    x: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    *,
    move: Move = np.add,
    max_iterations: int = 200,
    ftol: float = 1e-8,
    xtol: float = 1e-10,
    gtol: float = 1e-10,
    stall: float | None = None,
) -> Minimum:
    """Minimise the sum of squared residuals within bounds.

    Each step solves the damped linear problem exactly within the bounds (`box_quadratic`), so a
    parameter slides along its bound and leaves it again without shrinking the step of the others.
    Damping is relative to the largest norm that each Jacobian column has had, which makes the
    path independent of the parameters' units (Moré 1978), and follows the gain of each step
    (Nielsen 1999).

    Parameters
    ----------
    rows : callable
        Gives the (p + 1, n) Jacobian rows and residual at a point.
    x : ndarray, shape (p,)
        Start, within the bounds.
    lower, upper : ndarray, shape (p,)
        Bounds.
    move : callable, optional
        How a point moves along a step; straight by default.
    max_iterations : int
        Limit on evaluations.
    ftol, xtol, gtol : float
        Converged when the undamped step is predicted to lower the sum by less than `ftol` of
        itself, or a step changes no parameter by more than `xtol` of its size, or the cosine
        between residual and every column that is free to move is at most `gtol`.
    stall : float, optional
        Takes the place of `ftol` after a step that failed. The torque has kinks, where tissue
        goes slack (11), and closer to the minimum than a small part of the noise the quadratic
        prediction does not hold: more steps would only chase kinks.

    Returns
    -------
    Minimum
        Where it ended; Ctrl-C returns the best point so far.

    References
    ----------
    Moré, The Levenberg–Marquardt algorithm (1978); Nielsen, Damping parameter in Marquardt's
    method, IMM-REP-1999-05 (1999).
    """
    stall = ftol if stall is None else stall
    x = np.clip(x, lower, upper)
    current = rows(x)
    count = 1
    residual = current[-1].copy()
    sse = float(residual @ residual)
    R, q, _ = compress(current)
    if not (np.isfinite(sse) and np.isfinite(R).all()):
        return Minimum(x, sse, residual, R, Outcome.NOT_FINITE, count)
    norms = column_norms(R)
    damping, growth = 1e-3, 2.0
    outcome = Outcome.ITERATIONS
    try:
        while count < max_iterations:
            norms = np.maximum(norms, column_norms(R))
            scale = np.where(norms > 0, norms, 1.0)
            g = (R.T @ q) / scale
            if _stationary(g, x, lower, upper, gtol * np.sqrt(sse)):
                outcome = Outcome.CONVERGED
                break
            A = R / scale
            H = A.T @ A
            room = (lower - x) * scale, (upper - x) * scale
            undamped = _gain(H, g, box_quadratic(H + _RIDGE * np.eye(len(x)), g, *room))
            if undamped <= (stall if growth > 2.0 else ftol) * sse:
                outcome = Outcome.CONVERGED
                break
            d = box_quadratic(H + damping * np.eye(len(x)), g, *room)
            predicted = _gain(H, g, d)
            step = d / scale
            if np.all(np.abs(step) <= xtol * (np.abs(x) + xtol)):
                outcome = Outcome.CONVERGED
                break
            trial = np.clip(move(x, step), lower, upper)
            current = rows(trial)
            count += 1
            trial_sse = float(current[-1] @ current[-1])
            gain = (sse - trial_sse) / predicted if np.isfinite(trial_sse) else -1.0
            if gain > 1e-4 and np.isfinite(current).all():
                x, sse, residual = trial, trial_sse, current[-1].copy()
                R, q, _ = compress(current)
                damping = max(damping * max(1 / 10, 1 - (2 * gain - 1) ** 3), 1e-15)
                growth = 2.0
            else:
                damping *= growth
                growth *= 2.0
    except KeyboardInterrupt:
        outcome = Outcome.INTERRUPTED
    return Minimum(x, sse, residual, R, outcome, count)


def _gain(H: FloatArray, g: FloatArray, d: FloatArray) -> float:
    """How much a step lowers the sum of squares of the linear problem."""
    return -float(d @ (2.0 * g + H @ d))


def column_norms(R: FloatArray) -> FloatArray:
    """Euclidean norm of each column, shape (p,)."""
    norms: FloatArray = np.sqrt(np.einsum("ij,ij->j", R, R))
    return norms


def _stationary(
    g: FloatArray, x: FloatArray, lower: FloatArray, upper: FloatArray, limit: float
) -> bool:
    """Whether no parameter that may move has a gradient worth moving for."""
    pushes_out = ((x <= lower) & (g > 0)) | ((x >= upper) & (g < 0))
    return bool(np.all(np.abs(np.where(pushes_out, 0.0, g)) <= limit))
