"""A fit on one screen."""

from surae.assessment import Assessment, ParameterEstimate
from surae.estimation import FitResult
from surae.formatting import estimate, percentage, significant
from surae.report.joint import reworded
from surae.report.parameters import shown_parameters
from surae.report.wording import adequacy_words
from surae.tables import TextTable

_HEADS = ("parameter", "value", "95 % interval", "unit", "verdict", "meaning")


def fit_table(result: FitResult, assessment: Assessment) -> TextTable:
    """What it is worth, its parameters, what came of the search: some thirty lines."""
    words = adequacy_words(assessment.adequacy)
    table = TextTable(
        _HEADS,
        tuple(_row(p) for p in shown_parameters(assessment) if p.free),
        above=(
            result.problem.spec.title,
            f"{words.mark} {words.sentence}",
            *(f"  – {reason}" for reason in words.reasons),
        ),
        below=tuple(_closing(result, assessment)),
        numbers=("value", "95 % interval"),
    )
    return reworded(result.problem.options.anatomy, table)


def _row(p: ParameterEstimate) -> tuple[str, ...]:
    text = estimate(p.value, p.trusted_sem, p.ci95)
    return p.name, text.value, text.interval, p.unit, str(p.verdict), p.meaning


def _closing(result: FitResult, assessment: Assessment) -> list[str]:
    fixed = [p for p in shown_parameters(assessment) if not p.free]
    lines = []
    if fixed:
        lines.append("fixed: " + ", ".join(f"{p.name} = {p.value:.4g}" for p in fixed))
    lines += [
        f"{each.name}: R² {percentage(each.r2)} %, VAF {percentage(each.vaf)} %, "
        f"RMSE {significant(each.rmse, 3)} Nm"
        for each in assessment.recordings
    ]
    lines.append(f"{result.status}: {result.message} ({result.seconds:.1f} s)")
    return lines
