"""From a fit to its measures: values, intervals through the whole covariance, verdicts."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from surae.base.errors import ComputationError, InputError
from surae.base.frozen import FrozenDict
from surae.base.normal import NORMAL
from surae.base.plugins import plugins
from surae.base.setting import is_number
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import AssessedFit, FitResult, Grade, Verdict
from surae.inference.judging.parameter import percent
from surae.inference.judging.reasons import OF_STIFFNESS, Scope, scopes_of
from surae.inference.judging.verdict import ANGLE, PART, verdict_of
from surae.inference.relaxed.curve import RelaxedCurve
from surae.inference.uncertainty.combined import ZERO, Uncertainty
from surae.measures.at_rest import measures_at, rest_of_fit, rest_said
from surae.measures.conflict import LEVEL, compared_angles, disagreement
from surae.measures.leg import Leg, NotDefinedError, leg_of, measured_range, of_any_path
from surae.measures.measure import Measure, Measures
from surae.measures.reliability import SCATTER, reliability_of, smallest_detectable
from surae.measures.rest import RestMeasure
from surae.measures.table import DEFINITIONS, Definition
from surae.model import ModelOptions, get_model, with_optional
from surae.model.laboratory import OUTSIDE, group_of

#: Default angles of measures, and those that are possible [deg].
ANGLES = (-10.0, 0.0, 10.0)
_MOST = 60.0
#: Possible legs that are drawn, their seed, and how far a measure at the ends of its interval may
#: be from the linear ones, as a part of the half-width, before draws take its place.
_DRAWS = 1024
_SEED = 7
_BENT = 0.25
#: Part of the possible legs that may lack a measure that has an interval.
_LACKING = 0.02
#: Step of a derivative: of a logarithm, and of other parameters as a part of value or range.
_STEP = 1e-3
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
    rest = rest_said(rest_of_fit(fit), two_tissues(fit))
    return Measures(fit.result.problem.spec.name, fit.assessment.adequacy, by_name, rest)


@lru_cache(maxsize=4)  # pages, comparisons and answers are often of the same fit
def judged_measures(
    fit: AssessedFit, wanted: tuple[MeasurePoint, ...]
) -> tuple[tuple[Evaluated, Measure], ...]:
    """All these measures of a fit: by rest alone what its rest tells, the others by its model."""
    curve = rest_of_fit(fit)
    if not isinstance(curve, RelaxedCurve):
        return measures_by_model(fit, wanted)
    angles = tuple(dict.fromkeys(p.at for p in wanted if p.definition.at == "deg"))
    end = next((p.at for p in wanted if p.definition.span), math.inf)
    own = {each.measure.name: each for each in measures_at(curve, fit.result, angles, end)}
    others = tuple(point for point in wanted if point.name not in own)
    why = two_tissues(fit)
    modelled = {each.point: (each, _doubted(m, why)) for each, m in measures_by_model(fit, others)}
    size = len(fit.assessment.uncertainty.names)
    assumed = curve.is_declared
    return tuple(modelled.get(p) or _by_rest(p, own[p.name], size, assumed=assumed) for p in wanted)


@lru_cache(maxsize=4)
def two_tissues(fit: AssessedFit) -> Message | None:
    """That rest and the fit tell two tissues, where they do; see `surae.measures.conflict`."""
    curve = rest_of_fit(fit)
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


def _by_rest(
    point: MeasurePoint, told: RestMeasure, size: int, *, assumed: bool
) -> tuple[Evaluated, Measure]:
    """A measure by rest alone, which none of so many parameters moves.

    Who fits does not say that a leg rests: where no electrode shows an effort, a muscle that never
    lets go looks like one that does nothing, in whatever unit. Rest is `assumed` then, and nothing
    claimed.
    """
    measure = told.measure
    if assumed and measure.verdict is Verdict.IDENTIFIED:
        measure = replace(measure, verdict=Verdict.WEAK, note=Message("rest/no-effort"))
    assert told.total is not None
    assert told.session is not None
    deviations = told.total, told.session
    evaluated = Evaluated(point, told.measure.value, np.zeros(size), deviations=deviations)
    return evaluated, measure


def measures_by_model(
    fit: AssessedFit, wanted: tuple[MeasurePoint, ...]
) -> tuple[tuple[Evaluated, Measure], ...]:
    """All these measures of a fit, each with its derivatives."""
    if not wanted:
        return ()
    evaluated = evaluate(fit.result, fit.assessment.uncertainty, wanted)
    with np.errstate(over="ignore", invalid="ignore"):  # of a fit that overflows
        drawn = _drawn(fit.result, fit.assessment.uncertainty, evaluated)
        return tuple((each, _measure(each, drawn.get(each.point.name), fit)) for each in evaluated)


def evaluate(
    result: FitResult, known: Uncertainty, wanted: Sequence[MeasurePoint]
) -> tuple[Evaluated, ...]:
    """Values of measures and their derivatives by everything that was estimated."""
    leg = leg_of(result)
    values, missing = (list(of) for of in zip(*(point.value(leg) for point in wanted), strict=True))
    gradients = np.zeros((len(wanted), len(known.names)))
    reach = np.maximum(np.abs(known.values), 0.01 * (known.upper - known.lower))
    reach = np.where(np.isfinite(reach), reach, 1.0)
    steps = np.where(np.isnan(known.origin), _STEP * reach, _STEP)
    with_geometry = of_any_path(leg) if known.geometry else leg
    for j, name in enumerate(known.names):
        step = float(steps[j])
        moving = with_geometry if known.geometry and name in known.geometry.by else leg
        follows = name not in result.problem.free  # as a length at 0 rad follows its path
        if follows and not any(by[:, j].any() for by in known.rows.values()):
            continue
        sides = [moving.with_values(known.moved_leg(name, by)) for by in (-step, step)]
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
    result: FitResult, known: Uncertainty, evaluated: Sequence[Evaluated]
) -> dict[str, FloatArray]:
    """Measures of possible legs, of those measures that bend; NaN where a leg has none.

    Legs are as they were fitted, and read at the angle that their zero says: turned with it too,
    what the zero makes unsure would cancel. Whether one bends is told along the line on which it
    changes most, from end to end of its interval, and so by no chance. Draws tell what leaves the
    line; along it they are brought to their own distribution, which is normal.
    """
    if known.lost == known.names:
        return {}
    likeliest = of_any_path(leg_of(result)) if known.geometry else leg_of(result)
    known = replace(known, turned=FrozenDict())
    lines = {}
    for each in evaluated:
        if each.point.definition.of_recordings or each.value is None or each.missing:
            continue
        line = _Line.of(each, known, likeliest)
        if line is not None and line.bends:
            lines[each.point] = line
    if not lines:
        return {}
    away = known.away(_DRAWS, _SEED)
    rows = np.empty((len(away), len(lines)))
    for i, drawn in enumerate(known.legs_at(away)):
        leg = likeliest.with_values(dict(zip(known.names, drawn.tolist(), strict=True)))
        rows[i] = [point.value(leg)[0] for point in lines]
    return {
        point.name: values + line.by_chance(away - known.mean_away)
        for (point, line), values in zip(lines.items(), rows.T, strict=True)
    }


@dataclass(frozen=True, slots=True, eq=False)
class _Line:
    """A measure on the line through the likeliest leg along which it changes most."""

    value: float  #: Of the likeliest leg.
    slopes: FloatArray  #: Its gradient on the parameters' scale, shape (p,).
    half: float  #: Half of its interval, were it straight.
    at: FloatArray  #: Places on the line, in standard deviations from the middle, shape (k,).
    values: FloatArray  #: The measure there, shape (k,).

    @classmethod
    def of(cls, evaluated: Evaluated, known: Uncertainty, leg: Leg) -> "_Line | None":
        """The line; None where nothing makes the measure unsure."""
        slopes = evaluated.gradient * known.scale
        rows = np.concatenate(list(known.rows.values())) / known.scale
        along = rows.T @ (rows @ slopes)
        sd = math.sqrt(max(float(slopes @ along), 0.0))
        if not sd > 0.0:
            return None
        bias = known.bias(evaluated.gradient) / NORMAL
        direction = along / sd * (1.0 + bias / sd)
        at = np.array([-NORMAL, -1.0, 0.0, 1.0, NORMAL])
        legs = known.legs_at(known.mean_away + at[:, None] * direction)
        values = [
            evaluated.point.value(
                leg.with_values(dict(zip(known.names, each.tolist(), strict=True)))
            )[0]
            for each in legs
        ]
        assert evaluated.value is not None
        return cls(evaluated.value, slopes / sd, NORMAL * sd + bias * NORMAL, at, np.array(values))

    @property
    def bends(self) -> bool:
        """Whether it ends elsewhere than a straight one about the value, or is not everywhere."""
        ends = self.values[[0, -1]] - self.value
        off = np.abs(ends - np.array([-self.half, self.half])).max()
        return not off <= _BENT * self.half

    def by_chance(self, away: FloatArray) -> FloatArray:
        """What brings draws, so far from the middle, to their distribution on the line, (n,)."""
        from scipy.special import ndtri

        where = away @ self.slopes
        count = len(where)
        scores = np.empty(count)
        scores[np.argsort(where, kind="stable")] = ndtri((np.arange(count) + 0.5) / count)
        if not np.isfinite(self.values).all():
            return np.zeros(count)
        return np.asarray(self._on(scores) - self._on(where))

    def _on(self, where: FloatArray) -> FloatArray:
        """The measure at places on the line, straight beyond its ends."""
        inner = np.interp(where, self.at, self.values)
        low, high = np.diff(self.values)[[0, -1]] / np.diff(self.at)[[0, -1]]
        below = np.minimum(where - self.at[0], 0.0) * low
        return np.asarray(inner + below + np.maximum(where - self.at[-1], 0.0) * high)


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
    verdict = verdict_of(
        evaluated.value,
        half,
        kind,
        doubted=doubt is not None,
        assumed=beyond is not None or bool(bound),
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
    told = (reason for reason in against if reason.code in OF_STIFFNESS)
    first = next(told, None)
    return None if first is None else Message("measure/disputed", reason=first.says)


def extrapolated(evaluated: Evaluated, result: FitResult) -> Message | None:
    """What of a measure was not measured; None where all was."""
    definition = evaluated.point.definition
    at = evaluated.point.at
    shown = definition.is_angle and not definition.name.startswith("working_point")
    if definition.at == "deg" or shown or definition.span:
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
    return _stronger(definition, at, result)


def _stronger(definition: Definition, at: float, result: FitResult) -> Message | None:
    """Whether a pull is stronger than those in the recordings."""
    leg = leg_of(result)
    group = "tib" if definition.name.endswith("_tib") else "tri"
    alpha = max(leg.largest_activity[group], 0.0)
    pulls = [leg.hold(group, angle, alpha) for angle in (*measured_range(result), 0.0)]
    if definition.at == "N":
        most = max(pull.force for pull in pulls)
        return None if at <= most else Message("beyond/force", force=most)
    if definition.name.startswith("tendon_"):
        most = max(abs(pull.torque) for pull in pulls)
        return None if at <= most else Message("beyond/pull", torque=most)
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
