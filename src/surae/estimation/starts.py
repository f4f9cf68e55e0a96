"""From one start to its minimum: what each model solves before all parameters move together."""

from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np

from surae.estimation.drive_starts import delay_valleys, drives_off, held_off, own_columns
from surae.estimation.least_squares import Better, Minimum, Outcome, Rows, minimise
from surae.estimation.problem import FitProblem
from surae.estimation.residuals import Residuals, curved_move
from surae.estimation.separable import scan_lengths, solve_linear
from surae.model import ModelSpec, get_model, with_optional
from surae.signals import thinned, thinning_factor
from surae.units import FloatArray

#: A failed step ends the iteration when no more than this many noise variances are to be gained:
#: estimates within a third (√0.1) of a standard error of the minimum. On thinned data less will do.
_STALL, _STALL_THINNED = 0.1, 1.0
#: Thinned data keep at least this rate [Hz] and so many samples: compliant tendons are integrated
#: and need what is enough for a robot's motion, rigid ones only enough to tell valleys apart.
_THIN_RATE, _THIN_RATE_RIGID, _THIN_SAMPLES = 60.0, 12.0, 500
#: A look at thinned data ends when this part of a noise variance is to be gained.
_LOOK = 0.1
#: Relaxation times [s] that are tried, with this factor, unless the one found is within `_APART`.
_RELAXATIONS, _RELAXATION_FACTOR, _APART = (0.3, 5.0), 0.4, 4.0
#: Told of every better point: the model, all its parameters, and the sum of squares.
Follow = Callable[[ModelSpec, FloatArray, float], None]
#: Finds the minimum that a point leads to.
Descent = Callable[[FloatArray], Minimum]


class FromStart(Protocol):
    """Finds the minimum that a start leads to."""

    def __call__(self, initial: FloatArray, *, scan: bool) -> Minimum:
        """Minimum from the free parameters `initial`; `scan` looks for better optimal lengths."""
        ...


def from_start(
    problem: FitProblem, residuals: Residuals, follow: Follow | None = None
) -> FromStart:
    """How a start of this problem finds its minimum.

    A model of rigid tendons solves its linear parameters first. A model with a parent takes the
    parent's minimum, then its own on thinned data: compliance changes the muscle's parameters by
    a few percent, so each lies in the valley of the next and costs a fraction of it. A problem
    that frees drives begins at its minimum without them, see `surae.estimation.drive_starts`.
    """
    direct = _direct(problem, residuals, follow)
    if len(own_columns(problem)) == len(problem.free):
        return direct
    return _with_drives(problem, residuals, direct, follow)


def _direct(problem: FitProblem, residuals: Residuals, follow: Follow | None) -> FromStart:
    """Descends from the start itself, or from the parent's minimum.

    Of several starts, those that thinned data lead to the minimum of another one end there.
    """
    descend = _descent(problem, residuals, better=_better(problem, follow))
    if problem.spec.parent is not None and (look := _first_look(problem, follow)) is not None:
        return _by_looks(problem, residuals, look, Valleys(), descend)
    straight = _solved_first(problem, residuals, descend)
    thin = _thinned(problem, _THIN_RATE_RIGID if problem.spec.parent is None else _THIN_RATE)
    if thin.n == problem.n:
        return straight
    # What is known beforehand weighs as much beside fewer samples as beside all of them.
    few = Residuals(thin, residuals.noise * np.sqrt(thin.n / problem.n))
    valleys = Valleys()
    again = _descent(thin, few, glance=True)
    look = _solved_first(thin, few, again)
    others = _by_looks(problem, residuals, look, valleys, descend)
    first: list[Minimum] = []

    def minimum(initial: FloatArray, *, scan: bool) -> Minimum:
        if not first:
            first.append(straight(initial, scan=scan))
            return first[0]
        if valleys.empty:
            valleys.add(again(first[0].x), first[0])
        return others(initial, scan=scan)

    return minimum


def _by_looks(
    problem: FitProblem, residuals: Residuals, look: FromStart, valleys: "Valleys", descend: Descent
) -> FromStart:
    """Looks at thinned data, and descends on all of them where no other start did."""

    def minimum(initial: FloatArray, *, scan: bool) -> Minimum:
        before = look(initial, scan=scan)
        if before.outcome is Outcome.INTERRUPTED:
            return _stopped(problem, residuals.rows, before.x)
        known = valleys.minimum(before)
        if known is not None:
            return replace(known, iterations=before.iterations)
        best = descend(before.x)
        valleys.add(before, best)
        return best

    return minimum


def _descent(
    problem: FitProblem,
    residuals: Residuals,
    *,
    better: Better | None = None,
    glance: bool = False,
) -> Descent:
    """How a point descends to its minimum; on thinned data, near it."""
    move = curved_move(problem)
    stall = (_STALL_THINNED if glance else _STALL) / problem.n
    ftol = _LOOK / problem.n if glance else 1e-8

    def descend(x: FloatArray) -> Minimum:
        return minimise(
            residuals.rows, x, problem.lower, problem.upper,
            move=move, ftol=ftol, stall=stall, better=better,
        )  # fmt: skip

    return descend


def _solved_first(problem: FitProblem, residuals: Residuals, descend: Descent) -> FromStart:
    """Descends from the start with its linear parameters solved."""

    def minimum(initial: FloatArray, *, scan: bool) -> Minimum:
        if scan:
            return descend(scan_lengths(problem, residuals.data_rows, initial))
        return descend(solve_linear(problem, residuals.data_rows, initial)[0])

    return minimum


def _with_drives(
    problem: FitProblem, residuals: Residuals, direct: FromStart, follow: Follow | None
) -> FromStart:
    """The best of the minima that begin without the drives.

    Where nothing else looks for another valley, and with a compliant tendon, whose parent has,
    the start's own minimum is tried too.
    """
    own, off = own_columns(problem), drives_off(problem)
    without = from_start(off, Residuals(off, residuals.noise), follow) if own else None
    rows, move, stall = residuals.rows, curved_move(problem), _STALL / problem.n
    better, rigid = _better(problem, follow), problem.spec.parent is None

    def minimum(initial: FloatArray, *, scan: bool) -> Minimum:
        x = held_off(problem, initial[own])
        if without is not None:
            before = without(initial[own], scan=scan)
            x = held_off(problem, before.x)
            if before.outcome is Outcome.INTERRUPTED:
                return _stopped(problem, rows, x)
        points = delay_valleys(problem, residuals.data_rows, x) if rigid else [x]
        best = minimise(
            rows, points[0], problem.lower, problem.upper, move=move, stall=stall, better=better
        )
        for point in points[1:]:
            if best.outcome is not Outcome.INTERRUPTED:
                other = minimise(rows, point, problem.lower, problem.upper, move=move, stall=stall)
                best = _better_of(best, other)
        if len(points) == 1 and best.outcome is not Outcome.INTERRUPTED:
            best = _better_of(best, direct(initial, scan=scan))
        if better is not None:
            better(best.x, best.sse)
        return best

    return minimum


def _stopped(problem: FitProblem, rows: Rows, x: FloatArray) -> Minimum:
    """The minimum where the user stopped before the problem's own iteration began."""
    here = minimise(rows, x, problem.lower, problem.upper, max_iterations=1)
    return replace(here, outcome=Outcome.INTERRUPTED)


def _better_of(best: Minimum, other: Minimum) -> Minimum:
    """The lower of two minima; an interruption of the second is told in any case."""
    lower = other.sse < best.sse or not np.isfinite(best.sse)
    if other.outcome is Outcome.INTERRUPTED:
        return replace(other if lower else best, outcome=other.outcome)
    return other if lower else best


def _better(problem: FitProblem, follow: Follow | None) -> Better | None:
    """What an iteration tells of its points, so that one can follow it; None: nobody does."""
    if follow is None:
        return None

    def better(x: FloatArray, sse: float) -> None:
        follow(problem.spec, problem.values(x), sse)

    return better


def _first_look(problem: FitProblem, follow: Follow | None = None) -> FromStart | None:
    """The minimum of a model with a parent on thinned data; None for a model without."""
    thin = replace(_thinned(problem, _THIN_RATE), priors={})  # a first look needs none
    parent = _parent(thin)
    if parent is None:
        return None
    shared = [problem.free.index(name) for name in parent.free]
    from_parent = from_start(parent, Residuals(parent), follow)
    rows = Residuals(thin).rows
    move, stall = curved_move(thin), _STALL_THINNED / thin.n
    better = _better(thin, follow)

    def minimum(initial: FloatArray, *, scan: bool) -> Minimum:
        before = from_parent(initial[shared], scan=scan)
        x = initial.copy()
        x[shared] = before.x
        if before.outcome is Outcome.INTERRUPTED:
            return _stopped(thin, rows, x)
        best = minimise(rows, x, thin.lower, thin.upper, move=move, stall=stall, better=better)
        for relaxed in _other_relaxations(thin, best.x):
            if best.outcome is Outcome.INTERRUPTED:
                break
            other = minimise(rows, relaxed, thin.lower, thin.upper, move=move, stall=stall)
            best = _better_of(best, other)
        return best

    return minimum


def _thinned(problem: FitProblem, rate_hz: float) -> FitProblem:
    """The problem with fewer samples, or as it is where too few of them would count."""
    factors = [thinning_factor(recording, rate_hz, _THIN_SAMPLES) for recording in problem.inputs]
    inputs = tuple(
        thinned(recording, by) for recording, by in zip(problem.inputs, factors, strict=True)
    )
    thin = replace(problem, inputs=inputs)
    return thin if thin.n > len(problem.free) else problem


def _other_relaxations(problem: FitProblem, x: FloatArray) -> list[FloatArray]:
    """The point `x` with its relaxation moved to where another valley may be.

    A fast relaxation looks like the damping of a compliant tendon, and a slow one like stiffness:
    the sum of squares has a valley at each, and which of them a start falls into says little.
    """
    if "tau_rel" not in problem.free or "k_rel" not in problem.free:
        return []
    tau, gain = problem.free.index("tau_rel"), problem.free.index("k_rel")
    points = []
    for value in _RELAXATIONS:
        if not 1 / _APART < value / x[tau] < _APART:
            point = x.copy()
            point[tau], point[gain] = value, _RELAXATION_FACTOR
            points.append(np.clip(point, problem.lower, problem.upper))
    return points


def _parent(problem: FitProblem) -> FitProblem | None:
    """The problem with the parent model; None without one, or with nothing free in it."""
    if problem.spec.parent is None:
        return None
    spec = with_optional(get_model(problem.spec.parent), problem.spec.optional)
    shared = [name in spec.names for name in problem.free]
    if not any(shared):
        return None
    return replace(
        problem,
        spec=spec,
        free=tuple(name for name in problem.free if name in spec.names),
        base=problem.base[[problem.spec.names.index(name) for name in spec.names]],
        lower=problem.lower[np.array(shared)],
        upper=problem.upper[np.array(shared)],
        priors={},
    )


#: A point is at a minimum when its sum differs by less than so many noise variances, and its
#: parameters by less than so many as the minimum's Jacobian measures it.
_SAME_SUM, _SAME = 2.0, 9.0


class Valleys:
    """Minima on thinned data, each with the one that it leads to on all of them."""

    def __init__(self) -> None:
        self._ends: list[tuple[Minimum, Minimum]] = []

    @property
    def empty(self) -> bool:
        """Whether no minimum is known yet."""
        return not self._ends

    def add(self, thinned: Minimum, end: Minimum) -> None:
        """Remember that the minimum on thinned data leads to `end`."""
        self._ends.append((thinned, end))

    def minimum(self, thinned: Minimum) -> Minimum | None:
        """The minimum on all data that a point on thinned data leads to; None if it is new."""
        ends = (end for thin_end, end in self._ends if _leads_to(thinned.x, thinned.sse, thin_end))
        return next(ends, None)


def _leads_to(x: FloatArray, sse: float, end: Minimum) -> bool:
    """Whether a point is at a minimum."""
    variance = max(end.sse, 1e-300) / len(end.residual)
    with np.errstate(over="ignore", invalid="ignore"):  # an end may be where the model overflows
        apart = end.R @ (x - end.x)
        predicted, excess = float(apart @ apart) / variance, (sse - end.sse) / variance
    return abs(excess) <= _SAME_SUM and predicted <= _SAME
