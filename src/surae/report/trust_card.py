"""Whether a leg's numbers can be trusted, in words, and what to record next."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from surae.inference import Adequacy, AssessedFit, Assessment, Grade, Verdict
from surae.inference.judging.reasons import OF_OTHER_TRIALS
from surae.measures.agreement import said_of
from surae.measures.torque_curve import HeldPoint, Stretch
from surae.model.source_table import advice
from surae.nerve.leg import Nerve
from surae.quality import Quality
from surae.report import block
from surae.report.language import Words
from surae.report.leg_cards import PASSIVE, has_no_calf

#: Part of a second half's torque that the first must predict for anything to be said of it [%].
_PREDICTED = 70.0


def light(adequacy: Adequacy, reason: str, _: Words) -> block.AdequacyWords:
    """One light with one reason."""
    mark, text = {
        Grade.ADEQUATE: ("●", _("Yes: {reason}.", reason=reason)),
        Grade.DOUBTFUL: ("▲", _("With caution: {reason}.", reason=reason)),
        Grade.INADEQUATE: ("■", _("No: {reason}.", reason=reason)),
    }[adequacy.grade]
    return block.AdequacyWords(str(adequacy.grade), mark, text, ())


def trust(
    joint: AssessedFit | None,
    contradicted: Sequence[str],
    _: Words,
    *,
    alone: tuple[str, AssessedFit] | None = None,
    nerve: Nerve | None = None,
    doubt: str = "",
) -> tuple[block.Block, ...]:
    """One light with the reason that weighs most, and what to do about a trial that disagrees.

    `alone` is the trial that is followed where all together are not; without a fit of the leg,
    small movements are judged by what one half of them predicts of the other. `doubt` is why what
    was measured at rest is believed with caution.
    """
    if joint is None and nerve is not None and nerve.held_out is not None:
        return (_of_small_movements(nerve.held_out, _),)
    if joint is None:
        none = Adequacy(Grade.INADEQUATE, (), np.nan)
        return (light(none, _("there is no fit of this leg as a whole"), _),)
    result = joint.result
    assessment = joint.assessment
    adequacy = assessment.adequacy
    if adequacy.grade is Grade.ADEQUATE and contradicted:
        adequacy = replace(adequacy, grade=Grade.DOUBTFUL)
    reason = reason_of(assessment, contradicted, _)
    if doubt and adequacy.grade is Grade.ADEQUATE:
        adequacy, reason = replace(adequacy, grade=Grade.DOUBTFUL), doubt
    followed = _.many(
        "The model follows {r2} % of the torque’s changes in {n} trial.",
        "The model follows {r2} % of the torque’s changes in {n} trials.",
        len(result.problem.inputs),
        r2=_.number(f"{adequacy.r2:.1f}".replace("-", "−")),
    )
    other = [each for each in adequacy.against if each.code in OF_OTHER_TRIALS]
    advised = (block.Text(_(said_of(other[0]))),) if other else ()
    lines = [light(adequacy, reason, _), *advised, block.Text(followed)]
    if alone is not None:
        trial, fit = alone
        said = _(
            "{trial} alone is followed: {r2} % of its torque’s changes.",
            trial=trial,
            r2=_.number(f"{fit.assessment.adequacy.r2:.1f}"),
        )
        lines.append(block.Text(said))
    return tuple(lines)


def missed_trial(
    joint: AssessedFit | None, quality: Mapping[str, Quality], _: Words
) -> tuple[block.Block, ...]:
    """What was found in the torque or angle of a trial that is not followed, and what to do."""
    reasons = () if joint is None else joint.assessment.adequacy.against
    for reason in reasons:
        name = str(reason.values.get("trial", ""))
        if reason.code == "trial-not-followed" and name in quality:
            for each in quality[name].findings:
                if each.channel in ("torque", "angle") and each.severity != "info":
                    return (block.Text(_.finding(each), lead=f"{name}:"),)
    return ()


def _of_small_movements(predicted: float, _: Words) -> block.AdequacyWords:
    """Whether to trust what small movements alone tell: never without caution, no EMG is in it."""
    grade = Grade.DOUBTFUL if predicted >= _PREDICTED else Grade.INADEQUATE
    reason = _(
        "one half of the small movements predicts {part} % of the other’s torque",
        part=_.number(f"{max(predicted, 0.0):.0f}"),
    )
    return light(Adequacy(grade, (), np.nan), reason, _)


def reason_of(assessment: Assessment, contradicted: Sequence[str], _: Words) -> str:
    """The one reason that weighs most, in plain words: first what a trial by its name says."""
    against = assessment.adequacy.against
    if named := [each for each in against if each.code in OF_OTHER_TRIALS]:
        return _(named[0].plain)
    if missed := [each for each in against if each.code == "trial-not-followed" and each.is_grave]:
        return _("the model does not follow {trial}", trial=str(missed[0].values["trial"]))
    if contradicted and PASSIVE & set(contradicted):
        return _.many(
            "{n} value differs between trials",
            "{n} values differ between trials",
            len(contradicted),
        )
    if contradicted:
        return _.many(
            "{n} value differs between trials; stiffness is not affected",
            "{n} values differ between trials; stiffness is not affected",
            len(contradicted),
        )
    if bound := sum(p.at_bound and p.free for p in assessment.parameters.values()):
        return _.many(
            "{n} value reached its limit and can’t be trusted",
            "{n} values reached their limits and can’t be trusted",
            bound,
        )
    return _(against[0].plain) if against else _("nothing speaks against these numbers")


def next_trial(
    joint: AssessedFit | None, holds: Sequence[HeldPoint], stretches: Sequence[Stretch], _: Words
) -> tuple[block.Block, ...]:
    """What to record next, the plainest need first."""
    if not stretches and len(holds) < 3:
        text = _("One slow passive stretch over the whole range.")
    elif joint is not None and has_no_calf(joint):
        text = _("The same trials with EMG of the calf: soleus and both gastrocnemii.")
    else:
        weights: dict[str, float] = {}
        for p in joint.assessment.parameters.values() if joint is not None else ():
            if p.free and p.verdict is not Verdict.IDENTIFIED:
                for source, share in (p.budget or {}).items():
                    weights[source] = weights.get(source, 0.0) + share
        if not weights:
            return ()
        assert joint is not None
        largest = max(weights, key=lambda s: weights[s])
        text = _.sentence(advice(largest, joint.result.problem.settings.knowledge))
    return (block.Text(text, lead=_("What helps next:")),)
