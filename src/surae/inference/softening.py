"""Whether passive tissue softened within a trial: its first stretches against its last.

Tissue that has rested is stiffer for its first stretches (thixotropy), by 20 to 35 %, and then as
it stays. A model of one stiffness lies between, and what it says holds for neither. A stretch is as
much travel as twice the range. In each part of the trial, of as much travel as the others, what the
torque has beyond the model goes with the modelled tissue's torque by a part bᵢ; a leg that softened
has bᵢ = b + s·exp(−nᵢ/n₀), n being the stretches before. How far bᵢ scatter says how sure s is.
What goes with the muscles' torque too is not counted: of effort every model is somewhat wrong.
"""

from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.inference.result import FitResult
from surae.signals import ModelInputs

#: Parts of a trial, and the fewest stretches in it.
_PARTS, _FEWEST = 10, 3.0
#: Stretches n₀ after which a softening has fallen to a third.
_SETTLES = 1.5
#: Least softening that matters, and its standard errors: one trial in a thousand comes to them by
#: chance (Student's t of eight degrees), and a leg has some five. Of 99 trials of legs that do not
#: soften none came to both (3.3 at most), of thirteen of legs that do, four.
_MATTERS, _SURE = 0.06, 4.5


@dataclass(frozen=True, slots=True)
class Softening:
    """How much stiffer tissue was at the beginning of a recording, as a part of its torque."""

    recording: str
    size: float
    se: float

    @property
    def is_seen(self) -> bool:
        """Whether it matters, and is no scatter."""
        return self.size > _MATTERS and self.size > _SURE * self.se


def softening(result: FitResult) -> tuple[Softening, ...]:
    """Of each recording that is long enough to tell."""
    problem, found = result.problem, []
    for number, (recording, e) in enumerate(zip(problem.inputs, result.residuals, strict=True)):
        values = {
            **result.values,
            **{name: each[number] for name, each in result.found.each.items()},
        }
        vector = problem.spec.vector(values, problem.options)
        parts = problem.spec.simulator(recording, problem.options).parts(vector)
        if (seen := _seen(recording, parts.tissue, parts.neural, e)) is not None:
            found.append(Softening(recording.name, *seen))
    return tuple(found)


def _seen(
    recording: ModelInputs, tissue: FloatArray, neural: FloatArray, e: FloatArray
) -> tuple[float, float] | None:
    """Size and standard error, both as parts of the tissue's torque."""
    angle = recording.angle
    span = float(np.ptp(np.percentile(angle, [1.0, 99.0])))
    stretches = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(angle)))]) / max(2.0 * span, 1e-9)
    if not (stretches[-1] >= _FEWEST and np.isfinite(tissue).all()):
        return None
    part = np.minimum((stretches / stretches[-1] * _PARTS).astype(int), _PARTS - 1)
    slopes, weights, middles = [], [], []
    for i in range(_PARTS):
        here = (part == i) & recording.counts
        if not here.any():
            continue
        away, beside = (each[here] - each[here].mean() for each in (tissue, neural))
        if (along := float(beside @ beside)) > 0.0:
            away = away - float(away @ beside) / along * beside
        if (size := float(away @ away)) > 0.0:
            slopes.append(float(away @ e[here]) / size)
            weights.append(size)
            middles.append(float(stretches[here].mean()))
    if len(slopes) < _PARTS // 2:
        return None
    root = np.sqrt(np.array(weights))
    columns = np.stack([np.ones(len(root)), np.exp(-np.array(middles) / _SETTLES)], axis=1)
    rows, seen = columns * root[:, None], np.array(slopes) * root
    inverse = np.linalg.pinv(rows.T @ rows)
    found = inverse @ rows.T @ seen
    missed = seen - rows @ found
    variance = float(missed @ missed) / (len(root) - 2)
    return float(found[1]), float(np.sqrt(max(variance * inverse[1, 1], 0.0)))
