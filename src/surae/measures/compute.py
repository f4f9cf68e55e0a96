"""From a fit to its measures: values, intervals through the whole covariance, verdicts."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from surae.base.errors import ComputationError, InputError
from surae.base.frozen import FrozenDict
from surae.base.plugins import plugins
from surae.base.setting import is_number
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import AssessedFit, FitResult, Grade, Verdict
from surae.inference.judging.parameter import IDENTIFIED, percent
from surae.inference.relaxed.curve import RelaxedCurve
from surae.inference.uncertainty.combined import ZERO, Uncertainty
from surae.measures.at_rest import measures_at, relaxed_of, rest_said
from surae.measures.conflict import LEVEL, compared_angles, disagreement
from surae.measures.leg import Leg, NotDefinedError, leg_of, measured_range
from surae.measures.measure import Measure, Measures
from surae.measures.rest import RestMeasure
from surae.measures.table import DEFINITIONS, Definition
from surae.model import ModelOptions, get_model, with_optional
from surae.model.laboratory import OUTSIDE, group_of

#: Default angles of measures, and those that are possible [deg].
ANGLES = (-10.0, 0.0, 10.0)
_MOST = 60.0
#: Possible legs that are drawn, their seed, and how far their interval may differ from the linear
#: one, as a part of its half-width, before it takes its place.
_DRAWS = 256
_SEED = 7
_BENT = 0.25
#: Part of the possible legs that may lack a measure that has an interval.
_LACKING = 0.02
#: Step of a derivative: of a logarithm, and of other parameters as a part of value or range.
_STEP = 1e-3
#: Half-width up to which an angle is identified, and above which it is undetermined [deg].
_ANGLE = 2.0
_ANY_ANGLE = 20.0
#: Degrees beyond the measured range that still count as measured.
_BEYOND = 0.5
#: How those begin that are of the fit's relaxed tissue.
_OF_TISSUE = (
    "end_stiffness",
    "end_torque",
    "torque_rise",
    "passive_",
    "slow_",
    "quick_stiffness",
    "neutral_angle",
    "slack_",
    "range_at_torque",
    "stiffness_at_torque",
    "hysteresis",
    "dissipated_energy",
)
#: Part of the variance that comes through a parameter at its bound, from which that is reported.
_BOUND = 0.25


@dataclass(frozen=True, slots=True)
class MeasurePoint:
    """A measure at a point."""

    definition: Definition
    at: float

    @property
    def name(self) -> str:
        """Name of the measure, with the point."""
        return self.definition.named(self.at)

    def value(self, leg: Leg) -> tuple[float, Message | None]:
        """The measure of a leg; where it has none, NaN and why."""
        try:
            value = self.definition.value(leg, self.at)
        except NotDefinedError as error:
            return math.nan, Message(error.code, leg.options.anatomy.worded, **error.values)
        except (ComputationError, OverflowError, ZeroDivisionError):
            value = math.nan
        return (value, None) if math.isfinite(value) else (math.nan, Message("none/number"))


@dataclass(frozen=True, slots=True, eq=False)
class Evaluated:
    """A measure of one fit, as far as comparisons need it."""

    point: MeasurePoint  #: Which.
    value: float | None  #: None where there is none, for the reason `missing`.
    gradient: FloatArray  #: By the free parameters, shape (p,).
    missing: Message | None = None  #: Why it has no value or no interval.
    #: Of one by rest alone, on which no parameter acts: its standard deviation, and that of what
    #: another session draws anew.
    deviations: tuple[float, float] | None = None


def points(angles: Sequence[float] = ANGLES, end: float = math.inf) -> tuple[MeasurePoint, ...]:
    """All measures at their points; `end` [deg] is that of the range, if not each fit's own."""
    for angle in angles:
        if not (is_number(angle) and abs(float(angle)) <= _MOST):
            raise InputError(f"angle {angle!r}: give degrees from −{_MOST:g} to {_MOST:g}")
    distinct = tuple(dict.fromkeys(float(angle) for angle in angles))
    return tuple(
        MeasurePoint(each, at)
        for each in (*DEFINITIONS, *plugins("measures", Definition).values())
        for at in (distinct if each.at == "deg" else (end,) if each.span else each.points)
    )


def measures_of_values(
    values: Mapping[str, float],
    model: str,
    options: ModelOptions | None = None,
    angles: Sequence[float] = ANGLES,
    only: Collection[str] = (),
) -> dict[str, float]:
    """Measures of a leg with known parameters: a pure function, those without recordings.

    Parameters
    ----------
    values : mapping of str to float
        Every free parameter of the model; tendon parameters that are left out take their starts.
    model : str
        Its name.
    options : ModelOptions, optional
        Its switches.
    angles : sequence of float
        Where [deg].
    only : collection of str
        Names of the measures to compute; empty computes all.

    Returns
    -------
    dict of str to float
        By name; what such a leg does not have is left out.

    Raises
    ------
    InputError
        The model, a parameter or an angle is not known.
    """
    options = options or ModelOptions()
    spec = with_optional(get_model(model), values)
    vector = spec.vector(values, options)
    leg = Leg(spec, options, dict(zip(spec.names, vector.tolist(), strict=True)))
    wanted = [
        point
        for point in points(angles)
        if not point.definition.of_recordings and (not only or point.name in only)
    ]
    values_by_name = {point.name: point.value(leg)[0] for point in wanted}
    return {name: value for name, value in values_by_name.items() if math.isfinite(value)}


def measures(fit: AssessedFit, angles: Sequence[float] = ANGLES) -> Measures:
    """All measures of a fit, those of angles at these [deg]; what it lacks has a reason instead."""
    judged = judged_measures(fit, points(angles))
    by_name = FrozenDict((measure.name, measure) for _, measure in judged)
    rest = rest_said(relaxed_of(fit.result), two_tissues(fit))
    return Measures(fit.result.problem.spec.name, fit.assessment.adequacy, by_name, rest)


@lru_cache(maxsize=4)  # pages, comparisons and answers are often of the same fit
def judged_measures(
    fit: AssessedFit, wanted: tuple[MeasurePoint, ...]
) -> tuple[tuple[Evaluated, Measure], ...]:
    """All these measures of a fit: by rest alone what its rest tells, the others by its model."""
    curve = relaxed_of(fit.result)
    if not isinstance(curve, RelaxedCurve):
        return measures_by_model(fit, wanted)
    angles = tuple(dict.fromkeys(p.at for p in wanted if p.definition.at == "deg"))
    end = next((p.at for p in wanted if p.definition.span), math.inf)
    own = {each.measure.name: each for each in measures_at(curve, fit.result, angles, end)}
    others = tuple(point for point in wanted if point.name not in own)
    why = two_tissues(fit)
    modelled = {each.point: (each, _doubted(m, why)) for each, m in measures_by_model(fit, others)}
    size = len(fit.assessment.uncertainty.names)
    return tuple(modelled.get(p) or _by_rest(p, own[p.name], size) for p in wanted)


@lru_cache(maxsize=4)
def two_tissues(fit: AssessedFit) -> Message | None:
    """That rest and the fit tell two tissues, where they do; see `surae.measures.conflict`."""
    curve = relaxed_of(fit.result)
    if not isinstance(curve, RelaxedCurve) or curve.grade is not Grade.ADEQUATE:
        return None
    angles = compared_angles(curve)
    (torque,) = (each for each in DEFINITIONS if each.name == "slow_torque")
    at = [MeasurePoint(torque, float(angle) + curve.zero_deg) for angle in angles]
    known = fit.assessment.uncertainty
    told = evaluate(fit.result, known, at) if at and known.lost != known.names else ()
    values = [each.value for each in told if each.value is not None and not each.missing]
    if not told or len(values) < len(at):
        return None
    rows = np.array([np.where(np.array(known.names) == ZERO, 0.0, e.gradient) for e in told])
    p = disagreement(curve, angles, values, rows @ known.covariance() @ rows.T)
    return Message("rest/two-tissues") if p < LEVEL else None


def _doubted(m: Measure, why: Message | None) -> Measure:
    """A measure of the fit's relaxed tissue, which rest contradicts; others as they are."""
    base = m.name.partition("@")[0]
    if why is None or m.ci95 is None or not base.startswith(_OF_TISSUE):
        return m
    return replace(m, verdict=Verdict.UNDETERMINED, note=why)


def _by_rest(point: MeasurePoint, told: RestMeasure, size: int) -> tuple[Evaluated, Measure]:
    """A measure by rest alone, which none of so many parameters moves."""
    assert told.total is not None
    assert told.session is not None
    deviations = told.total, told.session
    evaluated = Evaluated(point, told.measure.value, np.zeros(size), deviations=deviations)
    return evaluated, told.measure


def measures_by_model(
    fit: AssessedFit, wanted: tuple[MeasurePoint, ...]
) -> tuple[tuple[Evaluated, Measure], ...]:
    """All these measures of a fit, each with its derivatives."""
    if not wanted:
        return ()
    drawn = _drawn(fit.result, fit.assessment.uncertainty, wanted)
    return tuple(
        (each, _measure(each, drawn.get(each.point.name), fit))
        for each in evaluate(fit.result, fit.assessment.uncertainty, wanted)
    )


def evaluate(
    result: FitResult, known: Uncertainty, wanted: Sequence[MeasurePoint]
) -> tuple[Evaluated, ...]:
    """Values of measures and their derivatives by everything that was estimated."""
    leg = leg_of(result)
    values, missing = (list(of) for of in zip(*(point.value(leg) for point in wanted), strict=True))
    gradients = np.zeros((len(wanted), len(known.names)))
    reach = np.maximum(np.abs(known.values), 0.01 * (known.upper - known.lower))
    steps = np.where(np.isnan(known.origin), _STEP * reach, _STEP)
    for j, name in enumerate(known.names):
        step = float(steps[j])
        sides = [leg.with_values({name: known.moved(j, by)}) for by in (-step, step)]
        for i, point in enumerate(wanted):
            group = group_of(name)
            of = point.definition
            # where the ankle was at the end of the movement depends on its axis
            outside = group in OUTSIDE and not (of.of_recordings or (of.span and group == "axis"))
            if math.isnan(values[i]) or outside:
                continue
            (low, below), (high, above) = (point.value(side) for side in sides)
            gradients[i, j] = (high - low) / (2.0 * step * known.scale[j])
            if why := below or above:
                gradients[i, j] = 0.0
                computed = why.code == "none/number"
                edge = "none/edge-computed" if computed else "none/edge-defined"
                missing[i] = Message(edge, name=name, why=why)
    return tuple(
        Evaluated(point, None if math.isnan(value) else value, gradient, why)
        for point, value, gradient, why in zip(wanted, values, gradients, missing, strict=True)
    )


def _drawn(
    result: FitResult, known: Uncertainty, wanted: Sequence[MeasurePoint]
) -> dict[str, FloatArray]:
    """Every measure that is not made of recordings, of possible legs; NaN where it has none.

    Legs are as they were fitted, and read at the angle that their zero says: turned with it too,
    what the zero makes unsure would cancel.
    """
    inner = [point for point in wanted if not point.definition.of_recordings]
    if known.lost == known.names:
        return {}
    likeliest = leg_of(result)
    legs = replace(known, turned=FrozenDict()).draw(_DRAWS, _SEED)
    rows = np.empty((len(legs), len(inner)))
    for i, drawn in enumerate(legs):
        leg = likeliest.with_values(dict(zip(known.names, drawn.tolist(), strict=True)))
        rows[i] = [point.value(leg)[0] for point in inner]
    return {point.name: rows[:, k] for k, point in enumerate(inner)}


def _measure(evaluated: Evaluated, drawn: FloatArray | None, fit: AssessedFit) -> Measure:
    known = fit.assessment.uncertainty
    definition = evaluated.point.definition
    name = evaluated.point.name
    unit = definition.unit
    value = evaluated.value
    if unit == "Nm/mV" and fit.result.problem.inputs[0].emg_unit == "1":
        unit = "Nm"
    meaning = fit.result.problem.options.anatomy.worded(definition.meaning)
    why = evaluated.missing or ""
    bare = Measure(name, unit, meaning, value, None, None, Verdict.UNDETERMINED, why)
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
        ends = np.nanpercentile(drawn, [2.5, 97.5])
        if float(np.abs(ends - np.array(ci95)).max()) > _BENT * half:
            low = min(float(ends[0]), value)
            high = max(float(ends[1]), value)
            ci95 = (low, high)
            method = "draws"
    elif half >= abs(value) and unit != "%":  # so far off no slope tells how the measure bends
        return replace(bare, note=Message("note/as-wide"))
    elif value >= 0.0:  # what the recordings make is positive by nature
        ci95 = (max(ci95[0], 0.0), ci95[1])
    share = known.repeat_half_width(g) / half if half > 0.0 else 0.0
    repeat = tuple(value + share * (end - value) for end in ci95)
    verdict, note = _judge(evaluated, ci95, fit)
    return replace(
        bare,
        ci95=ci95,
        ci95_repeat=(repeat[0], repeat[1]),
        verdict=verdict,
        note=note,
        method=method,
    )


def _judge(
    evaluated: Evaluated, ci95: tuple[float, float], fit: AssessedFit
) -> tuple[Verdict, Message]:
    """Verdict and sentence of a measure that has an interval."""
    assert evaluated.value is not None
    half = max(ci95[1] - evaluated.value, evaluated.value - ci95[0])
    if evaluated.point.definition.is_angle:
        relative = IDENTIFIED * half / _ANGLE
        wide = half > _ANY_ANGLE
        known = Message("{half:.2g}°", half=half)
    else:
        relative = half / abs(evaluated.value) if evaluated.value else math.inf
        wide = relative > 1.0
        known = percent(relative)
    if wide:
        return Verdict.UNDETERMINED, Message("note/as-wide")
    adequacy = fit.assessment.adequacy
    if adequacy.grade is not Grade.ADEQUATE:
        doubt = f"measure/{adequacy.grade}"
        return Verdict.WEAK, Message(doubt, known=known, reason=adequacy.reasons[0])
    if beyond := extrapolated(evaluated, fit.result):
        return Verdict.WEAK, Message("measure/beyond", beyond=beyond, known=known)
    if bound := _through_bound(evaluated, fit.assessment.uncertainty):
        return Verdict.WEAK, Message("measure/bound", names=bound)
    if relative <= IDENTIFIED:
        return Verdict.IDENTIFIED, Message("note/known", percent=known)
    return Verdict.WEAK, Message("note/known-only", percent=known)


def extrapolated(evaluated: Evaluated, result: FitResult) -> Message | None:
    """What of a measure was not measured; None where all was."""
    definition = evaluated.point.definition
    at = evaluated.point.at
    if definition.at == "deg" or definition.is_angle or definition.span:
        degrees = evaluated.value if definition.is_angle else at
        low, high = measured_range(result)
        if definition.span and definition.is_angle:  # how far before the range's end
            low, high = 0.0, high - low
        if degrees is None or degrees == math.inf or low - _BEYOND <= degrees <= high + _BEYOND:
            return None
        return Message("beyond/angle", degrees=degrees, low=low, high=high)
    if definition.at == "s":
        longest = max(float(i.time[-1] - i.time[0]) for i in result.problem.inputs)
        return None if at <= longest else Message("beyond/time", seconds=longest)
    if definition.at not in ("N", "Nm") or definition.name == "stiffness_at_torque":
        return None
    leg = leg_of(result)
    group = "tib" if definition.name.endswith("_tib") else "tri"
    alpha = max(leg.largest_activity[group], 0.0)
    if definition.at == "N":
        ends = (leg.hold(group, angle, alpha).force for angle in measured_range(result))
        most = max(*ends, leg.hold(group, 0.0, alpha).force)
        return None if at <= most else Message("beyond/force", force=most)
    most = leg.active_torque(group, 0.0, alpha)
    return None if at <= most else Message("beyond/torque", torque=most)


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
