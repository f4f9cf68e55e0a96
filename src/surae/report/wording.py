"""The plain-language summary and the adequacy: what may be taken from a fit, and what not."""

from surae.assessment import Assessment, Interval, Verdict
from surae.assessment.adequacy import Adequacy, Grade
from surae.estimation import FitResult
from surae.formatting import listed, percentage, significant
from surae.report.document import AdequacyWords
from surae.report.provenance import emphasis_text

#: A mark that is told from the others without colour, and what a grade means to the reader.
_WORDS = {
    Grade.ADEQUATE: (
        "✓",
        "Adequate: the model follows the torque’s changes (centred R² {r2} %), and nothing that "
        "was looked at speaks against its numbers.",
    ),
    Grade.DOUBTFUL: (
        "!",
        "Doubtful: read every value with the reasons below in mind (centred R² {r2} %).",
    ),
    Grade.INADEQUATE: (
        "✗",
        "Inadequate: no parameter of this fit counts as identified, whatever its interval says "
        "(centred R² {r2} %).",
    ),
}


def adequacy_words(adequacy: Adequacy) -> AdequacyWords:
    """Say what a fit is good for; the same words on screen, on paper and in the workbench."""
    mark, sentence = _WORDS[adequacy.grade]
    return AdequacyWords(
        grade=str(adequacy.grade),
        mark=mark,
        sentence=sentence.format(r2=percentage(adequacy.r2)),
        reasons=adequacy.reasons,
    )


#: Lower limit of a centred R² [%] and how such a model follows the torque's changes.
_CLOSENESS = (
    (99.0, "very closely"),
    (95.0, "closely"),
    (80.0, "only roughly"),
    (float("-inf"), "poorly"),
)
#: What is said of a fit that failed.
FAILED = (
    "The fit did not reach a minimum. The numbers in this report show where it stopped; they are "
    "not estimates."
)


def summary(result: FitResult, assessment: Assessment) -> tuple[str, ...]:
    """What to know before the numbers are used, one paragraph an entry."""
    if result.status == "failed":
        return (FAILED,)
    texts = [_advice(assessment), emphasis_text(result, assessment)]
    if result.family is None and len(result.starts) > 1 and result.agreeing == 1:
        texts.append(
            f"Only one of {len(result.starts)} starts reached this solution. There may be a better "
            "one: give more starts before relying on the values."
        )
    return tuple(text for text in texts if text)


def closeness(r2: float) -> str:
    """How closely a model with this centred R² [%] follows the torque, in words."""
    return next((word for limit, word in _CLOSENESS if r2 >= limit), "to an unknown degree")


def _advice(assessment: Assessment) -> str:
    """What to do about the parameters that are not identified; of an inadequate fit none is."""
    if assessment.adequacy.grade is Grade.INADEQUATE:
        return ""
    weak, bound, unknown = (
        [p.name for p in assessment.parameters.values() if p.verdict is verdict]
        for verdict in (Verdict.WEAK, Verdict.AT_BOUND, Verdict.UNDETERMINED)
    )
    texts = []
    if weak:
        texts.append(
            f"{listed(weak)}: an indication, not a measurement. Fix what is known otherwise, or "
            "measure a more informative movement."
        )
    if unknown:
        texts.append(f"This torque leaves {listed(unknown)} undetermined: fix what is known.")
    if bound:
        texts.append(
            f"{listed(bound)}: set by the bound, not by the data. See whether the bound is right, "
            "or fix the parameter."
        )
    return " ".join(texts)


def intervals(assessment: Assessment) -> str:
    """What the intervals allow for, and what not; empty where there is none."""
    if not any(p.ci95 for p in assessment.parameters.values()):
        return ""
    if assessment.interval is Interval.MARGINAL:
        return (
            f"The intervals are wide on purpose: {assessment.interval_note}. Constants taken from "
            "the literature, such as moment arms, and the zero of the angle are conditions of "
            "them, not in them."
        )
    if assessment.interval is Interval.THESIS:
        return (
            f"The intervals are those of white noise, equation (34): {assessment.interval_note}. "
            "They do not cover errors of the model itself."
        )
    return (
        f"The intervals and verdicts rest on the robust SEM, because {assessment.interval_note}; "
        f"the SEM of equation (34) is {_ratio(assessment)}. They do not cover errors of the model "
        "itself, which may also shift the values."
    )


def _ratio(assessment: Assessment) -> str:
    """How the standard errors of equation (34) compare with the robust ones."""
    ratios = sorted(
        p.sem_robust / p.sem for p in assessment.parameters.values() if p.sem and p.sem_robust
    )
    if not ratios:
        return "not to be had"
    middle = ratios[len(ratios) // 2]
    if middle >= 1:
        return f"too small by a factor of {significant(middle, 2)} (median of the parameters)"
    return f"too large by a factor of {significant(1 / middle, 2)} (median of the parameters)"
