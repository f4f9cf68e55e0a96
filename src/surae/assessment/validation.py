"""Parameters of some recordings tried on others (thesis 2.7)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.assessment.adequacy import Adequacy, judge_prediction
from surae.assessment.fascicles import Fascicles, followed
from surae.assessment.residual import rmse, vaf
from surae.errors import InputError
from surae.estimation import FitResult
from surae.frozen import Comparable
from surae.model import ModelOptions, ModelSpec, check_finite_torque
from surae.recording import MUSCLES
from surae.signals import ModelInputs
from surae.units import FloatArray


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
    #: Whether it is as good as the fit promises; None where the parameters are of no fit.
    adequacy: Adequacy | None = None
    fascicles: tuple[Fascicles, ...] = ()  #: Filmed lengths, measured and predicted.

    def __repr__(self) -> str:
        judged = "" if self.adequacy is None else f"{self.adequacy.grade}, "
        errors = f"RMSE {self.rmse:.3g} Nm, bias {self.bias:.3g} Nm"
        return f"prediction of {self.name!r}: {judged}VAF {self.vaf:.2f} %, {errors}"

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
    measured = np.concatenate([prediction.errors[0] for prediction in predictions])
    residual = np.concatenate([prediction.errors[1] for prediction in predictions])
    return PooledPrediction(vaf(measured, residual), rmse(residual), float(residual.mean()))


def predict_others(
    result: FitResult, inputs: Sequence[ModelInputs], *, judge: bool = True
) -> tuple[Prediction, ...]:
    """Predict recordings with the parameters of a fit to others, and judge; see `predict`."""
    problem = result.problem
    unit = problem.inputs[0].emg_unit
    weights = zip(MUSCLES, problem.spec.weights, strict=True)
    estimated = [muscle for muscle, weight in weights if weight in problem.free]
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
    predicted = predict(problem.spec, problem.options, result.values, inputs)
    return tuple(
        replace(
            prediction,
            adequacy=judge_prediction(result, recording, prediction.torque) if judge else None,
            fascicles=followed(problem.spec, problem.options, result.values, recording),
        )
        for prediction, recording in zip(predicted, inputs, strict=True)
    )


def predict(
    spec: ModelSpec,
    options: ModelOptions,
    values: Mapping[str, float],
    inputs: Sequence[ModelInputs],
) -> tuple[Prediction, ...]:
    """Predict the torque of recordings with given parameters.

    A sample of weight 0 is predicted, and is in no figure; other weights change nothing.

    Raises
    ------
    InputError
        A recording has no torque to compare with, or none that is not zero.
    ComputationError
        The predicted torque is not finite.
    """
    vector = spec.vector(values, options)
    predictions = []
    for recording in inputs:
        if recording.torque is None or not recording.torque.any():
            raise InputError(f"{recording.where}: no torque to compare the prediction with")
        with np.errstate(over="ignore", invalid="ignore"):  # refused below
            torque = spec.simulator(recording, options).torque(vector)
        check_finite_torque(torque, recording)
        counted = recording.counts
        residual = (recording.torque - torque)[counted]
        predictions.append(
            Prediction(
                recording.name,
                recording.files[0].name if recording.files else None,
                vaf(recording.torque[counted], residual),
                rmse(residual),
                float(residual.mean()),
                torque,
                recording.time,
                recording.torque,
                recording.weight,
            )
        )
    return tuple(predictions)
