"""Non-linear least squares within bounds: Levenberg–Marquardt on the compressed Jacobian."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from scipy.linalg.lapack import dgeqrf

from surae.base.units import FloatArray
from surae.model.jit import jit


@jit
def box_quadratic(H: FloatArray, g: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Minimise ½dᵀHd + gᵀd subject to lower ≤ d ≤ upper, H positive definite, by an active set.

    A step that meets a bound stops there and holds it, a held bound whose multiplier has the wrong
    sign is let go, one at a time. Each face is left at a lower value, so no face comes twice and
    the loop is finite; the count below only guards against rounding. It is written out, since the
    compilation of NumPy's functions would take most of what that of all kernels takes.
    """
    p = len(g)
    d = np.empty(p)
    gradient = np.empty(p)
    step = np.empty(p)
    A = np.empty((p, p))
    held = np.empty(p, np.int64)
    free = np.empty(p, np.int64)
    least = 1e-300
    for j in range(p):
        d[j] = min(max(0.0, lower[j]), upper[j])
        held[j] = lower[j] == upper[j]
        least = max(least, abs(g[j]))
    least *= 1e-12
    settled = False  # where its face is lowest
    for _ in range(60 * p + 60):
        count = 0
        for j in range(p):
            total = g[j]
            for i in range(p):
                total += H[j, i] * d[i]
            gradient[j] = total
            if not held[j]:
                free[count] = j
                count += 1
        if settled or count == 0:
            worst = least
            release = -1
            for j in range(p):
                if held[j] and lower[j] < upper[j]:
                    wrong = -gradient[j] if d[j] == lower[j] else gradient[j]
                    if wrong > worst:
                        worst = wrong
                        release = j
            if release < 0:
                break
            held[release] = False
            settled = False
            continue
        for a in range(count):
            step[a] = -gradient[free[a]]
            for b in range(a, count):
                A[a, b] = H[free[a], free[b]]
        for k in range(count):  # elimination, which without pivots is stable
            for a in range(k + 1, count):
                factor = A[k, a] / A[k, k]
                step[a] -= factor * step[k]
                for b in range(a, count):
                    A[a, b] -= factor * A[k, b]
        for k in range(count - 1, -1, -1):
            for a in range(k + 1, count):
                step[k] -= A[k, a] * step[a]
            step[k] /= A[k, k]
        length = 1.0
        blocking = -1
        rising = False
        for i in range(count):
            j = free[i]
            room = upper[j] - d[j] if step[i] > 0 else d[j] - lower[j]
            if abs(step[i]) * length > room:
                length = room / abs(step[i])
                blocking = j
                rising = step[i] > 0
        for i in range(count):
            d[free[i]] += length * step[i]
        settled = blocking < 0
        if not settled:
            d[blocking] = upper[blocking] if rising else lower[blocking]
            held[blocking] = True
    return d


#: A step may raise the sum a little, by `_UPHILL` of the best, as long as it stays below the
#: highest of the `_MEMORY` last ones: that carries the iteration across kinks (Grippo et al. 1986).
_MEMORY = 3
_UPHILL = 0.01
#: The iteration rests when so many evaluations have not gained so many times `stall` together.
_PATIENCE = 40
_WORTHWHILE = 50
#: Part of the predicted gain that a step must reach.
_ENOUGH = 1e-4
#: Relative ridge under which the undamped step is judged.
_RIDGE = 1e-12
#: How a point moves along a step; beyond first order it is free to follow the problem's curves.
Move = Callable[[FloatArray, FloatArray], FloatArray]
#: Told of every better point: its parameters and its sum of squares.
Better = Callable[[FloatArray, float], None]
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
    """The end of an iteration."""

    x: FloatArray  #: Parameters, shape (p,).
    sse: float  #: Sum of squared residuals.
    residual: FloatArray  #: Residual at `x`, shape (n,).
    R: FloatArray  #: Triangular factor of the Jacobian at `x`: RᵀR = JᵀJ, shape (p, p).
    outcome: Outcome  #: Why it ended.
    iterations: int  #: Evaluations of the residual and its Jacobian.


def compress(rows: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """R of the Jacobian, Qᵀ·residual, and the sum of squares that no step can take away.

    `rows`, shape (p + 1, n), are the Jacobian's and the residual; they are overwritten.
    """
    p = rows.shape[0] - 1
    n = rows.shape[1]
    factored = dgeqrf(rows.T, lwork=64 * (p + 1), overwrite_a=True)[0]
    full = np.zeros((p + 1, p + 1))
    full[: min(p + 1, n)] = np.triu(factored[: p + 1])
    rest = float(full[p, p])  # of Python, which overflows without a warning
    return full[:p, :p], full[:p, p], rest * rest


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
    better: Better | None = None,
) -> Minimum:
    """Minimise the sum of squared residuals within bounds.

    Each step solves the damped linear problem exactly within the bounds (`box_quadratic`), so a
    parameter slides along its bound and leaves it again without shrinking the step of the others.
    Damping is relative to the largest norm that each Jacobian column has had, which makes the
    path independent of the parameters' units (Moré 1978), and follows the gain of each step
    (Nielsen 1999).

    A point moves along a step by `move`. It has converged when the undamped step is predicted to
    lower the sum by less than `ftol` of itself, or a step changes no parameter by more than `xtol`
    of its size, or the cosine between residual and every column that is free to move is at most
    `gtol`; it is at rest when many evaluations together (`_PATIENCE`) have gained next to nothing.
    `stall` takes the place of `ftol` after a step that did not improve on the best point: the
    torque has kinks, where tissue goes slack (11), and closer to the minimum than a small part of
    the noise the quadratic prediction does not hold: more steps would only chase kinks. `better`
    is called with every point that is better than all before it; Ctrl-C returns the best so far.

    References
    ----------
    Moré, The Levenberg–Marquardt algorithm (1978); Nielsen, Damping parameter in Marquardt's
    method, IMM-REP-1999-05 (1999); Grippo, Lampariello and Lucidi, A nonmonotone line search
    technique for Newton's method, SIAM J. Numer. Anal. 23 (1986).
    """
    stall = ftol if stall is None else stall
    x = np.clip(x, lower, upper)
    here, q = _point(x, rows(x))
    best = here
    count = 1
    eye = np.eye(len(x))
    if not (np.isfinite(here.sse) and np.isfinite(here.R).all()):
        return replace(here, outcome=Outcome.NOT_FINITE)
    norms = column_norms(here.R)
    damping = 1e-3
    growth = 2.0
    failed = False
    milestone = here.sse
    since = 0
    recent = deque([here.sse], maxlen=_MEMORY)
    outcome = Outcome.ITERATIONS
    try:
        while count < max_iterations:
            norms = np.maximum(norms, column_norms(here.R))
            scale = np.where(norms > 0, norms, 1.0)
            A = here.R / scale
            g = A.T @ q
            H = A.T @ A
            room = (lower - here.x) * scale, (upper - here.x) * scale
            undamped = predicted_gain(H, g, box_quadratic(H + _RIDGE * eye, g, *room))
            d = box_quadratic(H + damping * eye, g, *room)
            step = d / scale
            if (
                undamped <= (stall if failed else ftol) * here.sse
                or np.all(np.abs(step) <= xtol * (np.abs(here.x) + xtol))
                or _stationary(g, here.x, lower, upper, gtol * np.sqrt(here.sse))
                or since > _PATIENCE
            ):
                outcome = Outcome.CONVERGED
                break
            x = np.minimum(np.maximum(move(here.x, step), lower), upper)
            trial = rows(x)
            count += 1
            sse = sum_of_squares(trial[-1]) if np.isfinite(trial).all() else np.inf
            failed = not sse < best.sse
            if sse < milestone * (1 - min(_WORTHWHILE * stall, 0.5)):
                milestone = sse
                since = 0
            since += 1
            predicted = predicted_gain(H, g, d)
            gain = (min(max(recent), (1 + _UPHILL) * best.sse) - sse) / predicted
            if gain > _ENOUGH:
                monotone = (here.sse - sse) / predicted
                here, q = _point(x, trial)
                if here.sse < best.sse:
                    best = here
                    if better is not None:
                        better(best.x, best.sse)
                recent.append(here.sse)
                damping = max(damping * eased(monotone), 1e-15)
                growth = 2.0
            else:
                damping *= growth
                growth *= 2.0
    except KeyboardInterrupt:
        outcome = Outcome.INTERRUPTED
    return replace(best, outcome=outcome, iterations=count)


def _point(x: FloatArray, rows: FloatArray) -> tuple[Minimum, FloatArray]:
    """A point of the iteration and Qᵀ·residual there; its rows are overwritten."""
    residual = rows[-1].copy()
    R, q, _ = compress(rows)
    return Minimum(x, sum_of_squares(residual), residual, R, Outcome.ITERATIONS, 1), q


def sum_of_squares(residual: FloatArray) -> float:
    """Sum of squares; infinite where it overflows, which only makes the step fail."""
    with np.errstate(over="ignore"):
        return float(residual @ residual)


def predicted_gain(H: FloatArray, g: FloatArray, d: FloatArray) -> float:
    """How much a step lowers the sum of squares of the linear problem."""
    return -float(d @ (2.0 * g + H @ d))


def eased(ratio: float) -> float:
    """Factor on the damping after a step that gained so many times what was predicted."""
    return float(np.clip(1.0 - (2.0 * ratio - 1.0) ** 3, 0.1, 10.0))


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
