"""Parts of the data that a fit does not see, and how well it predicts them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from surae.errors import InputError
from surae.estimation import FitProblem, FitResult
from surae.frozen import read_only
from surae.signals import ModelInputs
from surae.units import FloatArray

#: Contiguous blocks that a single recording is cut into.
BLOCKS = 4
#: Samples this close to a block count neither in it nor in the fit, so that a residual that is
#: correlated over time does not tell the fit about the block [s]; at most a tenth of the block.
GUARD_S, GUARD_PART = 0.5, 0.1


@dataclass(frozen=True, slots=True)
class Fold:
    """One part of the data that is left out."""

    name: str  #: What is left out.
    #: What is fitted. The signals of a block are still simulated, as activation and relaxation
    #: remember them; its torque has weight 0.
    training: tuple[ModelInputs, ...]
    held: ModelInputs  #: The recording that is predicted.
    samples: npt.NDArray[np.intp]  #: Its samples that are left out.


def folds(inputs: Sequence[ModelInputs]) -> tuple[Fold, ...]:
    """Leave out each of several recordings in turn, or each block of a single one.

    Every sample that counts is in one fold's `samples` exactly once.
    """
    if len(inputs) == 1:
        return _blocks(inputs[0])
    return tuple(
        Fold(
            recording.name,
            tuple(inputs[:i]) + tuple(inputs[i + 1 :]),
            recording,
            _counted(recording),
        )
        for i, recording in enumerate(inputs)
    )


def _blocks(recording: ModelInputs) -> tuple[Fold, ...]:
    blocks = []
    for number, samples in enumerate(np.array_split(_counted(recording), BLOCKS), start=1):
        if not len(samples):
            raise InputError(
                f"{recording.where}: too few samples to leave out each quarter in turn"
            )
        first, last = int(samples[0]), int(samples[-1])
        guard = int(min(GUARD_S * recording.rate_hz, GUARD_PART * len(samples)))
        weight = np.ones(recording.n) if recording.weight is None else recording.weight.copy()
        weight[max(first - guard, 0) : last + 1 + guard] = 0.0
        name = (
            f"block {number} of {BLOCKS} ({recording.time[first]:.1f}…{recording.time[last]:.1f} s)"
        )
        blocks.append(
            Fold(name, (replace(recording, weight=read_only(weight)),), recording, samples)
        )
    return tuple(blocks)


def _counted(recording: ModelInputs) -> npt.NDArray[np.intp]:
    return np.arange(recording.n) if recording.weight is None else np.flatnonzero(recording.weight)


def without(problem: FitProblem, fold: Fold, result: FitResult) -> FitProblem:
    """The problem without the fold's samples, starting from the solution with them."""
    left = replace(
        problem,
        inputs=fold.training,
        base=np.array([result.values[name] for name in problem.spec.names]),
    )
    if left.n <= len(left.free):
        raise InputError(
            f"without {fold.name}, {left.n} samples cannot determine {len(left.free)} parameters; "
            "give longer recordings"
        )
    return left


def measured(fold: Fold) -> FloatArray:
    """Measured torque [Nm] of the samples that are left out."""
    if fold.held.torque is None:
        raise InputError(f"{fold.held.where}: no torque to compare the prediction with")
    return fold.held.torque[fold.samples]


def prediction_error(result: FitResult, fold: Fold) -> FloatArray:
    """Measured minus predicted torque [Nm] of the samples that the fit did not see."""
    problem = result.problem
    values = np.array([result.values[name] for name in problem.spec.names])
    predicted = problem.spec.simulator(fold.held, problem.options).torque(values)
    return np.asarray(measured(fold) - predicted[fold.samples], dtype=np.float64)


@dataclass(frozen=True, slots=True)
class HeldOut:
    """How well a model predicts what its fits did not see."""

    vaf: float  #: Of the residuals of all folds pooled, equation (31) [%].
    spread: float  #: Standard deviation of the folds' own VAFs [%].
    folds: tuple[float, ...]  #: VAF of every fold [%].
    #: How much `vaf` exceeds that of the rigid model [%]; 0 for the rigid model itself.
    gain: float
    gain_se: float  #: Standard error of the gain, from how it differs between the folds [%].


def held_out(
    missed: Sequence[float], of_rigid: Sequence[float], total: Sequence[float]
) -> HeldOut | None:
    """Score of a model from its folds.

    The gain is Σ(missed by the rigid model − missed by this one)/ΣT², a sum over the k folds. Its
    standard error is √k times the standard deviation of the terms: the folds are paired, so that a
    fold which is hard to predict for every model does not blur the difference.

    `missed` and `of_rigid` are sums of squared prediction errors of each fold, by the model and by
    the rigid one, `total` those of the measured torque [Nm²]. None where a prediction is not
    finite, or a fold has no torque.
    """
    mine, rigid, scale = np.array(missed), np.array(of_rigid), np.array(total)
    whole = scale.sum()
    if not (np.isfinite(mine).all() and np.isfinite(rigid).all() and (scale > 0).all()):
        return None
    vafs = 100 * (1 - mine / scale)
    terms = 100 * (rigid - mine) / whole
    return HeldOut(
        vaf=float(100 * (1 - mine.sum() / whole)),
        spread=float(vafs.std(ddof=1)),
        folds=tuple(vafs.tolist()),
        gain=float(terms.sum()),
        gain_se=float(np.sqrt(len(terms)) * terms.std(ddof=1)),
    )
