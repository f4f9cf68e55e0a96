"""What counted more or less in a fit, in words: weights, and a loss that spares outliers."""

from surae.assessment import Assessment
from surae.estimation import FitResult
from surae.report.formatting import percentage, short, significant

#: Share of samples that count less than half from which they are no stray artefacts; Gaussian noise
#: has 0.7 % of them under Huber's loss.
MANY_OUTLIERS = 0.05


def emphasis_text(result: FitResult, assessment: Assessment) -> str:
    """A paragraph of the summary; empty where every sample counts as any other."""
    texts = []
    if any(recording.emphasised for recording in result.problem.inputs):
        texts.append("The fit was told to follow some samples more closely than others.")
    if result.outliers is not None:
        share = 100 * result.outliers.share
        texts.append(
            f"Outliers were let count less ({result.outliers.loss} loss): {significant(share, 2)} "
            "% of the samples count less than half. They are in the plain VAF and error all the "
            "same."
        )
        if result.outliers.share > MANY_OUTLIERS:
            texts.append(
                "So many are no stray artefacts: the model leaves something out, and a loss that "
                "spares outliers hides it."
            )
    if texts and assessment.vaf_weighted is not None:
        texts.append(
            f"With the samples counted as in the fit, the VAF is "
            f"{percentage(assessment.vaf_weighted)} %."
        )
    return " ".join(texts)


def loss_text(result: FitResult) -> str:
    """The loss, its tuning and scale, and how many samples it spares."""
    outliers = result.outliers
    if outliers is None:
        return "squares"
    return (
        f"{outliers.loss}, from {short(outliers.tuning)} standard deviations of "
        f"{significant(outliers.scale, 3)} Nm; {significant(100 * outliers.share, 2)} % of the "
        f"samples count less than half; weights at rest after {outliers.rounds} rounds"
    )
