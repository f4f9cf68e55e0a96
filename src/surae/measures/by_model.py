"""Measures by the fitted model: intervals through the whole covariance, verdicts."""

import math
from dataclasses import replace

import numpy as np

from surae.base.normal import NORMAL
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import AssessedFit, Verdict
from surae.inference.judging.parameter import percent
from surae.inference.judging.reasons import OF_STIFFNESS, Scope, scopes_of
from surae.inference.judging.verdict import ANGLE, PART, verdict_of
from surae.inference.uncertainty.combined import ZERO, Uncertainty
from surae.measures.bent import drawn_legs
from surae.measures.beyond import extrapolated
from surae.measures.fitted_leg import leg_of
from surae.measures.measure import Measure
from surae.measures.points import Evaluated, MeasurePoint, evaluate
from surae.measures.reliability import SCATTER, reliability_of, smallest_detectable

#: Part of the possible legs that may lack a measure that has an interval.
_LACKING = 0.02
#: Part of the variance that comes through a parameter at its bound, from which that is reported.
_BOUND = 0.25


def measures_by_model(
    fit: AssessedFit, wanted: tuple[MeasurePoint, ...]
) -> tuple[tuple[Evaluated, Measure], ...]:
    """All these measures of a fit, each with its derivatives."""
    if not wanted:
        return ()
    evaluated = evaluate(fit.result, fit.assessment.uncertainty, wanted)
    with np.errstate(over="ignore", invalid="ignore"):  # of a fit that overflows
        drawn = drawn_legs(fit.result, fit.assessment.uncertainty, evaluated)
        return tuple((each, _measure(each, drawn.get(each.point.name), fit)) for each in evaluated)


def _measure(evaluated: Evaluated, drawn: FloatArray | None, fit: AssessedFit) -> Measure:
    known = fit.assessment.uncertainty
    definition = evaluated.point.definition
    name = evaluated.point.name
    unit = definition.unit
    value = evaluated.value
    if unit in ("Nm/mV", "Nm/V") and fit.result.problem.inputs[0].emg_unit == "1":
        unit = "Nm"
    meaning = fit.result.problem.options.anatomy.worded(definition.meaning)
    why = evaluated.missing or ""
    bare = Measure(name, unit, meaning, value, None, None, Verdict.UNDETERMINED, why)
    bare = replace(bare, sdc_note=why or Message("measure/no-interval"))
    if value is None or evaluated.missing:
        return bare
    if definition.span:
        low, high = definition.span(leg_of(fit.result), evaluated.point.at)
        bare = replace(bare, from_deg=low, to_deg=high)
    touched = [n for n, g in zip(known.names, evaluated.gradient, strict=True) if g != 0.0]
    if not touched:
        return replace(bare, verdict=Verdict.FIXED, note=Message("measure/nothing"))
    if lost := [n for n in touched if n in known.lost]:
        return replace(bare, note=Message("measure/lost", names=", ".join(lost)))
    g = evaluated.gradient
    half = known.half_width(g)
    method = "linear"
    ci95 = (value - half, value + half)
    if drawn is not None:
        if np.isnan(drawn).mean() > _LACKING:
            return replace(bare, note=Message("measure/lacking"))
        low, high = np.nanpercentile(drawn, [2.5, 97.5]).tolist()
        least = 0.0 if unit == "mJ" else -math.inf  # work that is lost is positive by nature
        ci95 = (max(min(low, value), least), max(high, value))
        method = "draws"
    elif not definition.of_recordings:
        pass
    elif half >= abs(value) and unit != "%":  # so far off no slope tells how the measure bends
        return replace(bare, note=Message("note/as-wide"))
    elif value >= 0.0:  # what the recordings make is positive by nature
        ci95 = (max(ci95[0], 0.0), ci95[1])
    share = known.repeat_half_width(g) / half if half > 0.0 else 0.0
    repeat = tuple(value + share * (end - value) for end in ci95)
    verdict, note = _judge(evaluated, ci95, fit)
    if doubt := disputed(evaluated, fit):
        verdict, note = Verdict.UNDETERMINED, doubt
    return replace(
        _with_sdc(bare, evaluated, (ci95[1] - ci95[0]) / (2.0 * half) if half > 0.0 else 1.0, fit),
        ci95=ci95,
        ci95_repeat=(repeat[0], repeat[1]),
        ci95_device=_by_device(evaluated, known, ci95, half),
        verdict=verdict,
        note=note,
        method=method,
    )


def _by_device(
    evaluated: Evaluated, known: Uncertainty, ci95: tuple[float, float], half: float
) -> tuple[float, float] | None:
    """The interval of one that counts from the angle's zero, without the error of that zero."""
    value = evaluated.value
    if value is None or not evaluated.point.definition.from_zero or not half > 0.0:
        return None
    zero = [name in (ZERO, "angle_zero") for name in known.names]
    share = known.half_width(np.where(zero, 0.0, evaluated.gradient)) / half
    low, high = (value + share * (end - value) for end in ci95)
    return low, high


def _with_sdc(bare: Measure, evaluated: Evaluated, bent: float, fit: AssessedFit) -> Measure:
    """With what two such visits tell, where two visits can be compared by it."""
    alone = evaluated.point.definition.alone
    if alone and not evaluated.point.definition.span:
        return replace(bare, sdc_note=Message(alone, fit.result.problem.options.anatomy.worded))
    _total, session, model = fit.assessment.uncertainty.deviations(evaluated.gradient)
    sem = SCATTER * max(bent, 1.0) * math.hypot(session, model)
    if not (math.isfinite(sem) and sem > 0.0):
        return bare
    return replace(
        bare,
        sdc=smallest_detectable(sem),
        sdc_note="",
        reliability=reliability_of(bare.name, bare.unit, sem),
    )


def _judge(
    evaluated: Evaluated, ci95: tuple[float, float], fit: AssessedFit
) -> tuple[Verdict, Message]:
    """Verdict and sentence of a measure that has an interval."""
    assert evaluated.value is not None
    half = max(ci95[1] - evaluated.value, evaluated.value - ci95[0])
    kind = ANGLE if evaluated.point.definition.is_angle else PART
    doubt = fit.assessment.adequacy.doubt_of(rests_on(evaluated, fit))
    beyond = extrapolated(evaluated, fit.result)
    bound = _through_bound(evaluated, fit.assessment.uncertainty)
    start = fit.result.solution.one_start
    verdict = verdict_of(
        evaluated.value,
        half,
        kind,
        doubted=doubt is not None,
        assumed=beyond is not None or bool(bound) or bool(start),
    )
    if verdict is Verdict.UNDETERMINED:
        return verdict, Message("note/as-wide")
    known = Message("{half:.2g}°", half=half)
    if kind is PART:
        known = percent(half / abs(evaluated.value))
    if doubt is not None:
        grade = fit.assessment.adequacy.grade
        return verdict, Message(f"measure/{grade}", known=known, reason=str(doubt))
    if beyond:
        return verdict, Message("measure/beyond", beyond=beyond, known=known)
    if bound:
        return verdict, Message("measure/bound", names=bound)
    if start and half <= kind.identified * (abs(evaluated.value) if kind is PART else 1.0):
        note = Message("note/known", percent=known)
        return verdict, Message("note/but", known=note, but=Message(start))
    code = "note/known" if verdict is Verdict.IDENTIFIED else "note/known-only"
    return verdict, Message(code, percent=known)


def rests_on(evaluated: Evaluated, fit: AssessedFit) -> frozenset[Scope]:
    """What of the fit a measure rests on: the parameters that matter to its interval."""
    known = fit.assessment.uncertainty
    whole = known.half_width(evaluated.gradient) / NORMAL
    each = np.abs(evaluated.gradient) * np.sqrt(np.diag(known.covariance()))
    parts = (each / whole if whole > 0.0 else each).tolist()
    groups = {p.name: p.group for p in fit.result.problem.spec.parameters}
    pairs = zip(known.names, parts, strict=True)
    return scopes_of((name, groups.get(name, ""), part) for name, part in pairs)


def disputed(evaluated: Evaluated, fit: AssessedFit) -> Message | None:
    """Which trial at rest contradicts a measure of the relaxed leg; None where none does."""
    if not evaluated.point.definition.is_at_rest:
        return None
    against = fit.assessment.adequacy.against
    disputes = (reason for reason in against if reason.code in OF_STIFFNESS)
    first = next(disputes, None)
    return None if first is None else Message("measure/disputed", reason=first.says)


def _through_bound(evaluated: Evaluated, known: Uncertainty) -> str:
    """Parameters at a bound that most of a measure's uncertainty goes through."""
    g = evaluated.gradient
    V = known.covariance()
    whole = float(g @ V @ g)
    if not whole > 0.0:
        return ""
    at = {name: known.names.index(name) for name in known.at_bound}
    return ", ".join(
        name
        for name, j in at.items()
        if V[j, j] > 0.0 and float(V[j] @ g) ** 2 / V[j, j] > _BOUND * whole
    )
