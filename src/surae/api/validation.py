"""Parameters of some recordings tried on others."""

from collections.abc import Sequence

from surae.api.fitted import Fit
from surae.api.recordings import AnyRecording, as_in_fit
from surae.assessment.validation import Prediction, predict_others
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
