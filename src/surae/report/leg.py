"""The first questions about a leg: how stiff, from what, whether it changed, can it be trusted."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.assessment import Assessment, Grade, Verdict
from surae.estimation import FitResult
from surae.formatting import of_interval, percentage, significant
from surae.measures import Measure, Measures, measures
from surae.measures.change import ChangeVerdict, Difference, compare_sessions
from surae.measures.compute import ANGLES
from surae.measures.curve import TorqueCurve, torque_curve
from surae.measures.leg import measured_range
from surae.measures.measured import HeldPoint, MeasuredSlope, Stretch, measured_slope, stretch
from surae.measures.norms import Norm, placed, read_norms
from surae.measures.quantity import quantities
from surae.model.joint import ANKLE
from surae.model.movement import gravity_torque
from surae.model.sources import SOURCES
from surae.report.document import (
    AdequacyWords,
    Block,
    PictureBlock,
    SectionBlock,
    TableBlock,
    TableCell,
    TextBlock,
    columns,
    paragraphs,
    rows_of,
)
from surae.report.figures import Figure
from surae.report.figures.leg import shares_bar, stiffness_figure
from surae.trials import Trial
from surae.units import FloatArray

AssessedFit = tuple[FitResult, Assessment]
#: The angle that stiffness is given at where it was measured [deg].
_AT = 10.0
#: What is compared between visits, chosen before any is seen: name, words, unit.
_COMPARED = (
    ("passive_stiffness", "Stiffness, relaxed", "Nm/°"),
    ("slow_torque", "Torque in a slow stretch", "Nm"),
    ("neutral_angle", "Angle at which relaxed muscles balance", "°"),
)
_PARTS = (
    ("tissue_share", "tissue"),
    ("neural_share", "muscle"),
    ("gravity_share", "weight"),
    ("inertia_share", "inertia"),
)
#: A share that is known no better than this cannot be separated from the others [% of the torque].
_UNSURE = 30.0
#: Parameters that the stiffness of a relaxed ankle rests on.
_PASSIVE = {"k_tri", "x0_tri", "k_tib", "x0_tib", "k_rel"}
_LIGHTS = {
    Grade.ADEQUATE: ("●", "Yes"),
    Grade.DOUBTFUL: ("▲", "With caution"),
    Grade.INADEQUATE: ("■", "No"),
}
#: Calf muscles among the channels of the EMG.
_CALF = slice(1, 4)


@dataclass(frozen=True, slots=True)
class LegAnswers:
    """The four answers as blocks, their figures by name, and the measures they rest on."""

    blocks: tuple[Block, ...]
    figures: Mapping[str, Figure]
    measures: Measures | None
    at: float  #: The angle of torque and stiffness [deg].


def leg_answers(
    trials: Sequence[Trial],
    fits: Mapping[str, AssessedFit],
    joint: AssessedFit | None,
    *,
    contradicted: Sequence[str] = (),
    before: AssessedFit | None = None,
) -> LegAnswers:
    """Answer the four questions of a leg.

    Parameters
    ----------
    trials : sequence of Trial
        All of the session.
    fits : mapping of str to (FitResult, Assessment)
        Of each trial by itself.
    joint : (FitResult, Assessment) or None
        Of all together, or of the only trial that was fitted.
    contradicted : sequence of str
        Parameters in which trials contradict each other.
    before : (FitResult, Assessment), optional
        Of an earlier visit.

    Returns
    -------
    LegAnswers
        Blocks of a report.
    """
    holds, stretches = _measured(trials, fits)
    of_fit, at = None, _angle(joint, holds, stretches)
    known = read_norms(joint=ANKLE if joint is None else joint[0].problem.options.anatomy)
    if joint is not None:
        angles = {at, *ANGLES, *(_point(norm) for norm in known)}
        of_fit = measures(*joint, sorted(angles))
    believed = of_fit is not None and not _PASSIVE & set(contradicted)
    m = None if of_fit is None else of_fit[f"passive_stiffness@{at:g}deg"]
    if m is None or not believed or not is_known(m):
        of_stiffness, zero, model = None, 0.0, None
    else:
        assert joint is not None
        of_stiffness, (zero, model) = of_fit, _model(*joint, holds, stretches)
    holds = [replace(h, torque=h.torque - zero) for h in holds]
    stretches = [Stretch(s.name, s.angle, s.loading - zero, s.unloading - zero) for s in stretches]
    figures: dict[str, Figure] = {}
    if model is not None or holds or stretches:
        norms = [(n, _point(n)) for n in known if n.measure.startswith("slow_torque@")]
        # a group's torque lies beside the leg's only where its zero is known
        healthy = [each for each in norms if "healthy" in each[0].group and model is not None]
        figures["stiffness"] = stiffness_figure(holds, stretches, model, healthy)
    slope = measured_slope(holds, stretches, at)
    against = None
    if model is not None and slope is not None and not _follows(model, holds, slope):
        against, of_stiffness = m, None
    cards = (
        SectionBlock("How stiff is it?", _stiff(of_stiffness, known, at, slope, zero, len(holds),
                                                len(stretches), against), "stiff", "card"),
        SectionBlock("Tissue, muscle or tendon?", _made_of(joint, of_fit, figures), "made", "card"),
        SectionBlock("Did it change?", change_blocks(before, joint), "change", "card"),
        SectionBlock("Can I trust it?", _trust(joint, contradicted, holds, stretches,
                                               follows=against is None), "trust", "card"),
    )  # fmt: skip
    return LegAnswers(cards, figures, of_fit, at)


def first_answer(trials: Sequence[Trial]) -> str:
    """What held angles say of stiffness before any fit, in a sentence; empty where nothing."""
    holds, _ = _measured(trials, {})
    slope = measured_slope(holds, (), _AT)
    return "" if slope is None else f"Measured slope of the relaxed ankle: {_slope(slope)}."


def _measured(
    trials: Sequence[Trial], fits: Mapping[str, AssessedFit]
) -> tuple[list[HeldPoint], list[Stretch]]:
    """Passive holds, and passive trials that move."""
    holds, stretches = [], []
    for trial in trials:
        if trial.effort != "passive":
            continue
        if trial.hold is not None:
            degrees = float(np.degrees(trial.hold.angle))
            holds.append(HeldPoint(trial.name, degrees, trial.hold.torque))
        elif trial.name in fits:
            (each,) = fits[trial.name][0].problem.inputs
            if each.torque is not None:
                stretches.append(stretch(trial.name, each.angle, each.velocity, each.torque))
    return holds, stretches


def _angle(
    joint: AssessedFit | None, holds: Sequence[HeldPoint], stretches: Sequence[Stretch]
) -> float:
    """Where stiffness is given: 10°, or the nearest of every 5° that was measured."""
    ends = [h.angle for h in holds] + [float(a) for s in stretches for a in s.angle[[0, -1]]]
    if joint is not None:
        ends += measured_range(joint[0])
    if not ends or min(ends) <= _AT <= max(ends):
        return _AT
    near = max(ends) if max(ends) < _AT else min(ends)
    return 5.0 * float(np.floor(near / 5.0) if near < _AT else np.ceil(near / 5.0))


def _model(
    result: FitResult,
    assessment: Assessment,
    holds: Sequence[HeldPoint],
    stretches: Sequence[Stretch],
) -> tuple[float, tuple[TorqueCurve, FloatArray]]:
    """The zero of the session's torque [Nm], and the model's curve with the foot's weight.

    The zero is one for all trials: the middle one of what passive trials measure beyond the model.
    """
    curve = torque_curve(result, assessment)
    weight = result.values.get("m", 0.0) * gravity_torque(
        angle=np.radians(curve.angle),
        theta_foot=result.problem.options.theta_foot,
        distance=result.problem.options.anatomy.distance,
    )
    whole = curve.passive.torque + weight
    beyond = [h.torque - float(np.interp(h.angle, curve.angle, whole)) for h in holds]
    for each in stretches:
        missed = each.torque - np.interp(each.angle, curve.angle, whole)
        beyond.append(float(np.nanmedian(missed)))
    zero = float(np.median(beyond)) if beyond else 0.0
    return zero, (curve, weight)


def _follows(
    model: tuple[TorqueCurve, FloatArray], holds: Sequence[HeldPoint], slope: MeasuredSlope
) -> bool:
    """Whether the model's torque rises over the held angles as what was measured at them."""
    if not slope.holds or slope.interval is None:
        return True
    angle = np.array([h.angle for h in holds])
    modelled = np.interp(angle, model[0].angle, model[0].passive.torque + model[1])
    away = angle - angle.mean()
    rise = float(away @ modelled / (away @ away))
    return slope.interval[0] <= rise <= slope.interval[1]


def _point(norm: Norm) -> float:
    return float(norm.measure.partition("@")[2].removesuffix("deg"))


def _stiff(
    of_fit: Measures | None, known: Sequence[Norm], at: float, slope: MeasuredSlope | None,
    zero: float, holds: int, stretches: int, against: Measure | None,
) -> tuple[Block, ...]:  # fmt: skip
    """One number: the model's where the recordings show it, else the measured slope.

    `against` is the model's where held angles contradict it.
    """
    m = None if of_fit is None else of_fit[f"passive_stiffness@{at:g}deg"]
    lines: list[Block] = []
    if of_fit is not None and m is not None and m.value is not None:
        text = of_interval(m.value, m.ci95)
        where = f"at {_where(at)}, relaxed · 95 %: {_span(text.interval)}"
        lines.append(TextBlock(where, "say", f"{text.value} Nm/°"))
        lines += paragraphs(
            f"{p.text} of {p.norm.group} lie below ({p.norm.reference})."
            for p in placed(of_fit, known)
        )
        if slope is not None:
            lines.append(TextBlock(f"Measured slope: {_slope(slope)}."))
    elif slope is not None:
        value, _, rest = _slope(slope).partition(" Nm/° ")
        lines.append(TextBlock(rest, "say", f"{value} Nm/°"))
        why = "The model cannot yet separate stiffness from the rest."
        if against is not None and against.value is not None:
            text = of_interval(against.value, against.ci95)
            why = (
                f"The model’s {text.value} Nm/° at {_where(at)} ({_span(text.interval)}) does not "
            )
            why += "agree with the held angles."
        lines.append(TextBlock(f"This is the measured slope, with the foot’s weight in it. {why}"))
    else:
        lines.append(TextBlock("", "say", "Not measured"))
        lines.append(
            TextBlock("Record one slow passive stretch, or hold the relaxed ankle at three angles.")
        )
    seen = [
        text
        for n, text in ((holds, _many(holds, "held angle")), (stretches, _many(stretches, "slow "
                        "stretch", "es")))
        if n
    ]  # fmt: skip
    caption = f"Measured: {' and '.join(seen)}." if seen else "No passive trial was recorded."
    if zero:
        caption += f" One zero of {significant(zero, 3)} Nm is taken off every trial."
    alt = "Measured torque of the relaxed ankle over its angle, with the model’s curve."
    lines.append(PictureBlock("stiffness", alt, caption, "here", 100))
    return tuple(lines)


def is_known(m: Measure) -> bool:
    """Whether a measure is known well enough to be shown as a number."""
    return m.ci95 is not None and m.verdict in (Verdict.IDENTIFIED, Verdict.WEAK)


def _slope(slope: MeasuredSlope) -> str:
    """A measured slope with what it was taken from."""
    text = f"{significant(slope.value, 2)} Nm/° from {significant(slope.low, 2)}° to "
    text += f"{significant(slope.high, 2)}°"
    if slope.interval is None:
        return f"{text}, {_many(slope.holds, 'held angle')}" if slope.holds else text
    low, high = (significant(end, 2) for end in slope.interval)
    if slope.holds:
        return f"{text}, {_many(slope.holds, 'held angle')} · 95 %: {low} to {high}"
    return f"{text}, in a slow stretch · {low} to {high} in both directions"


def _made_of(
    joint: AssessedFit | None, of_fit: Measures | None, figures: dict[str, Figure]
) -> tuple[Block, ...]:
    """The shares of the torque, where the recordings separate them."""
    if joint is None or of_fit is None:
        return (TextBlock("", "say", "Not known"), TextBlock("No fit of this leg could be made."))
    silent = [not np.ptp(each.emg[:, _CALF]) for each in joint[0].problem.inputs]
    if all(silent):
        return (
            TextBlock("", "say", "Cannot separate"),
            TextBlock(
                "No EMG of the calf was recorded, so its muscle and tissue look alike. Record "
                "soleus and both gastrocnemii."
            ),
            *_tendon(of_fit),
        )
    shares = [(words, of_fit[name]) for name, words in _PARTS]
    tissue, muscle = shares[0][1], shares[1][1]
    wide = [m for m in (tissue, muscle) if m.ci95 is None or m.ci95[1] - m.ci95[0] > 2 * _UNSURE]
    if wide or of_fit.adequacy.grade is Grade.INADEQUATE:
        why = "The recordings do not separate them" if wide else "The fit is not good enough"
        return (TextBlock("", "say", "Cannot separate"), TextBlock(f"{why}."), *_tendon(of_fit))
    parts = [(words, m.value or 0.0, m.ci95) for words, m in shares]
    figures["made"] = shares_bar(parts)
    largest = max(parts[:2], key=lambda part: part[1])
    headlines = {"tissue": "Mostly tissue", "muscle": "Mostly active muscle"}
    headline = headlines[largest[0]] if largest[1] > 50.0 else "Both tissue and muscle"
    numbers = " · ".join(
        f"{words} {value:.0f} % ({max(ci[0], 0):.0f} to {min(ci[1], 100):.0f})"
        for words, value, ci in parts
        if ci is not None and value >= 1.0
    )
    picture = PictureBlock("made", f"Shares of the torque: {numbers}", numbers, "here", 100)
    return (TextBlock("in these trials", "say", headline), picture, *_tendon(of_fit))


def _tendon(of_fit: Measures) -> tuple[Block, ...]:
    m = of_fit.get("tendon_strain_tri@500N")
    if m is None or not is_known(m) or m.value is None or m.ci95 is None:
        return (TextBlock("Tendon: not measured; film the muscle with ultrasound.", "note"),)
    text = of_interval(m.value, m.ci95)
    return (
        TextBlock(f"The calf’s tendon lengthens by {text.value} % at 500 N ({_span(text.interval)})"
                  ".", "note"),
    )  # fmt: skip


def change_blocks(before: AssessedFit | None, after: AssessedFit | None) -> tuple[Block, ...]:
    """What changed since another visit, in measures that are fixed beforehand."""
    if before is None or after is None:
        return (
            TextBlock("", "say", "One visit"),
            TextBlock("Choose another visit of this leg to compare with.", "choose"),
        )
    angle = _angle(after, (), ())
    names = [f"{n}@{angle:g}deg" if n != "neutral_angle" else n for n, _, _ in _COMPARED]
    sides = [quantities(*fit, [angle]) for fit in (before, after)]
    # fewer looks ask for smaller differences
    chosen = [
        replace(s, by_name=type(s.by_name)((n, s.by_name[n]) for n in names if n in s.by_name))
        for s in sides
    ]
    change = compare_sessions(chosen[0], chosen[1])
    rows = []
    for name, (_, words, unit) in zip(names, _COMPARED, strict=True):
        if (d := change.measures.get(name)) is not None:
            rows.append(_differing(d, f"{words}, {_where(angle)}" if "@" in name else words, unit))
    lead = change.measures.get(names[0])
    changed = [words for name, (_, words, _) in zip(names, _COMPARED, strict=True)
               if name in {d.name for d in change.changed}]  # fmt: skip
    if changed:
        headline, about = f"{changed[0]} changed", ""
    elif change.is_withheld:
        headline, about = "Cannot tell", "a fit is doubtful, so no change is claimed"
    elif all(d.verdict is ChangeVerdict.NOT_COMPARABLE for d in change.measures.values()):
        headline, about = "Cannot compare", ""
    else:
        headline, about = "Not shown", ""
    heads = columns("Measure", "Before", "After", "Change (95 %)", numbers=(1, 2), wide=(0,))
    blocks: list[Block] = [
        TextBlock(about, "say", headline),
        TableBlock("Three measures, fixed beforehand", heads, rows_of(rows), "small"),
    ]
    if lead is not None and lead.smallest is not None:
        blocks.append(
            TextBlock(
                "These two visits could have shown a change of stiffness of "
                f"{significant(lead.smallest, 2)} Nm/° or more."
            )
        )
    return tuple(blocks)


def _differing(d: Difference, words: str, unit: str) -> tuple[str | TableCell, ...]:
    sides = ["—" if v is None else significant(v, 2) for v in (d.before, d.after)]
    if d.difference is None or d.ci95 is None:
        return (f"{words} [{unit}]", *sides, "—")
    text = of_interval(d.difference, d.ci95)
    return (f"{words} [{unit}]", *sides, TableCell(text.value, under=_span(text.interval)))


def _trust(
    joint: AssessedFit | None,
    contradicted: Sequence[str],
    holds: Sequence[HeldPoint],
    stretches: Sequence[Stretch],
    *,
    follows: bool,
) -> tuple[Block, ...]:
    """One light, one reason, and the next trial to record."""
    if joint is None:
        mark, word = _LIGHTS[Grade.INADEQUATE]
        reason = "No fit of this leg could be made"
        light = AdequacyWords(str(Grade.INADEQUATE), mark, f"{word}: {reason}.", ())
        return (light, *_next_trial(None, holds, stretches))
    result, assessment = joint
    grade = assessment.adequacy.grade
    if grade is Grade.ADEQUATE and (contradicted or not follows):
        grade = Grade.DOUBTFUL
    mark, word = _LIGHTS[grade]
    why = "the model’s stiffness does not agree with the held angles"
    reason = _reason(assessment, contradicted) if follows else why
    light = AdequacyWords(str(grade), mark, f"{word}: {reason}.", ())
    r2 = TextBlock(
        f"The model follows {percentage(assessment.adequacy.r2)} % of the torque’s changes in "
        f"{_many(len(result.problem.inputs), 'trial')}."
    )
    return (light, r2, *_next_trial(joint, holds, stretches))


def _reason(assessment: Assessment, contradicted: Sequence[str]) -> str:
    """The one reason that weighs most, in plain words."""
    reasons = assessment.adequacy.reasons
    bound = sum(p.at_bound and p.free for p in assessment.parameters.values())
    others = [reason for reason in reasons if " at a bound" not in reason]
    if contradicted:
        return f"trials disagree about {_many(len(contradicted), 'value')}; see Research"
    if bound:
        verb = "value" if bound == 1 else "values"
        return f"{_count(bound)} {verb} reached the limit and can’t be trusted"
    return others[0] if others else "nothing speaks against these numbers"


def _next_trial(
    joint: AssessedFit | None, holds: Sequence[HeldPoint], stretches: Sequence[Stretch]
) -> tuple[Block, ...]:
    """What to record next, the plainest need first."""
    if not stretches and len(holds) < 3:
        text = "one slow passive stretch over the whole range."
    elif joint is not None and all(
        not np.ptp(each.emg[:, _CALF]) for each in joint[0].problem.inputs
    ):
        text = "the same trials with EMG of the calf: soleus and both gastrocnemii."
    else:
        weights: dict[str, float] = {}
        for p in joint[1].parameters.values() if joint is not None else ():
            if p.free and p.verdict is not Verdict.IDENTIFIED:
                for source, share in (p.budget or {}).items():
                    weights[source] = weights.get(source, 0.0) + share
        if not weights:
            return ()
        text = SOURCES[max(weights, key=lambda s: weights[s])].remedy.en
    return (TextBlock(text, lead="Record next:"),)


def _where(degrees: float) -> str:
    if degrees == 0.0:
        return "0°"
    return f"{abs(degrees):g}° {'dorsiflexion' if degrees > 0 else 'plantarflexion'}"


def _span(interval: str) -> str:
    return interval.replace(" … ", " to ")


def _many(count: int, noun: str, ending: str = "s") -> str:
    return f"{count} {noun}{'' if count == 1 else ending}"


def _count(number: int) -> str:
    words = ("No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine")
    return words[number].lower() if number < len(words) else str(number)
