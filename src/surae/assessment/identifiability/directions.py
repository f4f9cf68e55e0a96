"""Combinations of parameters that the torque tells least, in numbers and in words."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.units import FloatArray

#: Squared length below which what is left of a column of length 1 is rounding.
_ROUNDING = 1e-10
#: A parameter takes part in a direction when its relative change is this part of the largest, or
#: when its effect on the torque is this part of the largest and its change not a trifle.
_CHANGED, _EFFECT, _TRIFLE = 0.3, 0.25, 0.03
#: Parameters that are named at most.
_MOST = 5
#: Part of its largest contribution up to which a direction's torque counts as cancelled.
_CANCELLED = 0.5
#: Singular value, as a part of the largest, below which there is only rounding.
_SINGULAR = 1e-10


def unexplained(R: FloatArray, j: int, others: Sequence[int]) -> float:
    """Squared length of what no combination of other columns gives of column `j`, 0 for rounding.

    It is the information on parameter j when the others are estimated too: its inverse, times σ²,
    is the variance.
    """
    column, rest = R[:, j], R[:, list(others)]
    norms = np.linalg.norm(rest, axis=0)
    rest = rest / np.where(norms > 0, norms, 1.0)
    left = column - rest @ np.linalg.lstsq(rest, column, rcond=None)[0]
    length = float(left @ left)
    return length if length > _ROUNDING * float(column @ column) else 0.0


@dataclass(frozen=True, slots=True)
class Direction:
    """A combination of parameters, an eigenvector of the scaled information matrix."""

    #: Information along it; parameters are measured in their own values, torque in standard
    #: deviations of the noise.
    eigenvalue: float
    #: 1/√eigenvalue: relative standard error along it; None where there is no information.
    uncertainty: float | None
    #: Its parameters, the most changed first, and their relative change along it, of length 1 over
    #: all parameters.
    changes: Mapping[str, float]
    words: str  #: The same as a sentence.
    #: What it adds to the variance of each parameter, over σ², shape (k,).
    variances: FloatArray


def directions(
    names: tuple[str, ...], R: FloatArray, length: FloatArray, sigma: float
) -> tuple[Direction, ...]:
    """Eigenvectors of the scaled information matrix RᵀR/σ², the weakest first.

    R, shape (k, k), is the triangular factor of the sensitivities to each parameter in units of its
    own value [Nm], `length` are those of its columns, `sigma` is the noise's standard deviation
    [Nm].
    """
    _, s, Vt = np.linalg.svd(R)
    rows = []
    for value, v in zip(s[::-1], Vt[::-1], strict=True):
        effect = np.abs(v) * length
        singular = value <= _SINGULAR * s[0]
        opposed = bool(value <= _CANCELLED * float(effect.max()))
        parts = _parts(np.abs(v), effect)
        signed = v if v[parts[0]] >= 0 else -v
        changes = {names[i]: float(signed[i]) for i in parts}
        rows.append(
            Direction(
                eigenvalue=0.0 if singular else float(value / sigma) ** 2 if sigma else np.inf,
                uncertainty=None if singular else sigma / float(value),
                changes=changes,
                words=_words(changes, opposed, singular),
                variances=(v / max(value, _SINGULAR * s[0], 1e-300)) ** 2,
            )
        )
    return tuple(rows)


def _parts(change: FloatArray, effect: FloatArray) -> list[int]:
    """Parameters that make up a direction, those of the largest relative change first."""
    changed = change >= _CHANGED * change.max()
    felt = (effect >= _EFFECT * effect.max()) & (change >= _TRIFLE * change.max())
    order = np.argsort(-change, kind="stable").tolist()
    return [i for i in order if changed[i] or (felt[i] and effect[i] > 0)][:_MOST]


def _words(changes: Mapping[str, float], opposed: bool, singular: bool) -> str:
    moved = [f"{name} {'up' if change >= 0 else 'down'}" for name, change in changes.items()]
    names = moved[0] if len(moved) == 1 else f"{moved[0]} with {listed(moved[1:])}"
    if singular:
        return f"{names}: the same torque"
    return f"{names}: {'nearly the same torque' if opposed else 'changes the torque'}"


def listed(texts: Sequence[str]) -> str:
    """Texts with commas and, before the last, "and"."""
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} and {texts[-1]}"
