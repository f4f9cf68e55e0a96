"""Whether the data speak for rigid or compliant tendons: the rule, the sentence, what changes."""

import math
from collections.abc import Mapping, Sequence

from surae.assessment.adequacy import Grade
from surae.assessment.assess import Assessment
from surae.assessment.comparison.finding import ModelScore, ParameterChange, TendonEvidence, best_of

#: Difference of AICc that decides, and up to which models are as good as each other
#: (Burnham & Anderson 2002: essentially no support beyond 10, substantial support within 2).
DECISIVE, EQUAL = 10.0, 2.0
#: Standard errors by which a held-out VAF must be better: the one-standard-error rule of
#: cross-validation (Hastie, Tibshirani & Friedman 2009, section 7.10). It asks that the gain is
#: common to the folds; whether it is real, the AICc has to say.
BEYOND = 1.0
#: VAF [%] below which a model's own faults are large enough to be mistaken for a tendon.
_MODERATE = 95.0

RULE = (
    "Compliance is supported when the best muscle-tendon model's AICc, with the effective number "
    f"of samples, is more than {DECISIVE:g} below the rigid model's, and its held-out VAF is "
    "higher by more than the standard error of that difference over the folds. A rigid tendon "
    f"suffices when no muscle-tendon model's AICc is more than {EQUAL:g} below the rigid model's, "
    "the best of them does not predict held-out data better by more than the standard error, and "
    f"one of them is worse by more than {DECISIVE:g}, so that the data do see the tendon. "
    "Otherwise the data cannot tell; nor can they where the model they would speak for is "
    "inadequate, or where both are held back by bounds."
)


def conclude(scores: Sequence[ModelScore]) -> tuple[TendonEvidence | None, str]:
    """The finding and its sentence, from complete scores of at least one model of each kind.

    There is no evidence where the fit of the rigid model, or of every compliant one, failed.
    """
    rigid, best = best_of(scores, rigid=True), best_of(scores, rigid=False)
    if rigid is None or best is None or rigid.aicc is None or best.aicc is None:
        return _without_figures(scores)
    compliant = [s.aicc for s in scores if not s.rigid and s.aicc is not None]
    lower = rigid.aicc - best.aicc
    tells_tendons = max(compliant) - rigid.aicc > DECISIVE
    if best.held_out is None:
        return TendonEvidence.OPEN, (
            f"The data cannot tell: {best.model} has an AICc {_difference(lower)} than the rigid "
            f"model's, but held-out data could not be predicted ({best.held_out_note})."
        )
    gain, error = best.held_out.gain, best.held_out.gain_se
    better = gain > BEYOND * error
    figures = (
        f"the best muscle-tendon model, {best.model}, has an AICc {_difference(lower)} than the "
        f"rigid model's and predicts held-out data {_gain(gain, error)}"
    )
    withheld = _withheld(rigid, best, best if lower > DECISIVE and better else rigid)
    if withheld:
        return TendonEvidence.OPEN, f"The data cannot tell: {figures}, but {withheld}."
    if lower > DECISIVE and better:
        return TendonEvidence.COMPLIANT, f"Compliance is supported: {figures}."
    if lower <= EQUAL and not better and tells_tendons:
        return TendonEvidence.RIGID, f"A rigid tendon suffices: {figures}."
    why = "that is not enough, or contradictory"
    if lower <= EQUAL and not better:
        why = (
            "rigid and compliant tendons give nearly the same torque here. Larger forces or a "
            "model with a fixed tendon (muscle-tendon) may tell"
        )
    return TendonEvidence.OPEN, f"The data cannot tell: {figures}; {why}."


def _withheld(rigid: ModelScore, best: ModelScore, favoured: ModelScore) -> str:
    """Why figures of these two mean nothing; empty where they do."""
    if favoured.adequacy.grade is Grade.INADEQUATE:
        return f"{favoured.model} is inadequate: {favoured.adequacy.reasons[0]}"
    if rigid.at_bound and best.at_bound:
        return (
            f"both are held back by bounds, {rigid.model} by {', '.join(rigid.at_bound)}, "
            f"{best.model} by {', '.join(best.at_bound)}"
        )
    return ""


def _without_figures(scores: Sequence[ModelScore]) -> tuple[TendonEvidence | None, str]:
    """What is said where no model of one kind has an AICc."""
    fitted = {s.rigid for s in scores if s.status != "failed"}
    if fitted == {True, False}:
        return TendonEvidence.OPEN, (
            "The data cannot tell: they hold too few independent samples for the parameters of the "
            "models; give longer or more recordings."
        )
    bare = "every muscle-tendon" if True in fitted else "the rigid"
    return None, f"No conclusion: the fit of {bare} model failed."


def cautions(scores: Sequence[ModelScore], loss: str | None = None) -> tuple[str, ...]:
    """What weakens a conclusion, one sentence each."""
    sentences = [f"{s.model}: the fit failed: {s.message}." for s in scores if s.status == "failed"]
    sentences += [
        f"{s.model} is held back by the bounds of {', '.join(s.at_bound)}."
        for s in scores
        if s.at_bound and s.status != "failed"
    ]
    vafs = [s.vaf for s in scores if s.vaf is not None]
    if vafs and max(vafs) < _MODERATE:
        sentences.append(
            f"Even the best model accounts for only {max(vafs):.1f} % of the torque: what every "
            "model lacks may be mistaken for a tendon, or hide one."
        )
    if loss is not None:
        sentences.append(
            "AICc counts outliers as the model with the least noise does; held-out data count "
            "them fully."
        )
    return tuple(sentences)


def _difference(lower: float) -> str:
    return f"{abs(lower):.1f} {'lower' if lower >= 0 else 'higher'}"


def _gain(gain: float, error: float) -> str:
    return f"{'better' if gain >= 0 else 'worse'} by {abs(gain):.2g} ± {error:.2g} % VAF"


def changes(
    scores: Sequence[ModelScore], worth: Mapping[str, Assessment]
) -> tuple[ParameterChange, ...]:
    """Parameters that leave their 95 % intervals when the tendons are no longer rigid.

    `worth` is of the fits to all data, by model. The largest relative change comes first; a
    parameter without interval in either fit is left out.
    """
    rigid = best_of(scores, rigid=True)
    if rigid is None:
        return ()
    changed = [
        change
        for score in scores
        if not score.rigid and score.aicc is not None
        for change in _changed(score.model, worth[rigid.model], worth[score.model])
    ]
    return tuple(sorted(changed, key=lambda c: -math.inf if c.percent is None else -abs(c.percent)))


def _changed(model: str, rigid: Assessment, compliant: Assessment) -> list[ParameterChange]:
    changed = []
    for name, before in rigid.parameters.items():
        after = compliant.parameters.get(name)
        if after is None or not (before.free and after.free):
            continue
        widths = [(p.ci95[1] - p.ci95[0]) / 2 for p in (before, after) if p.ci95 is not None]
        half = max(widths, default=math.inf)
        change = after.value - before.value
        if abs(change) > half:
            percent = 100 * change / before.value if before.value else None
            changed.append(
                ParameterChange(model, name, after.unit, before.value, after.value, percent, half)
            )
    return changed
