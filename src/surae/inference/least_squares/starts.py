"""From one start to its minimum: what each model solves before all parameters move together."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from surae.base.units import FloatArray
from surae.inference.least_squares.drive_starts import (
    delay_valleys,
    drives_off,
    held_off,
    own_columns,
)
from surae.inference.least_squares.minimise import Ends, Minimum, Outcome, minimise
from surae.inference.least_squares.residuals import Residuals, curved_move
from surae.inference.least_squares.separable import scan_lengths, solve_linear
from surae.inference.problem import FitProblem
from surae.model import ModelSpec, get_model, with_optional
from surae.signals import sampled, thinning_factor

#: A failed step ends the iteration when no more than this many noise variances are to be gained:
#: estimates within a third (√0.1) of a standard error of the minimum. On thinned data less will do.
_STALL = 0.1
_STALL_THINNED = 1.0
#: Thinned data keep at least this rate [Hz] and so many samples: compliant tendons are integrated
#: and need what is enough for a robot's motion, rigid ones only enough to tell valleys apart.
_THIN_RATE = 60.0
_THIN_RATE_RIGID = 12.0
_THIN_SAMPLES = 500
#: A look at thinned data ends when this part of a noise variance is to be gained.
_LOOK = 0.1
#: Relaxation times [s] that are tried, with this factor, unless the one found is within `_APART`.
_RELAXATIONS = (0.3, 5.0)
_RELAXATION_FACTOR = 0.4
_APART = 4.0
#: Told of every better point: the model, all its parameters, and the sum of squares.
Follow = Callable[[ModelSpec, FloatArray, float], None]
#: Finds the minimum that a point leads to.
Descent = Callable[[FloatArray], Minimum]
#: Finds the minimum that a start leads to; true looks for better optimal lengths before.
FromStart = Callable[[FloatArray, bool], Minimum]


def from_start(problem: FitProblem, residuals: Residuals, follow: Follow | None) -> FromStart:
    """How a start of this problem finds its minimum.

    A model of rigid tendons solves its linear parameters first. A model with a parent takes the
    parent's minimum, then its own on thinned data: compliance changes the muscle's parameters by
    a few percent, so each lies in the valley of the next and costs a fraction of it. A problem
    that frees drives begins at its minimum without them, see `drive_starts.py`.
    """
    direct = _direct(problem, residuals, follow)
    if len(own_columns(problem)) == len(problem.free):
        return direct
    return _with_drives(problem, residuals, direct, follow)


def _direct(problem: FitProblem, residuals: Residuals, follow: Follow | None) -> FromStart:
    """Descends from the start, or the parent's minimum; others look at thinned data first."""
    descend = _descent(problem, residuals, follow)
    again = None
    straight = _solved_first(problem, residuals, descend)
    look = None if problem.spec.parent is None else _first_look(problem, residuals, follow)
    if look is None:
        thin = _thinned(problem, _THIN_RATE_RIGID if problem.spec.parent is None else _THIN_RATE)
        if thin.n == problem.n:
            return straight
        # What is known beforehand weighs as much beside fewer samples as beside all of them.
        few = Residuals(thin, residuals.noise * np.sqrt(thin.n / problem.n), residuals)
        again = _descent(thin, few, stall=_STALL_THINNED, ftol=_LOOK / thin.n)
        look = _solved_first(thin, few, again)
    first: list[Minimum] = []
    #: Minima on thinned data, each with the one that it leads to on all of them.
    ends: list[tuple[Minimum, Minimum]] = []

    def minimum(initial: FloatArray, scan: bool) -> Minimum:
        if again is not None and not first:
            first.append(straight(initial, scan))
            return first[0]
        if again is not None and not ends:
            ends.append((again(first[0].x), first[0]))
        before = look(initial, scan)
        if before.outcome is Outcome.INTERRUPTED:
            return stopped(problem, residuals, before.x)
        for thinned_end, end in ends:
            if _leads_to(before.x, before.sse, thinned_end):
                return replace(end, iterations=before.iterations)
        ends.append((before, descend(before.x)))
        return ends[-1][1]

    return minimum


def _descent(
    problem: FitProblem,
    residuals: Residuals,
    follow: Follow | None = None,
    *,
    stall: float = _STALL,
    ftol: float = 1e-8,
) -> Descent:
    """How a point descends to its minimum, so that one can `follow` it."""
    move = curved_move(problem)

    def better(x: FloatArray, sse: float) -> None:
        if follow is not None:
            follow(problem.spec, problem.values(x), sse)

    def descend(x: FloatArray) -> Minimum:
        return minimise(
            residuals.rows,
            x,
            problem.lower,
            problem.upper,
            move=move,
            ends=Ends(ftol=ftol, stall=stall / problem.n),
            better=better,
        )

    return descend


def _solved_first(problem: FitProblem, residuals: Residuals, descend: Descent) -> FromStart:
    """Descends from the start with its linear parameters solved."""

    def minimum(initial: FloatArray, scan: bool) -> Minimum:
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
    columns = own_columns(problem)
    off = drives_off(problem)
    without = (
        from_start(off, Residuals(off, residuals.noise, residuals), follow) if columns else None
    )
    descend = _descent(problem, residuals)
    rigid = problem.spec.parent is None
    followed = _descent(problem, residuals, follow)

    def minimum(initial: FloatArray, scan: bool) -> Minimum:
        x = held_off(problem, initial[columns])
        if without is not None:
            before = without(initial[columns], scan)
            x = held_off(problem, before.x)
            if before.outcome is Outcome.INTERRUPTED:
                return stopped(problem, residuals, x)
        points = delay_valleys(problem, residuals.data_rows, x) if rigid else [x]
        best = _lowest(followed(points[0]), descend, points[1:])
        if len(points) == 1:
            best = _lowest(best, lambda start: direct(start, scan), [initial])
        if follow is not None:
            follow(problem.spec, problem.values(best.x), best.sse)
        return best

    return minimum


def stopped(problem: FitProblem, residuals: Residuals, x: FloatArray) -> Minimum:
    """A point as the minimum where the user stopped before the problem's own iteration began."""
    here = minimise(residuals.rows, x, problem.lower, problem.upper, ends=Ends(1))
    return replace(here, outcome=Outcome.INTERRUPTED)


def _lowest(best: Minimum, descend: Descent, points: Iterable[FloatArray]) -> Minimum:
    """The lowest of minima, until the user stops: that is told in any case."""
    for point in points:
        if best.outcome is Outcome.INTERRUPTED:
            break
        other = descend(point)
        if other.sse < best.sse or not np.isfinite(best.sse):
            best = other
        elif other.outcome is Outcome.INTERRUPTED:
            best = replace(best, outcome=other.outcome)
    return best


def _first_look(problem: FitProblem, whole: Residuals, follow: Follow | None) -> FromStart | None:
    """The minimum of a model with a parent on thinned data; None if nothing is free in that."""
    thin = replace(_thinned(problem, _THIN_RATE), priors={})  # a first look needs none
    assert problem.spec.parent is not None
    spec = with_optional(get_model(problem.spec.parent), problem.spec.optional)
    names = [name for name in problem.free if name in spec.names]
    if not names:
        return None
    parent = thin.of_model(spec, names, thin.by_name(thin.start), thin.limits)
    shared = [problem.free.index(name) for name in names]
    from_parent = from_start(parent, Residuals(parent, within=whole), follow)
    residuals = Residuals(thin, within=whole)
    descend = _descent(thin, residuals, stall=_STALL_THINNED)
    followed = _descent(thin, residuals, follow, stall=_STALL_THINNED)

    def minimum(initial: FloatArray, scan: bool) -> Minimum:
        before = from_parent(initial[shared], scan)
        x = initial.copy()
        x[shared] = before.x
        if before.outcome is Outcome.INTERRUPTED:
            return stopped(thin, residuals, x)
        best = followed(x)
        return _lowest(best, descend, _other_relaxations(thin, best.x))

    return minimum


def _thinned(problem: FitProblem, rate_hz: float) -> FitProblem:
    """The problem with fewer samples, or as it is where too few of them would count."""
    inputs = [sampled(r, thinning_factor(r, rate_hz, _THIN_SAMPLES)) for r in problem.inputs]
    thin = replace(problem, inputs=tuple(inputs))
    return thin if thin.n > len(problem.free) else problem


def _other_relaxations(problem: FitProblem, x: FloatArray) -> list[FloatArray]:
    """The point `x` with its relaxation moved to where another valley may be.

    A fast relaxation looks like the damping of a compliant tendon, and a slow one like stiffness:
    the sum of squares has a valley at each, and which of them a start falls into says little.
    """
    if not {"tau_rel", "k_rel"} <= {*problem.free}:
        return []
    tau = problem.free.index("tau_rel")
    gain = problem.free.index("k_rel")
    points = []
    for value in _RELAXATIONS:
        if not 1 / _APART < value / x[tau] < _APART:
            point = x.copy()
            point[tau], point[gain] = value, _RELAXATION_FACTOR
            points.append(np.clip(point, problem.lower, problem.upper))
    return points


#: A point is at a minimum when its sum differs by less than so many noise variances, and its
#: parameters by less than so many as the minimum's Jacobian measures it.
_SAME_SUM = 2.0
_SAME = 9.0


def _leads_to(x: FloatArray, sse: float, end: Minimum) -> bool:
    """Whether a point is at a minimum."""
    variance = max(end.sse, 1e-300) / len(end.residual)
    with np.errstate(over="ignore", invalid="ignore"):  # an end may be where the model overflows
        apart = end.R @ (x - end.x)
        predicted = float(apart @ apart) / variance
        excess = (sse - end.sse) / variance
    return abs(excess) <= _SAME_SUM and predicted <= _SAME
