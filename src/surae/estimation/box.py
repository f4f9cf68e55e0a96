"""Small linear least squares within bounds: the inner problem of every step."""

import numpy as np

from surae.model.jit import jit
from surae.units import FloatArray


@jit
def box_quadratic(H: FloatArray, g: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Minimise ½dᵀHd + gᵀd subject to lower ≤ d ≤ upper, by an active set.

    Primal active set: a step that meets a bound stops there and holds it, a held bound whose
    multiplier has the wrong sign is let go, one at a time. Each face is left at a lower value, so
    no face comes twice and the loop is finite; the count below only guards against rounding.

    H, shape (p, p), is symmetric and positive definite, best with a unit diagonal; bounds may be
    infinite.
    """
    p = len(g)
    d = np.minimum(np.maximum(np.zeros(p), lower), upper)
    held = np.zeros(p, dtype=np.bool_)
    for j in range(p):
        held[j] = lower[j] == upper[j]
    scale = np.max(np.abs(g)) + 1e-300
    for _ in range(20 * p + 20):
        free = np.flatnonzero(~held)
        gradient = g + H @ d
        if len(free) > 0:
            A = np.empty((len(free), len(free)))
            b = np.empty(len(free))
            for i in range(len(free)):
                b[i] = -gradient[free[i]]
                for j in range(len(free)):
                    A[i, j] = H[free[i], free[j]]
            step = np.linalg.solve(A, b)
            length, blocking, rising = 1.0, -1, False
            for i in range(len(free)):
                j = free[i]
                room = upper[j] - d[j] if step[i] > 0 else d[j] - lower[j]
                if abs(step[i]) * length > room:
                    length, blocking, rising = room / abs(step[i]), j, step[i] > 0
            for i in range(len(free)):
                d[free[i]] += length * step[i]
            if blocking >= 0:
                d[blocking] = upper[blocking] if rising else lower[blocking]
                held[blocking] = True
                continue
            gradient = g + H @ d
        worst, release = 1e-12 * scale, -1
        for j in range(p):
            if held[j] and lower[j] < upper[j]:
                wrong = -gradient[j] if d[j] == lower[j] else gradient[j]
                if wrong > worst:
                    worst, release = wrong, j
        if release < 0:
            break
        held[release] = False
    return d
