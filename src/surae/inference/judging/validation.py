"""Parameters of some recordings tried on others (thesis 2.7)."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import Comparable
from surae.base.units import FloatArray
from surae.inference import FitResult
from surae.inference.judging.adequacy import judge_prediction
from surae.inference.judging.baselines import Baselines, baselines
from surae.inference.judging.fascicles import Fascicles, followed
from surae.inference.judging.goodness import counted, rmse, vaf
from surae.inference.judging.grade import Adequacy
from surae.inference.judging.other_movement import beside_simplest
from surae.inference.judging.predicted import TorqueDoubt, torque_doubt
from surae.inference.uncertainty.combined import Uncertainty
from surae.model import check_finite_torque
from surae.recording import MUSCLES
from surae.signals import ModelInputs


@dataclass(frozen=True, slots=True, eq=False)
class Prediction(Comparable):
    """How well parameters predict a recording they were not fitted to.

    Figures are over the samples that count.
    """

    name: str  #: Name of the recording.
    path: str | None  #: The file it was read from.
    vaf: float  #: Variance accounted for, equation (31) [%].
    rmse: float  #: Root mean square of measured minus predicted torque [Nm].
    bias: float  #: Its mean [Nm].
    torque: FloatArray  #: Predicted [Nm], shape (n,).
    time: FloatArray  #: [s], shape (n,).
    measured: FloatArray  #: Torque [Nm], shape (n,).
    #: Of the samples, shape (n,); those of weight 0 are in no figure. None: all count.
    weight: FloatArray | None = None
    #: How unsure its torque is where samples count; None where that was not asked.
    doubt: TorqueDoubt | None = None
    #: Whether it is as good as the fit promises; None where that was not judged.
    adequacy: Adequacy | None = None
    #: What the fit's recordings predict of it without a model.
    baselines: Baselines = field(default_factory=Baselines)
    fascicles: tuple[Fascicles, ...] = ()  #: Filmed lengths, measured and predicted.
    #: Part of the torque that is the simplest member's, 0 … 1: of a family's fit to inverse
    #: dynamics, where the movement is not the fit's.
    simplest: float = 0.0
    #: Variance that the simplest member accounts for, fitted to the same recordings [%]; None of a
    #: named model.
    simplest_vaf: float | None = None

    def __repr__(self) -> str:
        judged = "" if self.adequacy is None else f"{self.adequacy.grade}, "
        errors = f"RMSE {self.rmse:.3g} Nm, bias {self.bias:.3g} Nm"
        best = self.baselines.best
        without = "" if best is None else f"; without a model {best:.2f} %"
        return f"prediction of {self.name!r}: {judged}VAF {self.vaf:.2f} %, {errors}{without}"

    @property
    def covers(self) -> float | None:
        """Samples whose measured torque lies within the 95 % interval of the predicted [%]."""
        if self.doubt is None:
            return None
        _, missed = self.errors
        return float(100.0 * np.mean(np.abs(missed) <= self.doubt.half_width))

    @property
    def errors(self) -> tuple[FloatArray, FloatArray]:
        """Measured torque, and measured minus predicted, of the samples that count."""
        counted = slice(None) if self.weight is None else self.weight > 0
        return self.measured[counted], (self.measured - self.torque)[counted]


@dataclass(frozen=True, slots=True, eq=False)
class PooledPrediction(Comparable):
    """Several predictions as if they were one recording: VAF [%], RMSE and bias [Nm]."""

    vaf: float
    rmse: float
    bias: float


def pooled(predictions: Sequence[Prediction]) -> PooledPrediction:
    """The figures of several predictions together; a longer recording counts more."""
    errors = [prediction.errors for prediction in predictions]
    measured, residual = (np.concatenate(each) for each in zip(*errors, strict=True))
    return PooledPrediction(vaf(measured, residual), rmse(residual), float(residual.mean()))


def covered(predictions: Sequence[Prediction]) -> float:
    """Samples of all that lie within the 95 % interval of their predicted torque [%]."""
    shares = [p.covers for p in predictions if p.covers is not None]
    sizes = [len(p.errors[1]) for p in predictions if p.covers is not None]
    return float(np.average(shares, weights=sizes)) if shares else np.nan


def predict_others(
    result: FitResult,
    inputs: Sequence[ModelInputs],
    known: Uncertainty | None,
    *,
    adequate: bool = True,
) -> tuple[Prediction, ...]:
    """Predict recordings with the parameters of a fit to others, and judge by what is `known`.

    Of another movement the torque of a family's fit to inverse dynamics that is not `adequate` is
    averaged with that of its simplest member.

    A sample of weight 0 is predicted, and is in no figure; other weights change nothing.
    """
    problem = result.problem
    spec = problem.spec
    options = problem.options
    unit = problem.inputs[0].emg_unit
    weights = zip(MUSCLES, spec.weights, strict=True)
    estimated = [muscle for muscle, weight in weights if weight in problem.free]
    vector = spec.vector(result.values, options)
    predictions = []
    for recording in inputs:
        if recording.emg_unit != unit:
            raise InputError(
                f"{recording.where}: its EMG is in {recording.emg_unit!r}, that of the fit in "
                f"{unit!r}; the weights do not carry over"
            )
        for muscle in recording.missing_emg:
            if muscle in estimated:
                raise InputError(
                    f"{recording.where}: no EMG of muscle {muscle!r}, whose weight the fit "
                    f"estimated; add the channel emg_{muscle}"
                )
        if recording.torque is None or not recording.torque.any():
            raise InputError(f"{recording.where}: no torque to compare the prediction with")
        with np.errstate(over="ignore", invalid="ignore"):  # refused below
            torque = spec.simulator(recording, options).torque(vector)
        check_finite_torque(torque, recording)
        other = beside_simplest(result, recording, torque, adequate=adequate)
        if other is not None:
            torque = other.torque
        measured, residual = counted(recording, recording.torque - torque)
        doubt = None if known is None else torque_doubt(result, known, recording)
        if doubt is not None and other is not None:
            rows = np.vstack([doubt.rows, other.row[recording.counts]])
            doubt = replace(doubt, rows=rows)
        judged = None
        if doubt is not None:
            judged = judge_prediction(doubt, recording, options.anatomy, measured, residual)
        predictions.append(
            Prediction(
                recording.name,
                recording.files[0].name if recording.files else None,
                vaf(measured, residual),
                rmse(residual),
                float(residual.mean()),
                torque,
                recording.time,
                recording.torque,
                recording.weight,
                doubt,
                judged,
                Baselines() if known is None else baselines(problem.inputs, recording),
                followed(spec, options, result.values, recording),
                0.0 if other is None else other.share,
                None
                if other is None
                else vaf(*counted(recording, recording.torque - other.simplest)),
            )
        )
    return tuple(predictions)
