"""Steps along the curved valley of stiffness and slack length."""

import numpy as np

from surae.estimation.least_squares import Move
from surae.estimation.problem import FitProblem
from surae.model.geometry import paths
from surae.units import FloatArray

_GROUPS = (("k_tri", "x0_tri"), ("k_tib", "x0_tib"))


def curved_move(problem: FitProblem) -> Move:
    """How a point moves along a step so that the passive forces change as predicted.

    The data determine the passive force where the muscle is long, exp(k·(x_ref − x0)), far better
    than k or x0 alone, so the valley of the minimum is the curve k·(x_ref − x0) = constant and a
    straight step leaves it. The step is therefore taken in φ = k·(x_ref − x0) and k: the same to
    first order, and a slack length held at a bound stays there.

    The greatest length x_ref of each muscle is that of the problem's recordings.
    """
    groups = [
        (problem.free.index(k), problem.free.index(x0), longest)
        for k, x0, longest in stiffness_valleys(problem)
        if k in problem.free and x0 in problem.free
    ]

    def move(x: FloatArray, step: FloatArray) -> FloatArray:
        moved = x + step
        for j_k, j_x0, x_ref in groups:
            reach = x_ref - x[j_x0]
            # A step that would turn the stiffness around is cut: bounds keep it positive.
            k = max(moved[j_k], 0.1 * x[j_k])
            phi = x[j_k] * reach + reach * (k - x[j_k]) - x[j_k] * step[j_x0]
            moved[j_k], moved[j_x0] = k, x_ref - phi / k
        return np.asarray(moved)

    return move


def stiffness_valleys(problem: FitProblem) -> list[tuple[str, str, float]]:
    """Stiffness, slack length and x_ref [m], the greatest length, of each muscle group."""
    angle = np.concatenate([recording.angle for recording in problem.inputs])
    groups = paths(angle=angle, velocity=np.zeros_like(angle), options=problem.options)
    return [
        (k, x0, float(path.length.max())) for (k, x0), path in zip(_GROUPS, groups, strict=True)
    ]
