"""Non-linear least squares within bounds: Levenberg–Marquardt on the compressed Jacobian."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from scipy.linalg.lapack import dgeqrf

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.jit import inner, jit


@inner
def _gradient_on_face(
    H: FloatArray,
    g: FloatArray,
    d: FloatArray,
    held: IntArray,
    gradient: FloatArray,
    free: IntArray,
) -> int:
    """Fill in the gradient Hd + g, and which variables are free; return how many."""
    count = 0
    for j in range(len(g)):
        total = g[j]
        for i in range(len(g)):
            total += H[j, i] * d[i]
        gradient[j] = total
        if not held[j]:
            free[count] = j
            count += 1
    return count


@inner
def _to_release(
    gradient: FloatArray,
    d: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    held: IntArray,
    least: float,
) -> int:
    """The held variable that most wants to leave its bound, by more than `least`; −1 if none."""
    worst = least
    release = -1
    for j in range(len(d)):
        if held[j] and lower[j] < upper[j]:
            wrong = -gradient[j] if d[j] == lower[j] else gradient[j]
            if wrong > worst:
                worst = wrong
                release = j
    return release


@inner
def _newton_on_face(
    H: FloatArray, gradient: FloatArray, free: IntArray, count: int, A: FloatArray, step: FloatArray
) -> None:
    """Fill in the step to the face's minimum, by elimination, which without pivots is stable."""
    for a in range(count):
        step[a] = -gradient[free[a]]
        for b in range(a, count):
            A[a, b] = H[free[a], free[b]]
    for k in range(count):
        for a in range(k + 1, count):
            factor = A[k, a] / A[k, k]
            step[a] -= factor * step[k]
            for b in range(a, count):
                A[a, b] -= factor * A[k, b]
    for k in range(count - 1, -1, -1):
        for a in range(k + 1, count):
            step[k] -= A[k, a] * step[a]
        step[k] /= A[k, k]


@inner
def _go(
    d: FloatArray,
    step: FloatArray,
    free: IntArray,
    count: int,
    lower: FloatArray,
    upper: FloatArray,
    held: IntArray,
) -> bool:
    """Go along a step, or to the first bound on it, which then holds; whether it was whole."""
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
    if blocking >= 0:
        d[blocking] = upper[blocking] if rising else lower[blocking]
        held[blocking] = True
    return blocking < 0


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
        count = _gradient_on_face(H, g, d, held, gradient, free)
        if settled or count == 0:
            release = _to_release(gradient, d, lower, upper, held, least)
            if release < 0:
                break
            held[release] = False
            settled = False
            continue
        _newton_on_face(H, gradient, free, count, A, step)
        settled = _go(d, step, free, count, lower, upper, held)
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
#: A step changes nothing that is below so much of a parameter's size; no column is worth a step
#: whose cosine with the residual is below so much.
_XTOL = 1e-10
_GTOL = 1e-10
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


@dataclass(frozen=True, slots=True)
class Ends:
    """When an iteration ends."""

    max_iterations: int = 200  #: Evaluations of the residual and its Jacobian.
    ftol: float = 1e-8  #: Predicted gain of a step, as a part of the sum.
    stall: float | None = None  #: The same after a step that did not improve; `ftol` by default.


USUAL = Ends()


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
    ends: Ends = USUAL,
    better: Better | None = None,
) -> Minimum:
    """Minimise the sum of squared residuals within bounds.

    Each step solves the damped linear problem exactly within the bounds (`box_quadratic`), so a
    parameter slides along its bound and leaves it again without shrinking the step of the others.
    Damping is relative to the largest norm that each Jacobian column has had, which makes the
    path independent of the parameters' units (Moré 1978), and follows the gain of each step
    (Nielsen 1999).

    A point moves along a step by `move`. It has converged when the undamped step is predicted to
    lower the sum by less than `ends.ftol` of itself, or a step changes no parameter by more than
    `_XTOL` of its size, or the cosine between residual and every column that is free to move is at
    most `_GTOL`; it is at rest when many evaluations together (`_PATIENCE`) have gained next to
    nothing. `ends.stall` takes the place of `ftol` after a step that did not improve on the best
    point: the torque has kinks, where tissue goes slack (11), and closer to the minimum than a
    small part of the noise the quadratic prediction does not hold: more steps would only chase
    kinks. `better` is called with every point that is better than all before it; Ctrl-C returns the
    best so far.

    References
    ----------
    Moré, The Levenberg–Marquardt algorithm (1978); Nielsen, Damping parameter in Marquardt's
    method, IMM-REP-1999-05 (1999); Grippo, Lampariello and Lucidi, A nonmonotone line search
    technique for Newton's method, SIAM J. Numer. Anal. 23 (1986).
    """
    stall = ends.ftol if ends.stall is None else ends.stall
    x = np.clip(x, lower, upper)
    here, q = _point(x, rows(x))
    best = here
    count = 1
    if not (np.isfinite(here.sse) and np.isfinite(here.R).all()):
        return replace(here, outcome=Outcome.NOT_FINITE)
    norms = column_norms(here.R)
    damping = _Damping()
    failed = False
    milestone = here.sse
    since = 0
    recent = deque([here.sse], maxlen=_MEMORY)
    outcome = Outcome.ITERATIONS
    try:
        while count < ends.max_iterations:
            norms = np.maximum(norms, column_norms(here.R))
            linear = _Linear.at(here, q, norms, lower, upper)
            d = linear.minimum(damping.value)
            step = d / linear.scale
            if since > _PATIENCE or linear.settled(step, stall if failed else ends.ftol):
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
            predicted = predicted_gain(linear.H, linear.g, d)
            gain = (min(max(recent), (1 + _UPHILL) * best.sse) - sse) / predicted
            if gain > _ENOUGH:
                monotone = (here.sse - sse) / predicted
                here, q = _point(x, trial)
                if here.sse < best.sse:
                    best = here
                    if better is not None:
                        better(best.x, best.sse)
                recent.append(here.sse)
                damping.ease(monotone)
            else:
                damping.tighten()
    except KeyboardInterrupt:
        outcome = Outcome.INTERRUPTED
    return replace(best, outcome=outcome, iterations=count)


@dataclass(slots=True)
class _Damping:
    """Of the steps: eased by their gain, and tightened ever more by those without (Nielsen)."""

    value: float = 1e-3
    growth: float = 2.0

    def ease(self, ratio: float) -> None:
        """After a step that gained so many times what was predicted."""
        self.value = max(self.value * eased(ratio), 1e-15)
        self.growth = 2.0

    def tighten(self) -> None:
        """After a step that did not gain enough."""
        self.value *= self.growth
        self.growth *= 2.0


@dataclass(frozen=True, slots=True)
class _Linear:
    """The linear problem at a point, in units of its columns' norms."""

    here: Minimum
    bounds: tuple[FloatArray, FloatArray]
    scale: FloatArray
    H: FloatArray
    g: FloatArray
    room: tuple[FloatArray, FloatArray]  #: How far a step may go down and up.

    @classmethod
    def at(
        cls, here: Minimum, q: FloatArray, norms: FloatArray, lower: FloatArray, upper: FloatArray
    ) -> "_Linear":
        scale = np.where(norms > 0, norms, 1.0)
        A = here.R / scale
        room = (lower - here.x) * scale, (upper - here.x) * scale
        return cls(here, (lower, upper), scale, A.T @ A, A.T @ q, room)

    def minimum(self, damping: float) -> FloatArray:
        """The damped problem's minimum within the bounds."""
        return box_quadratic(self.H + damping * np.eye(len(self.g)), self.g, *self.room)

    def settled(self, step: FloatArray, ftol: float) -> bool:
        """Whether no step is worth while: by its gain, by its length, or by the gradient."""
        here = self.here
        undamped = predicted_gain(self.H, self.g, self.minimum(_RIDGE))
        return bool(
            undamped <= ftol * here.sse
            or np.all(np.abs(step) <= _XTOL * (np.abs(here.x) + _XTOL))
            or _stationary(self.g, here.x, *self.bounds, _GTOL * np.sqrt(here.sse))
        )


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
