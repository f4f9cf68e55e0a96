"""The plain-language summary and the adequacy: what may be taken from a fit, and what not."""

from surae.assessment import Assessment, Interval, ParameterEstimate, Verdict
from surae.assessment.adequacy import Adequacy, Grade
from surae.assessment.parameter import IDENTIFIED
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


def summary(result: FitResult, assessment: Assessment, rms: float) -> tuple[str, ...]:
    """The summary, one paragraph an entry.

    `rms` is the root mean square of the measured torque of all recordings [Nm].
    """
    if result.status == "failed":
        return (FAILED,)
    texts = [
        _following(result, assessment, rms),
        _counted(assessment),
        emphasis_text(result, assessment),
        _intervals(assessment),
    ]
    if result.family is None and len(result.starts) > 1 and result.agreeing == 1:
        texts.append(
            f"Only one of {len(result.starts)} starts reached this solution. There may be a better "
            "one: give more starts before relying on the values."
        )
    return tuple(text for text in texts if text)


def caution(result: FitResult, assessment: Assessment) -> str:
    """What to know before reading the parameter table; empty where there is nothing."""
    if result.status == "failed":
        return FAILED
    if assessment.interval is not Interval.ROBUST:
        return ""
    return (
        f"Intervals and verdicts rest on the robust SEM, because {assessment.interval_note}; the "
        f"SEM of equation (34) is {_ratio(assessment)}."
    )


def closeness(r2: float) -> str:
    """How closely a model with this centred R² [%] follows the torque, in words."""
    return next((word for limit, word in _CLOSENESS if r2 >= limit), "to an unknown degree")


def _following(result: FitResult, assessment: Assessment, rms: float) -> str:
    r2 = assessment.adequacy.r2
    return (
        f"The {result.problem.spec.title} follows the changes of the measured torque "
        f"{closeness(r2)}: it explains {_in_words(r2)} % of their variance (centred R²). Of the "
        f"torque’s mean square, its mean included, it accounts for {_in_words(assessment.vaf)} % "
        f"(VAF). What it misses is {significant(assessment.rmse, 3)} Nm, where the torque itself "
        f"is {significant(rms, 3)} Nm (both root mean square)."
    )


def _in_words(vaf: float) -> str:
    return percentage(vaf).replace("> ", "more than ")


def _counted(assessment: Assessment) -> str:
    """How many parameters are known, and what to do about the others."""
    free = [p for p in assessment.parameters.values() if p.free]
    identified = _of(assessment, Verdict.IDENTIFIED)
    bound = _of(assessment, Verdict.AT_BOUND)
    weak = _of(assessment, Verdict.WEAK)
    unknown = [p.name for p in _of(assessment, Verdict.UNDETERMINED)]
    limit = f"a 95 % interval within ±{100 * IDENTIFIED:g} % of the value"
    if assessment.adequacy.grade is Grade.INADEQUATE:
        text = f"No parameter is identified, not even with {limit}: the fit is inadequate."
    else:
        text = f"{_share(len(identified), len(free))} identified, which takes {limit}."
    if weak:
        subject = "The weak one is" if len(weak) == 1 else f"The {len(weak)} weak ones are"
        text += (
            f" {subject} an indication, not a measurement: fix what is known otherwise, or measure "
            "a more informative movement."
        )
    if unknown:
        text += f" This torque leaves {listed(unknown)} undetermined: fix what is known."
    if bound:
        subject = (
            "The value at a bound was" if len(bound) == 1 else
            f"The {len(bound)} values at a bound were"
        )  # fmt: skip
        text += (
            f" {subject} set by the bound, not by the data: see whether the bound is right, or fix "
            "the parameter."
        )
    adequate = assessment.adequacy.grade is not Grade.INADEQUATE
    if assessment.interval is Interval.MARGINAL and adequate:
        repeatable = sum(p.repeatable for p in free)
        text += (
            f" {_share(repeatable, len(free))} repeatable: a second trial of this leg "
            "should give the same value, and both could be biased."
        )
    if weak or unknown or bound:
        text += " The parameter table says what to do about each."
    return text


def _intervals(assessment: Assessment) -> str:
    """What the intervals allow for."""
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
    if all(whiteness.white for whiteness in assessment.whiteness):
        return (
            f"The intervals and verdicts rest on the robust SEM, because "
            f"{assessment.interval_note}. They do not cover errors of the model itself."
        )
    worst = max(assessment.whiteness, key=lambda w: w.statistic)
    return (
        "The residuals are not white noise: neighbouring samples correlate by "
        f"{significant(worst.lag1, 2)}, and it takes {significant(worst.fall_s, 2)} s to fall to "
        "the level of white noise. The intervals and verdicts allow for that; the standard errors "
        f"of equation (34), which assume white noise, are {_ratio(assessment)}. What correlates "
        "may be something that the model leaves out; that may also shift the values, which no "
        "interval covers."
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


def _of(assessment: Assessment, verdict: Verdict) -> list[ParameterEstimate]:
    return [p for p in assessment.parameters.values() if p.verdict is verdict]


def _share(part: int, whole: int) -> str:
    """The beginning of a sentence about some of all estimated parameters."""
    if part == whole:
        return f"All {whole} estimated parameters are" if whole > 1 else "The one parameter is"
    verb = "is" if part == 1 else "are"
    return f"{part or 'None'} of the {whole} estimated parameters {verb}"
