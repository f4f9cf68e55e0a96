"""How far parameters can stand in for one another: collinearity of the Jacobian's columns.

After Brun, Reichert and Künsch, Practical identifiability analysis of large environmental
simulation models, Water Resources Research 37 (2001): a set K of parameters has the index
γ_K = 1/√λ, λ the smallest eigenvalue of S̃ᵀS̃, the columns of S̃ those of K at length 1. A change in
torque by one of them can be taken back by the others up to a part 1/γ_K. They call sets poorly
identifiable from 10 or 15 on.
"""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from surae.units import FloatArray

#: Index from which a set counts as collinear.
COLLINEAR = 10.0
#: Squared length below which what is left of a column of length 1 is rounding.
_ROUNDING = 1e-10
#: Largest set that is looked for.
_LARGEST = 4


def unit_columns(R: FloatArray) -> FloatArray:
    """The columns at length 1; one that is all zero stays so."""
    norms = np.linalg.norm(R, axis=0)
    return np.asarray(R / np.where(norms > 0, norms, 1.0))


def unexplained(R: FloatArray, j: int, others: Sequence[int]) -> float:
    """Squared length of what no combination of other columns gives of column `j`, 0 for rounding.

    It is the information on parameter j when the others are estimated too: its inverse, times σ²,
    is the variance.
    """
    column, rest = R[:, j], unit_columns(R[:, list(others)])
    left = column - rest @ np.linalg.lstsq(rest, column, rcond=None)[0]
    length = float(left @ left)
    return length if length > _ROUNDING * float(column @ column) else 0.0


def index(unit: FloatArray) -> float:
    """γ_K of a set of columns of length 1, shape (·, k); infinite where one is a sum of others."""
    least = float(np.linalg.eigvalsh(unit.T @ unit)[0])
    return least**-0.5 if least > _ROUNDING else np.inf


def collinear_sets(
    names: Sequence[str], R: FloatArray
) -> tuple[tuple[tuple[str, ...], float], ...]:
    """Smallest sets of two to four parameters with γ_K from `COLLINEAR` on, strongest first.

    A set that holds a smaller one says nothing new and is left out, and so is what has no effect.
    """
    felt = np.flatnonzero(np.any(R != 0, axis=0)).tolist()
    names, unit = [names[j] for j in felt], unit_columns(R[:, felt])
    gram = unit.T @ unit
    collinear: list[tuple[tuple[int, ...], float]] = []
    for size in range(2, min(_LARGEST, len(names)) + 1):
        sets = [
            members
            for members in combinations(range(len(names)), size)
            if not any(set(smaller) <= set(members) for smaller, _ in collinear)
        ]
        if not sets:
            break
        rows = np.array(sets)
        least = np.linalg.eigvalsh(gram[rows[:, :, None], rows[:, None, :]])[:, 0]
        collinear += [
            (members, float(low) ** -0.5 if low > _ROUNDING else np.inf)
            for members, low in zip(sets, least, strict=True)
            if low <= COLLINEAR**-2
        ]
    collinear.sort(key=lambda pair: -pair[1])
    return tuple((tuple(names[j] for j in members), gamma) for members, gamma in collinear)
