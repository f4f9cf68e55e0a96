"""The first questions about a leg: how stiff, from what, whether it changed, can it be trusted."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.base.frozen import FrozenDict
from surae.base.units import FloatArray
from surae.inference import AssessedFit, Grade
from surae.inference.judging.reasons import OF_OTHER_TRIALS, OF_STIFFNESS, Reason
from surae.measures import Measures, measures
from surae.measures.change.compare import compare_sessions
from surae.measures.change.result import Change
from surae.measures.compared import Quantities, common_end, quantities
from surae.measures.fitted_leg import measured_range
from surae.measures.norms import Norm, read_norms
from surae.measures.points import ANGLES
from surae.measures.table import LEADING
from surae.measures.torque_curve import (
    HeldPoint,
    Stretch,
    TorqueCurve,
    measured_slope,
    stretch,
    torque_curve,
    weight_torque,
)
from surae.measures.working import WorkingStiffness, working_stiffness
from surae.model.joint import ANKLE
from surae.nerve.leg import Nerve
from surae.quality import Quality
from surae.report import block, leg_cards
from surae.report.figures import Figure
from surae.report.figures.leg import shares_bar, stiffness_figure
from surae.report.language import Words
from surae.report.nerve_card import nerve_card, stiffness_of
from surae.report.rest_card import rest_card, stated_angle
from surae.report.trust_card import missed_trial, next_trial, trust
from surae.report.working_card import working_card
from surae.trials import Trial

#: The angle that stiffness is given at where it was measured [deg].
AT = 10.0
#: What says of a fit that its trials are not followed, and not that they are of several legs.
_NOT_FOLLOWED = ("not-followed", "trial-not-followed")


@dataclass(frozen=True, slots=True)
class LegAnswers:
    """The answers as sections, their figures by name, and the measures they rest on."""

    cards: tuple[block.Section, ...]
    figures: Mapping[str, Figure]
    measures: Measures | None
    at: float  #: The angle of torque and stiffness [deg].
    numbers: Measures | None  #: Those for readers: of all trials, or `of` the one that is followed.
    of: str  #: The trial; empty: all.
    zero: float  #: What the torque's zero is off by, in all trials [Nm]; 0 where that is not known.


def leg_answers(
    trials: Sequence[Trial],
    fits: Mapping[str, AssessedFit],
    joint: AssessedFit | None,
    _: Words,
    *,
    contradicted: Sequence[str] = (),
    before: AssessedFit | None = None,
    nerve: Nerve | None = None,
    quality: Mapping[str, Quality] = FrozenDict(),
) -> LegAnswers:
    """Answer the questions of a leg; how much is nerve where that was measured.

    `fits` are of each trial by itself, `joint` of all together or of the only trial that was
    fitted, `before` of an earlier visit; in `contradicted` parameters trials contradict each other.
    `quality` is what was found in each trial.
    """
    holds, stretches = _measured(trials, fits)
    of_fit = None
    at = angle_of(joint, holds, stretches)
    known = read_norms(joint=ANKLE if joint is None else joint.result.problem.options.anatomy)
    if joint is not None:
        angles = {at, *ANGLES, *(_point(norm) for norm in known)}
        of_fit = measures(joint, sorted(angles))
        at = stated_angle(of_fit, at)
    alone = followed_alone(joint, fits)
    m = None if of_fit is None else of_fit[LEADING[0]]
    disputed = None if joint is None else disputes(joint)
    answered = m is not None and (leg_cards.is_known(m) or (disputed and m.ci95 is not None))
    believed = answered and (disputed or not leg_cards.PASSIVE & set(contradicted))
    model = torque_curve(joint) if joint is not None and believed else None
    if joint is not None and model is not None:  # what was measured, as the curve and norms are
        result = joint.result
        holds, stretches = _without(lambda at: weight_torque(result, at), holds, stretches)
    zero = 0.0 if model is None else _zero(model, holds, stretches)
    holds, stretches = _without(lambda _: zero, holds, stretches)
    slope = measured_slope(holds, stretches, at)
    if m is not None and of_fit is not None and model is not None and disputed is None:
        stiff = leg_cards.modelled_stiffness(m, of_fit, known, slope, _)
    elif slope is None and (evoked := stiffness_of(nerve, _)):
        stiff = evoked
    else:
        stiff = leg_cards.measured_stiffness(
            slope, m, disputed, _, without_weight=model is not None
        )
    made, parts = _made(joint, of_fit, alone, _, disputed=disputed is not None)
    leads = None if of_fit is None else of_fit.get(f"slow_stiffness@{at:g}deg")
    change = None if joint is None or before is None else compared(before, joint)
    nerves, figures = nerve_card(nerve, _)
    if model is not None or holds or stretches:
        # a group's torque lies beside the leg's only where its zero is known
        among = of_fit if model is not None and disputed is None else None
        figures["stiffness"] = _over_angle(holds, stretches, model, known, among, _)
    if any(each.kind == "picture" for each in made):
        figures["made"] = shares_bar([(_(name), value, ci) for name, value, ci in parts])
    picture = leg_cards.stiffness_picture(
        len(holds), len(stretches), zero, _, without_weight=model is not None
    )
    by_rest = None if joint is None or of_fit is None else rest_card(joint, of_fit, at, known, _)
    if by_rest is not None:
        stiff, picture = by_rest.said, by_rest.picture
        figures["stiffness"] = by_rest.figure
    if "stiffness" not in figures and (worked := _at_work(trials, fits)) is not None:
        by_work = working_card(*worked, _)
        picture = by_work.picture
        figures["stiffness"] = by_work.figure
        if nerve is None or nerve.stiffness is None:
            stiff = by_work.said
    sections = (
        (_("How stiff is it?"), (*stiff, picture), "stiff"),
        (_("Tissue, muscle or tendon?"), made, "made"),
        (_("Did it change?"), leg_cards.change_card(change, _, leads, nerve), "change"),
        (
            _("Can I trust it?"),
            (
                *trust(
                    joint,
                    contradicted,
                    _,
                    alone=alone,
                    nerve=nerve,
                    doubt="" if by_rest is None else by_rest.doubt,
                ),
                *missed_trial(joint, quality, _),
                *next_trial(joint, holds, stretches, _),
            ),
            "trust",
        ),
        (_("How much is nerve?"), nerves, "nerve"),
    )
    return LegAnswers(
        tuple(block.Section(*card, "card") for card in sections),
        figures,
        of_fit,
        at,
        of_fit if alone is None else measures(alone[1], sorted({at, *ANGLES})),
        "" if alone is None else alone[0],
        zero,
    )


def _over_angle(
    holds: Sequence[HeldPoint],
    stretches: Sequence[Stretch],
    model: TorqueCurve | None,
    known: Sequence[Norm],
    of_fit: Measures | None,
    _: Words,
) -> Figure:
    """Torque at rest over the angle, healthy legs behind it where this one stands `among` them."""
    norms = [(n, _point(n)) for n in known if n.measure.startswith("slow_torque@")]
    healthy = [each for each in norms if "healthy" in each[0].group and of_fit is not None]
    of_leg = [(at, of_fit[norm.measure]) for norm, at in healthy if of_fit is not None]
    return stiffness_figure(holds, stretches, model, healthy, of_leg, _)


def _made(
    joint: AssessedFit | None,
    of_fit: Measures | None,
    alone: tuple[str, AssessedFit] | None,
    _: Words,
    *,
    disputed: bool,
) -> tuple[tuple[block.Block, ...], list[leg_cards.Part]]:
    """What the torque is made of, of all trials, or of the one that is followed `alone`."""
    if alone is not None:
        trial, fit = alone
        of_trial = measures(fit, ANGLES)
        if parts := leg_cards.parts_of(of_trial):
            where = _("in {trial} alone", trial=trial)
            return leg_cards.made_of(fit, of_trial, parts, _, where=where), parts
    parts = [] if of_fit is None else leg_cards.parts_of(of_fit)
    return leg_cards.made_of(joint, of_fit, parts, _, disputed=disputed), parts


def followed_alone(
    joint: AssessedFit | None, fits: Mapping[str, AssessedFit]
) -> tuple[str, AssessedFit] | None:
    """The trial that its own fit follows best where the fit of all does not; None where none does.

    What it says holds of that trial. Where trials contradict each other there is none: which of
    them is of the leg is then what is asked.
    """
    if joint is None or len(fits) < 2:
        return None
    adequacy = joint.assessment.adequacy
    codes = {reason.code for reason in adequacy.against if reason.is_grave}
    if adequacy.grade is not Grade.INADEQUATE or not codes or codes - set(_NOT_FOLLOWED):
        return None
    if any(reason.code in OF_OTHER_TRIALS for reason in adequacy.against):
        return None
    of_each = {name: fit.assessment.adequacy for name, fit in fits.items()}
    sound = [name for name, each in of_each.items() if each.grade is not Grade.INADEQUATE]
    best = max(sound, key=lambda name: of_each[name].r2, default=None)
    return None if best is None else (best, fits[best])


def _at_work(
    trials: Sequence[Trial], fits: Mapping[str, AssessedFit]
) -> tuple[str, WorkingStiffness] | None:
    """The trial whose steps load the ankle least, as walking beside running, and what they tell."""
    steps_of = [
        (trial.name, steps)
        for trial in trials
        if trial.effort == "active" and trial.name in fits
        for inputs in fits[trial.name].result.problem.inputs
        if (steps := working_stiffness(inputs)) is not None
    ]
    return min(steps_of, key=lambda each: each[1].peak, default=None)


def first_answer(trials: Sequence[Trial], _: Words) -> str:
    """What held angles say of stiffness before any fit, in a sentence; empty where nothing."""
    held = measured_slope(_measured(trials, {})[0], (), AT)
    if held is None:
        return ""
    return _("Measured slope of the relaxed ankle: {slope}.", slope=leg_cards.slope_text(held, _))


def compared(
    before: AssessedFit,
    after: AssessedFit,
    *,
    baselines: Sequence[AssessedFit] = (),
    legs: bool = False,
) -> Change:
    """The three measures that two visits, or two legs, are compared in.

    `baselines` are visits from before anything changed.
    """
    end = common_end(fit.result for fit in (before, after, *baselines))
    sides = [fixed_quantities(fit, end) for fit in (before, after, *baselines)]
    return compare_sessions(sides[0], sides[1], sides[2:], legs=legs)


def fixed_quantities(fit: AssessedFit, end: float) -> Quantities:
    """What visits are compared in, over the range up to `end` [deg]: few looks find more."""
    return quantities(fit, ANGLES[:1], end, leg_cards.COMPARED)


def _measured(
    trials: Sequence[Trial], fits: Mapping[str, AssessedFit]
) -> tuple[list[HeldPoint], list[Stretch]]:
    """Passive holds, and passive trials that move."""
    holds = []
    stretches = []
    for trial in trials:
        if trial.effort != "passive":
            continue
        if trial.hold is not None:
            degrees = float(np.degrees(trial.hold.angle))
            holds.append(HeldPoint(trial.name, degrees, trial.hold.torque))
        elif trial.name in fits:
            for each in fits[trial.name].result.problem.inputs:
                if each.torque is not None:
                    stretches.append(stretch(each.name, each.angle, each.velocity, each.torque))
    return holds, stretches


def angle_of(
    joint: AssessedFit | None, holds: Sequence[HeldPoint] = (), stretches: Sequence[Stretch] = ()
) -> float:
    """Where stiffness is given: 10°, or the nearest of every 5° that was measured."""
    ends = [h.angle for h in holds] + [float(a) for s in stretches for a in s.angle[[0, -1]]]
    if joint is not None:
        ends += measured_range(joint.result)
    if not ends or min(ends) <= AT <= max(ends):
        return AT
    near = max(ends) if max(ends) < AT else min(ends)
    return 5.0 * float(np.floor(near / 5.0) if near < AT else np.ceil(near / 5.0))


def _without(
    torque: Callable[[FloatArray], FloatArray | float],
    holds: Sequence[HeldPoint],
    stretches: Sequence[Stretch],
) -> tuple[list[HeldPoint], list[Stretch]]:
    """What was measured without a torque [Nm], a function of the angle [deg]."""
    return (
        [replace(h, torque=h.torque - float(torque(np.array(h.angle)))) for h in holds],
        [
            replace(s, loading=s.loading - torque(s.angle), unloading=s.unloading - torque(s.angle))
            for s in stretches
        ],
    )


def _zero(model: TorqueCurve, holds: Sequence[HeldPoint], stretches: Sequence[Stretch]) -> float:
    """The zero of the session's torque [Nm]: the median of what passive trials measure beyond."""
    beyond = [h.torque - float(np.interp(h.angle, model.angle, model.torque)) for h in holds]
    for each in stretches:
        missed = each.torque - np.interp(each.angle, model.angle, model.torque)
        beyond.append(float(np.nanmedian(missed)))
    return float(np.median(beyond)) if beyond else 0.0


def disputes(fit: AssessedFit) -> Reason | None:
    """What trials at rest say against the stiffness of a leg's fit, first; None where nothing."""
    reasons = fit.assessment.adequacy.against
    return next((reason for reason in reasons if reason.code in OF_STIFFNESS), None)


def _point(norm: Norm) -> float:
    return float(norm.measure.partition("@")[2].removesuffix("deg"))
