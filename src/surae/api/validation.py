"""Parameters of some recordings tried on others, and models compared by it."""

from collections.abc import Sequence
from typing import Any

from surae.api.fitted import Fit
from surae.api.fitting import asks_as_fit
from surae.api.recordings import AnyRecording, as_in_fit, read_in, several
from surae.assessment.validation import LeaveOneOut, Prediction, predict_others
from surae.assessment.validation import leave_one_out as leave_one_out_of
from surae.estimation import FitSettings
from surae.progress import NamedProgress
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
        One for each recording: VAF, RMSE, bias, the predicted torque, and in `adequacy` whether
        it is as good as the fit promises, with reasons.
    """
    inputs: Sequence[ModelInputs]
    inputs = as_in_fit(fitted.result.problem, recordings, prepared)
    return predict_others(fitted.result, inputs if weights is None else weighted(inputs, weights))


@asks_as_fit
def leave_one_out(
    recordings: Sequence[AnyRecording],
    model: str | FitSettings = "muscle",
    *,
    mvc: AnyRecording | Sequence[AnyRecording] = (),
    progress: NamedProgress | None = None,
    **asked: Any,
) -> LeaveOneOut:
    """Predict every recording with the parameters of a fit of all the others (thesis 2.7).

    Parameters
    ----------
    recordings : sequence of Recording, ModelInputs or path
        At least two recordings of one leg; they may be of different protocols.
    model : str or FitSettings
        Name of the model, or everything that is asked, e.g. ``fit.settings``.
    mvc : Recording, ModelInputs, path, or a sequence of them
        Maximum voluntary contractions, for ``normalise="mvc"``.
    progress : callable, optional
        Called before every fit with (the recording left out, fits done, all fits).
    **asked
        Keywords of `fit`: ``fixed``, ``priors``, ``loss``, ``starts``, model options, … What
        weights leave out is in no prediction's figures either.

    Returns
    -------
    LeaveOneOut
        A prediction and a fit for each recording, and the figures of all predictions together.
    """
    settings = FitSettings.of(model, **asked)
    measured = [read_in(recording) for recording in recordings]
    inputs = settings.inputs(measured, [read_in(recording) for recording in several(mvc)])
    return leave_one_out_of(inputs, settings, progress)
