"""Parameters of one recording tried on others (thesis 2.7)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.assessment.quality import rmse, vaf
from surae.errors import InputError
from surae.model import ModelOptions, ModelSpec, check_finite_torque
from surae.signals import ModelInputs
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class Prediction:
    """How well parameters predict a recording they were not fitted to.

    Attributes
    ----------
    name : str
        Name of the recording.
    path : str or None
        The file it was read from.
    vaf : float
        Variance accounted for, equation (31) [%].
    rmse, bias : float
        Root mean square and mean of measured minus predicted torque [Nm].
    torque : ndarray, shape (n,)
        Predicted torque [Nm].
    """

    name: str
    path: str | None
    vaf: float
    rmse: float
    bias: float
    torque: FloatArray


def predict(
    spec: ModelSpec,
    options: ModelOptions,
    values: Mapping[str, float],
    inputs: Sequence[ModelInputs],
) -> tuple[Prediction, ...]:
    """Predict the torque of recordings with given parameters.

    Raises
    ------
    InputError
        A recording has no torque to compare with, or none that is not zero.
    ComputationError
        The predicted torque is not finite.
    """
    vector = spec.vector(values, options)
    predictions = []
    for one in inputs:
        if one.torque is None or not one.torque.any():
            raise InputError(f"{one.where}: no torque to compare the prediction with")
        with np.errstate(over="ignore", invalid="ignore"):  # refused below
            torque = spec.simulator(one, options).torque(vector)
        check_finite_torque(torque, one)
        residual = one.torque - torque
        predictions.append(
            Prediction(
                one.name,
                one.files[0].path if one.files else None,
                vaf(one.torque, residual),
                rmse(residual),
                float(residual.mean()),
                torque,
            )
        )
    return tuple(predictions)
