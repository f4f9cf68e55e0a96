"""Whether passive tissue softened within a trial: its first stretches against its last.

Tissue that has rested is stiffer for its first stretches (thixotropy), by 20 to 35 %, and then as
it stays. A model of one stiffness lies between, and what it says holds for neither. A stretch is as
much travel as twice the range. In each part of the trial, of as much travel as the others, what the
torque has beyond the model goes with the modelled tissue's torque by a part bᵢ; a leg that softened
has bᵢ = b + s·exp(−nᵢ/n₀), n being the stretches before. How far bᵢ scatter says how sure s is.
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
#: Least softening that matters, and its standard errors: of 30 trials of legs that do not soften
#: none came to half of both, of four of legs that do, three to both.
_MATTERS, _SURE = 0.06, 3.5


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
        tissue = problem.spec.simulator(recording, problem.options).parts(vector).tissue
        if (seen := _seen(recording, tissue, e)) is not None:
            found.append(Softening(recording.name, *seen))
    return tuple(found)


def _seen(recording: ModelInputs, tissue: FloatArray, e: FloatArray) -> tuple[float, float] | None:
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
        away = tissue[here] - tissue[here].mean() if here.any() else np.zeros(1)
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
