"""Predictions of other recordings in words (thesis 2.7)."""

from collections.abc import Sequence
from dataclasses import dataclass

from surae.assessment import Assessment, Prediction, pooled
from surae.report.formatting import percentage, significant

#: VAF [%] that a prediction may lie below that of the fit before it is worth a word.
_FALL = 5.0


@dataclass(frozen=True, slots=True)
class PredictionRow:
    """One predicted recording: its figures as text, and its figure in words."""

    name: str
    vaf: str
    rmse: str
    bias: str
    alt: str


@dataclass(frozen=True, slots=True)
class PredictionSection:
    """All predicted recordings, and what they say together; the first `drawn` have a figure."""

    text: str
    rows: tuple[PredictionRow, ...]
    drawn: int


def prediction_section(
    assessment: Assessment, predictions: Sequence[Prediction]
) -> PredictionSection | None:
    """The predictions in words; None where there are none."""
    if not predictions:
        return None
    rows = [
        _row(prediction.name, prediction.vaf, prediction.rmse, prediction.bias)
        for prediction in predictions
    ]
    together = pooled(predictions)
    if len(predictions) > 1:
        rows.append(_row("all together", together.vaf, together.rmse, together.bias))
    fall = assessment.vaf - together.vaf
    text = (
        f"With the parameters of this fit, {percentage(together.vaf)} % of the mean square of "
        f"torque that the fit has not seen is accounted for; of its own torque it was "
        f"{percentage(assessment.vaf)} %."
    )
    if fall > _FALL:
        text += (
            " The parameters carry over only in part: they describe the recordings they were "
            "fitted to better than the leg."
        )
    return PredictionSection(text, tuple(rows), len(predictions))


def _row(name: str, vaf: float, rmse: float, bias: float) -> PredictionRow:
    return PredictionRow(
        name,
        percentage(vaf),
        significant(rmse, 3),
        significant(bias, 3),
        f"Measured and predicted torque against time, VAF {percentage(vaf)} %, and their "
        f"difference, RMS {significant(rmse, 3)} Nm.",
    )
