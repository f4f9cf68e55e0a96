"""Where a fit that frees drives starts: at the minimum without them, in every valley of the delay.

A drive that is freed adds to what the torque can be, so its fit must not end above the one without
it. And a slow filter delays as a delay does, by beta/(π·f0) at low frequencies: with emd free the
sum of squares has a valley where the filter makes the delay and one where emd does.
"""

import numpy as np

from surae.estimation.problem import FitProblem
from surae.estimation.separable import SomeRows, solve_linear
from surae.model import get_model, with_optional
from surae.model.parameters import OPTIONAL
from surae.units import FloatArray

#: Delays from which the valley where emd makes the delay is looked for, beside none [s].
_DELAYS = (0.06, 0.09)
#: A filter that leaves the delay to emd: cut-off [Hz] and relative damping.
_FAST, _FAST_DAMPING = 5.0, 1.0
#: Delays at which a reflex is looked for [s].
_REFLEX_DELAYS = (0.03, 0.05, 0.08, 0.12)


def own_columns(problem: FitProblem) -> list[int]:
    """Positions of the free parameters that are not a drive's."""
    return [j for j, name in enumerate(problem.free) if name not in problem.spec.optional]


def drives_off(problem: FitProblem) -> FitProblem:
    """Hold a problem's freed drives off, or at the bound that is nearest to off.

    A drive that is off altogether is left out of the model: the problem is the one that a fit
    without it has.
    """
    own = own_columns(problem)
    values = problem.values(held_off(problem, problem.start[own]))
    by_name = dict(zip(problem.spec.names, values.tolist(), strict=True))
    on = [
        name
        for name in problem.spec.optional
        if any(name in group and _is_on(group, by_name) for group in OPTIONAL.values())
    ]
    spec = with_optional(get_model(problem.spec.name), on)
    return problem.narrowed(spec, [problem.free[j] for j in own], values)


def held_off(problem: FitProblem, own: FloatArray) -> FloatArray:
    """All free parameters, shape (p,), from those that are not a drive's, with the drives off."""
    x = np.array([p if name == "reflex_delay" else 0.0 for name, p in _starts(problem)])
    x[own_columns(problem)] = own
    clipped: FloatArray = np.clip(x, problem.lower, problem.upper)
    return clipped


def delay_valleys(problem: FitProblem, rows: SomeRows, x: FloatArray) -> list[FloatArray]:
    """Points to descend from, of a model of rigid tendons whose minimum without drives is `x`.

    The first is that minimum or better, the others are delayed. Their filter stays as it is,
    becomes faster by as much as emd delays, or fast: what is best with the linear parameters
    solved.
    """
    here = _with_reflex(problem, rows, x)
    points = [here]
    if "emd" in problem.free:
        emd = problem.free.index("emd")
        own = float(problem.start[emd])  # where the user expects it
        for delay in sorted({own, *_DELAYS} - {0.0}):
            if problem.lower[emd] <= delay <= problem.upper[emd]:
                point = here.copy()
                point[emd] = delay
                filters = _filters(problem, point)
                solved = [solve_linear(problem, rows, filtered) for filtered in filters]
                points.append(min(solved, key=lambda pair: pair[1])[0])
    return points


def _starts(problem: FitProblem) -> list[tuple[str, float]]:
    return list(zip(problem.free, problem.start.tolist(), strict=True))


def _is_on(group: tuple[str, ...], values: dict[str, float]) -> bool:
    """Whether a drive does anything: its delay or one of its gains is not 0."""
    return any(values.get(name, 0.0) for name in group if name != "reflex_delay")


def _with_reflex(problem: FitProblem, rows: SomeRows, x: FloatArray) -> FloatArray:
    """The point with the gains of its reflex solved at the delay that suits best, if that helps."""
    if "reflex_delay" not in problem.free:
        return x
    j = problem.free.index("reflex_delay")
    residual = rows(x, [])[-1]
    best, lowest = x, float(residual @ residual)
    for delay in _REFLEX_DELAYS:
        point = x.copy()
        point[j] = np.clip(delay, problem.lower[j], problem.upper[j])
        point, sse = solve_linear(problem, rows, point)
        if sse < lowest:
            best, lowest = point, sse
    return best


def _filters(problem: FitProblem, x: FloatArray) -> list[FloatArray]:
    """The point, and where its cut-off is free the point with two faster filters."""
    cutoff = next((j for j, name in enumerate(problem.free) if name in ("f0", "f")), None)
    if cutoff is None:
        return [x]
    values = dict(zip(problem.spec.names, problem.values(x).tolist(), strict=True))
    beta = values.get("beta", 1.0)
    beyond_delay = beta / (np.pi * x[cutoff]) - values["emd"]  # of what the filter delayed [s]
    faster, fast = x.copy(), x.copy()
    faster[cutoff] = beta / (np.pi * beyond_delay) if beyond_delay > 0 else np.inf
    fast[cutoff] = _FAST
    if "beta" in problem.free:
        fast[problem.free.index("beta")] = _FAST_DAMPING
    return [x, *(np.clip(moved, problem.lower, problem.upper) for moved in (faster, fast))]
