"""Where a fit that frees drives starts: at the minimum without them, in every valley of the delay.

A drive that is freed adds to what the torque can be, so its fit must not end above the one without
it. And a slow filter delays as a delay does, by beta/(π·f0) at low frequencies: with emd free the
sum of squares has a valley where the filter makes the delay and one where emd does.
"""

import numpy as np

from surae.base.units import FloatArray
from surae.inference.least_squares.separable import SomeRows, best_along, solve_linear
from surae.inference.problem import FitProblem
from surae.model import get_model, with_optional
from surae.model.parameters import OPTIONAL

#: Delays from which the valley where emd makes the delay is looked for, beside none [s].
_DELAYS = (0.06, 0.09)
#: A filter that leaves the delay to emd: cut-off [Hz] and relative damping.
_FAST = 5.0
_FAST_DAMPING = 1.0
#: Delays at which a reflex is looked for [s].
_REFLEX_DELAYS = (0.03, 0.05, 0.08, 0.12)


def own_columns(problem: FitProblem) -> list[int]:
    """Positions of the free parameters that are not a drive's."""
    return [j for j, name in enumerate(problem.free) if name not in problem.spec.optional]


def drives_off(problem: FitProblem) -> FitProblem:
    """The problem with its freed drives off, left out where the bounds allow that."""
    columns = own_columns(problem)
    values = problem.by_name(held_off(problem, problem.start[columns]))
    acts = {name for name, value in values.items() if value and name != "reflex_delay"}
    groups = [group for group in OPTIONAL.values() if acts & {*group}]
    on = [name for name in problem.spec.optional if any(name in group for group in groups)]
    spec = with_optional(get_model(problem.spec.name), on)
    return problem.of_model(spec, [problem.free[j] for j in columns], values, problem.limits)


def held_off(problem: FitProblem, values: FloatArray) -> FloatArray:
    """All free parameters, shape (p,), from those that are not a drive's, with the drives off."""
    x = np.where([name == "reflex_delay" for name in problem.free], problem.start, 0.0)
    x[own_columns(problem)] = values
    return np.asarray(np.clip(x, problem.lower, problem.upper))


def delay_valleys(problem: FitProblem, rows: SomeRows, x: FloatArray) -> list[FloatArray]:
    """The minimum without drives, `x`, or better, then points with a delay to descend from.

    Their filter is the best of three, see `_filters`, with the linear parameters solved.
    """
    here = _with_reflex(problem, rows, x)
    points = [here]
    if "emd" in problem.free:
        emd = problem.free.index("emd")
        expected = float(problem.start[emd])  # where the user expects it
        for delay in sorted({expected, *_DELAYS} - {0.0}):
            if problem.lower[emd] <= delay <= problem.upper[emd]:
                point = here.copy()
                point[emd] = delay
                solved = [solve_linear(problem, rows, p) for p in _filters(problem, point)]
                points.append(min(solved, key=lambda pair: pair[1])[0])
    return points


def _with_reflex(problem: FitProblem, rows: SomeRows, x: FloatArray) -> FloatArray:
    """The point with the gains of its reflex solved at the delay that suits best, if that helps."""
    if "reflex_delay" not in problem.free:
        return x
    j = problem.free.index("reflex_delay")
    residual = rows(x, [])[-1]
    return best_along(problem, rows, (x, float(residual @ residual)), j, _REFLEX_DELAYS)[0]


def _filters(problem: FitProblem, x: FloatArray) -> list[FloatArray]:
    """The point, and with a free cut-off one as much faster as emd delays, and a fast one."""
    cutoff = next((j for j, name in enumerate(problem.free) if name in ("f0", "f")), None)
    if cutoff is None:
        return [x]
    values = problem.by_name(x)
    beta = values.get("beta", 1.0)
    beyond_delay = beta / (np.pi * x[cutoff]) - values["emd"]  # of what the filter delayed [s]
    faster = x.copy()
    fast = x.copy()
    faster[cutoff] = beta / (np.pi * beyond_delay) if beyond_delay > 0 else np.inf
    fast[cutoff] = _FAST
    if "beta" in problem.free:
        fast[problem.free.index("beta")] = _FAST_DAMPING
    return [x, *(np.clip(moved, problem.lower, problem.upper) for moved in (faster, fast))]
