"""All measures of a leg by its rest, with intervals and verdicts."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.base.normal import standard_error_of
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import Grade, Verdict
from surae.inference.judging.parameter import percent
from surae.inference.judging.verdict import ANGLE, PART, verdict_of
from surae.inference.relaxed.curve import PossibleLegs, RelaxedCurve
from surae.measures.measure import Measure
from surae.measures.rest.at_angles import at_angles
from surae.measures.rest.at_torques import REACHING, at_torques
from surae.measures.rest.draft import Draft
from surae.measures.rest.of_range import REACHES, over_range
from surae.measures.rest.of_time import over_time

#: Ends of 95 % and the middle.
_QUANTILES = (0.025, 0.5, 0.975)


@dataclass(frozen=True, slots=True)
class RestMeasure:
    """A measure of rest, and what comparisons need of it."""

    measure: Measure
    #: Standard deviations: everything included; what another session draws anew, which is all but
    #: what the equations leave out of this leg; None where there is no interval.
    total: float | None = None
    session: float | None = None


def measures_of_rest(
    curve: RelaxedCurve, angles: Sequence[float] = (-10.0, 0.0, 10.0)
) -> tuple[Measure, ...]:
    """All measures of a relaxed curve, at angles [deg] of the ankle's own where they have one.

    Values and 95 % intervals are the median and quantiles of the legs that rest leaves possible,
    the error of the angle's zero in them; `ci95_device` is without it. `ci95_repeat` is that of
    another trial of the leg, with as long a rest and mounted alike: the difference of two posterior
    draws of it, in which neither the zero nor what the equations leave out differs. What both know
    beforehand, as of the foot's weight, counts as drawn anew, so that it is too wide if anything.
    """
    return tuple(each.measure for each in rated_measures(curve, angles))


def rated_measures(
    curve: RelaxedCurve, angles: Sequence[float], end: float = math.inf
) -> tuple[RestMeasure, ...]:
    """The same with what comparisons need; the range ends at `end` by the device [deg]."""
    legs = curve.draws()
    moved = (curve.moved[0], min(curve.moved[1], end))
    asked = _drafts(curve, legs, angles, moved)
    return tuple(_measure(each, curve, legs) for each in asked)


def _drafts(
    curve: RelaxedCurve,
    legs: PossibleLegs,
    angles: Sequence[float],
    moved: tuple[float, float],
    turned: FloatArray | None = None,
) -> tuple[Draft, ...]:
    """Every measure, not judged; `turned` is as of `over_range`."""
    asked = (
        *at_angles(curve, legs, angles),
        *over_range(curve, legs, moved, turned),
        *at_torques(curve, legs),
        *over_time(curve, legs, moved),
    )
    if curve.high - curve.low >= REACHES:
        return asked
    why = Message("none/rest-one", degrees=curve.high)
    return tuple(replace(each, device=None, ankle=None, missing=why) for each in asked)


def _quantiles(values: FloatArray, share: FloatArray) -> tuple[float, float, float]:
    """Weighted 2.5 %, 50 % and 97.5 % of possible legs."""
    order = np.argsort(values)
    below = np.cumsum(share[order]) - 0.5 * share[order]
    low, middle, high = np.interp(_QUANTILES, below, values[order])
    return float(low), float(middle), float(high)


def _measure(asked: Draft, curve: RelaxedCurve, legs: PossibleLegs) -> RestMeasure:
    bare = Measure(
        asked.name,
        asked.unit,
        asked.meaning,
        None,
        None,
        None,
        Verdict.UNDETERMINED,
        asked.missing or "",
        basis="rest",
    )
    if asked.span is not None:
        bare = replace(bare, from_deg=asked.span[0], to_deg=asked.span[1])
    if asked.device is None or asked.ankle is None:
        return RestMeasure(bare)
    there = np.isfinite(asked.device) & np.isfinite(asked.ankle)
    if legs.share[there].sum() < REACHING:
        return RestMeasure(replace(bare, note=Message("measure/lacking")))
    share = legs.share[there] / legs.share[there].sum()
    same = legs.scale[there] ** asked.power  # what the equations leave out of this leg
    first, value, last = _quantiles(asked.device[there], share)
    low, _, high = _quantiles(asked.ankle[there], share)
    ci95 = (min(low, first), max(high, last))  # the zero makes nothing surer
    verdict, note = _judged(value, ci95, asked.unit, curve)
    anew = math.sqrt(2.0)
    begin, middle, end = _quantiles(asked.device[there] / same, share)
    by_ankle, _, other = _quantiles(asked.ankle[there] / same, share)
    made = replace(
        bare,
        value=value,
        ci95=ci95,
        ci95_repeat=(value - anew * (middle - begin), value + anew * (end - middle)),
        ci95_device=(first, last) if asked.at_angle else None,
        verdict=verdict,
        note=note,
        method="draws",
    )
    session = standard_error_of((min(by_ankle, begin), max(other, end)))
    return RestMeasure(made, standard_error_of(ci95), session)


def _judged(
    value: float, ci95: tuple[float, float], unit: str, curve: RelaxedCurve
) -> tuple[Verdict, Message]:
    half = max(ci95[1] - value, value - ci95[0])
    doubted = curve.grade is not Grade.ADEQUATE
    verdict = verdict_of(value, half, ANGLE if unit == "deg" else PART, doubted=doubted)
    if verdict is Verdict.UNDETERMINED:
        return verdict, Message("note/as-wide")
    known = Message("{half:.2g}°", half=half) if unit == "deg" else percent(half / abs(value))
    if doubted:
        return verdict, Message(f"measure/{curve.grade}", known=known, reason=curve.findings[0])
    if verdict is Verdict.IDENTIFIED:
        return verdict, Message("note/known", percent=known)
    return verdict, Message("note/known-only", percent=known)


def values_of_rest(
    curve: RelaxedCurve, legs: PossibleLegs, angles: Sequence[float]
) -> tuple[Draft, ...]:
    """Every measure of these possible legs of a curve, not judged: values by leg, or why none.

    The range is the device's, through which a leg that is mounted anew moves otherwise, so that the
    whole of its zero is in what is over that range.
    """
    return _drafts(curve, legs, angles, curve.moved, legs.zero)
