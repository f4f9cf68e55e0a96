"""The plain-language summary and the adequacy: what may be taken from a fit, and what not."""

from collections.abc import Sequence

from surae.base.formatting import percentage
from surae.inference import AssessedFit, Assessment, Interval
from surae.inference.judging.assessed import outdated
from surae.inference.judging.grade import Adequacy, Grade
from surae.quality import Quality
from surae.report import block
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


#: What is said in place of the above where recordings have findings that stop nothing.
_WITH_WARNINGS = (
    "Adequate: the model follows the torque’s changes (centred R² {r2} %). Look first at what the "
    "checks warn of: {codes}."
)


def adequacy_words(adequacy: Adequacy, quality: Sequence[Quality] = ()) -> block.AdequacyWords:
    """Say what a fit is good for; the same words on screen, on paper and in the workbench.

    `quality` is what was found in its recordings: that nothing speaks against it is to be earned.
    """
    mark, sentence = _WORDS[adequacy.grade]
    warned = [f.code for trial in quality for f in trial.findings if f.severity != "info"]
    if adequacy.grade is Grade.ADEQUATE and warned:
        sentence = _WITH_WARNINGS
    return block.AdequacyWords(
        grade=str(adequacy.grade),
        mark=mark,
        sentence=sentence.format(
            r2=percentage(adequacy.r2), codes=", ".join(dict.fromkeys(warned))
        ),
        reasons=adequacy.reasons,
    )


#: What is said of a fit that failed.
FAILED = (
    "The fit did not reach a minimum. The numbers in this report show where it stopped; they are "
    "not estimates."
)


def summary(fit: AssessedFit) -> tuple[str, ...]:
    """What to know before the numbers are used, one paragraph an entry."""
    if fit.result.status == "failed":
        return (FAILED,)
    texts = [outdated(fit.assessment), emphasis_text(fit)]
    if fit.result.solution.is_alone:
        starts = len(fit.result.solution.starts)
        texts.append(
            f"Only one of {starts} starts reached this solution. There may be a better one: give "
            "more starts before relying on the values."
        )
    return tuple(text for text in texts if text)


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
        f"The intervals and verdicts rest on the robust SEM, because {assessment.interval_note}. "
        "They do not cover errors of the model itself, which may also shift the values."
    )
