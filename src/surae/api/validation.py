"""Parameters of some recordings tried on others."""

from collections.abc import Sequence
from typing import Any

from surae.api.fitted import Fit
from surae.api.fitting import fit
from surae.api.recordings import AnyRecording, as_in_fit, as_inputs
from surae.assessment.validation.leave_one_out import LeaveOneOut
from surae.assessment.validation.leave_one_out import Told as LeaveOneOutTold
from surae.assessment.validation.leave_one_out import leave_one_out as leave_one_out_of
from surae.assessment.validation.prediction import Prediction, predict_others
from surae.signals import ModelInputs, Weighting, weighted


def validate(
    fitted: Fit,
    recordings: Sequence[AnyRecording],
    *,
    prepared: bool | None = None,
    weights: Weighting | Sequence[Weighting] | None = None,
) -> tuple[Prediction, ...]:
    """Predict recordings with the parameters of a fit to others (thesis 2.7).

    Parameters
    ----------
    fitted : Fit
        Where the parameters come from.
    recordings : sequence of Recording, ModelInputs or path
        With their measured torque.
    prepared : bool, optional
        Whether their signals are used as they are; by default as they were in the fit.
    weights : Weighting, or sequence of Weighting, optional
        Its windows of weight 0 are left out of the figures.

    Returns
    -------
    tuple of Prediction
        One for each recording: VAF, RMSE, bias and the predicted torque.
    """
    inputs: Sequence[ModelInputs]
    inputs = as_in_fit(fitted.result.problem.inputs, recordings, prepared)
    return predict_others(fitted.result, inputs if weights is None else weighted(inputs, weights))


def leave_one_out(
    recordings: Sequence[AnyRecording],
    model: str = "muscle",
    *,
    prepared: bool = False,
    weights: Weighting | Sequence[Weighting] | None = None,
    progress: LeaveOneOutTold | None = None,
    **settings: Any,
) -> LeaveOneOut:
    """Predict every recording with the parameters of a fit of all the others (thesis 2.7).

    Parameters
    ----------
    recordings : sequence of Recording, ModelInputs or path
        At least two recordings of one leg; they may be of different protocols.
    model : str
        Name of the model.
    prepared : bool
        The signals are filtered and at the model's rate already: use them as they are.
    weights : Weighting, or sequence of Weighting, optional
        What samples count in the fits; those of weight 0 are in no prediction's figures either.
    progress : callable, optional
        Called before every fit with (the recording left out, fits done, all fits).
    **settings
        Other keywords of `fit`: ``fixed``, ``priors``, ``loss``, ``starts``, model options, …

    Returns
    -------
    LeaveOneOut
        A prediction and a fit for each recording, and the figures of all predictions together.
    """
    inputs: Sequence[ModelInputs] = [as_inputs(one, prepared) for one in recordings]
    if weights is not None:
        inputs = weighted(inputs, weights)
    return leave_one_out_of(inputs, lambda some: fit(some, model, **settings).result, progress)
