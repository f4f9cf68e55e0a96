"""The first questions about a leg: how stiff, from what, whether it changed, can it be trusted."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.base.units import FloatArray
from surae.inference import AssessedFit
from surae.inference.judging.reasons import OF_STIFFNESS, Reason
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
from surae.model.joint import ANKLE
from surae.nerve.leg import Nerve
from surae.report import block, leg_cards
from surae.report.figures import Figure
from surae.report.figures.leg import shares_bar, stiffness_figure
from surae.report.language import Words
from surae.report.nerve_card import nerve_card, stiffness_of
from surae.report.rest_card import rest_card, stated_angle
from surae.trials import Trial

#: The angle that stiffness is given at where it was measured [deg].
AT = 10.0


@dataclass(frozen=True, slots=True)
class LegAnswers:
    """The answers as sections, their figures by name, and the measures they rest on."""

    cards: tuple[block.Section, ...]
    figures: Mapping[str, Figure]
    measures: Measures | None
    at: float  #: The angle of torque and stiffness [deg].
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
) -> LegAnswers:
    """Answer the questions of a leg; how much is nerve where that was measured.

    `fits` are of each trial by itself, `joint` of all together or of the only trial that was
    fitted, `before` of an earlier visit; in `contradicted` parameters trials contradict each other.
    """
    holds, stretches = _measured(trials, fits)
    of_fit = None
    at = angle_of(joint, holds, stretches)
    known = read_norms(joint=ANKLE if joint is None else joint.result.problem.options.anatomy)
    if joint is not None:
        angles = {at, *ANGLES, *(_point(norm) for norm in known)}
        of_fit = measures(joint, sorted(angles))
        at = stated_angle(of_fit, at)
    m = None if of_fit is None else of_fit[LEADING[0]]
    disputed = None if joint is None else disputes(joint)
    told = m is not None and (leg_cards.is_known(m) or (disputed and m.ci95 is not None))
    believed = told and (disputed or not leg_cards.PASSIVE & set(contradicted))
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
    parts = [] if of_fit is None else leg_cards.parts_of(of_fit)
    made = leg_cards.made_of(joint, of_fit, parts, _, disputed=disputed is not None)
    leads = None if of_fit is None else of_fit.get(f"slow_stiffness@{at:g}deg")
    change = None
    if joint is not None and before is not None:
        change = compared(before, joint)
    figures: dict[str, Figure] = {}
    if model is not None or holds or stretches:
        norms = [(n, _point(n)) for n in known if n.measure.startswith("slow_torque@")]
        # a group's torque lies beside the leg's only where its zero is known
        stands = model is not None and disputed is None
        healthy = [each for each in norms if "healthy" in each[0].group and stands]
        own = [(at, of_fit[norm.measure]) for norm, at in healthy if of_fit is not None]
        figures["stiffness"] = stiffness_figure(holds, stretches, model, healthy, own, _)
    if any(each.kind == "picture" for each in made):
        figures["made"] = shares_bar([(_(name), value, ci) for name, value, ci in parts])
    picture = leg_cards.stiffness_picture(
        len(holds), len(stretches), zero, _, without_weight=model is not None
    )
    if joint is not None and of_fit is not None:
        by_rest = rest_card(joint, of_fit, at, known, _)
        if by_rest is not None:
            stiff, picture = by_rest.said, by_rest.picture
            figures["stiffness"] = by_rest.figure
    nerves, drawn = nerve_card(nerve, _)
    figures |= drawn
    sections = (
        (_("How stiff is it?"), (*stiff, picture), "stiff"),
        (_("Tissue, muscle or tendon?"), made, "made"),
        (_("Did it change?"), leg_cards.change_card(change, _, leads), "change"),
        (
            _("Can I trust it?"),
            (
                *leg_cards.trust(joint, contradicted, _),
                *leg_cards.next_trial(joint, holds, stretches, _),
            ),
            "trust",
        ),
        (_("How much is nerve?"), nerves, "nerve"),
    )
    return LegAnswers(
        tuple(block.Section(*card, "card") for card in sections), figures, of_fit, at, zero
    )


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
    told = fit.assessment.adequacy.against
    return next((reason for reason in told if reason.code in OF_STIFFNESS), None)


def _point(norm: Norm) -> float:
    return float(norm.measure.partition("@")[2].removesuffix("deg"))
