"""Measures of a leg by its rest alone: torque and stiffness of its relaxed curve."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.special import ndtri

from surae.base.frozen import as_read_only
from surae.base.normal import standard_error_of
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import Grade, Verdict
from surae.inference.judging.parameter import percent
from surae.inference.judging.verdict import ANGLE, PART, verdict_of
from surae.inference.relaxed.basis import Basis
from surae.inference.relaxed.curve import (
    BEYOND,
    LEFT_OUT,
    SLOW_FROM,
    SLOW_SPEED,
    PossibleLegs,
    RelaxedCurve,
    slow_features,
)
from surae.inference.relaxed.regressors import TAUS, lags
from surae.measures.measure import Measure

#: Torques at which the range of motion is given [Nm], and the stiffness.
RANGE_TORQUES = (5.0, 10.0, 12.0, 15.0)
STIFFNESS_TORQUES = (10.0,)
#: The last of a range, over which its end is as stiff as its mean [deg].
_LAST = 10.0
#: Rest may miss an end of the range that was moved by so many degrees.
_REACHES = 1.5
#: Part of the zero's error that an end of the range has: where the movement ended is not where the
#: zero is, but the foot turns on its plate on the way there; assumed. (A sketch without it had 86 %
#: of its intervals hold, on legs of another generator; what of that the zero is was not counted.)
_AT_ENDS = 0.5
#: Degrees from the start of a slow stretch before it tells a slope.
_ON_ITS_WAY = 10.0
#: Degrees between two samples of a stretch and its return.
_LOOP_STEP = 0.25
#: Seconds after which the part that has relaxed is given.
_RELAXED = 10.0
#: What three times of relaxation leave out of that part, and of the work that a loop takes (a
#: friction, a velocity), one standard deviation: set on 42 virtual legs of another author.
_SHARE_LEFT_OUT = 0.2
_LOOP_LEFT_OUT = 0.3
#: What the equations leave out of a slope, whatever its size, one standard deviation [Nm/deg]: half
#: of what the foot's weight turns at −25°. Set on five virtual legs of surae's own, whose stiffness
#: there came out 0.007 to 0.02 too low; nowhere else it matters.
_SLOPE = 0.01
_SEED = 11
#: Part of the possible legs that has to reach a torque for a range at it.
_REACHING = 0.95
#: Ends of 95 % and the middle.
_QUANTILES = (0.025, 0.5, 0.975)


@dataclass(frozen=True, slots=True)
class _Asked:
    """A measure of rest before it is judged: its values of possible legs, or why there is none."""

    name: str
    unit: str
    meaning: str
    #: Values with the angle's zero as known, and as unsure as it is; shape (n,).
    device: FloatArray | None = None
    ankle: FloatArray | None = None
    #: Power of `PossibleLegs.scale` in both; 0 where it is in them some other way.
    power: float = 1.0
    missing: Message | None = None
    at_angle: bool = False
    span: tuple[float, float] | None = None


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
    asked = [
        *_at_angles(curve, legs, angles),
        *_of_range(curve, legs, moved),
        *_at_torques(curve, legs),
        *_of_time(curve, legs, moved),
    ]
    return tuple(_measure(each, curve, legs) for each in asked)


def _at_angles(
    curve: RelaxedCurve, legs: PossibleLegs, angles: Sequence[float]
) -> Iterator[_Asked]:
    kinds: tuple[tuple[str, str, str, Callable[..., FloatArray], bool], ...] = (
        (
            "passive_torque",
            "Nm",
            "Torque of the relaxed ankle at an angle, its tissue fully relaxed.",
            _relaxed_torque,
            False,
        ),
        (
            "passive_stiffness",
            "Nm/deg",
            "Stiffness of the relaxed ankle at an angle, for a movement so slow that tissue "
            "relaxes.",
            _relaxed_stiffness,
            False,
        ),
        (
            "slow_torque",
            "Nm",
            "Torque of the relaxed ankle as it passes an angle in a slow stretch, 5°/s from −30°.",
            _slow_torque,
            True,
        ),
        (
            "slow_stiffness",
            "Nm/deg",
            "Stiffness of the relaxed ankle as it passes an angle in a slow stretch, 5°/s from "
            "−30°.",
            _slow_stiffness,
            True,
        ),
    )
    for name, unit, meaning, value, slow in kinds:
        for angle in dict.fromkeys(map(float, angles)):
            at = angle - curve.zero_deg
            bare = _Asked(f"{name}@{angle:g}deg", unit, meaning, at_angle=True)
            if why := _withheld(curve, at, slow):
                yield replace(bare, missing=why)
                continue
            beside = _slopes(len(legs.zero)) if unit == "Nm/deg" else np.zeros(1)
            yield replace(
                bare,
                device=legs.scale * value(curve, legs, np.full_like(legs.zero, at)) + beside,
                ankle=legs.scale * value(curve, legs, at + legs.zero) + beside,
            )


@lru_cache(maxsize=4)
def _slopes(n: int) -> FloatArray:
    """What else may turn the torque with the angle, of so many legs [Nm/deg], shape (n,)."""
    normal = ndtri((np.arange(n) + 0.5) / n)
    return as_read_only(_SLOPE * np.random.default_rng(_SEED).permutation(normal))


def _withheld(curve: RelaxedCurve, at: float, slow: bool) -> Message | None:
    """Why there is nothing at an angle of the device [deg]."""
    if slow and at < SLOW_FROM + _ON_ITS_WAY:
        return Message("none/stretch", low=SLOW_FROM, high=curve.high)
    if curve.passed(at, held=not slow):
        return None
    if curve.low <= at <= curve.high:
        return Message("none/rest-not-passed", degrees=at)
    return Message("none/rest-beyond", degrees=at, low=curve.low, high=curve.high)


def _of_range(
    curve: RelaxedCurve, legs: PossibleLegs, moved: tuple[float, float], at_ends: float = _AT_ENDS
) -> Iterator[_Asked]:
    low, high = moved
    last = max(low, high - _LAST)
    ends = {
        "end_torque": (
            "Nm",
            "Torque of the relaxed ankle at the end of the dorsiflexion that was moved.",
            (high, high),
        ),
        "end_stiffness": (
            "Nm/deg",
            "Stiffness of the relaxed ankle over the last 10° of the dorsiflexion that was moved.",
            (last, high),
        ),
        "torque_rise": (
            "Nm",
            "Rise of the relaxed ankle's torque over the whole range that was moved.",
            (low, high),
        ),
    }
    short = curve.high < high - _REACHES or high - low < _REACHES  # a hold alone has no range
    begins = curve.low <= low + _REACHES
    for name, (unit, meaning, span) in ends.items():
        bare = _Asked(name, unit, meaning, span=span)
        if short or (name == "torque_rise" and not begins):
            yield replace(
                bare,
                missing=Message(
                    "none/rest-short", low=curve.low, high=curve.high, first=low, last=high
                ),
            )
            continue
        made = []
        for zero in (np.zeros_like(legs.zero), at_ends * legs.zero):
            first, last_torque = (_relaxed_torque(curve, legs, degrees + zero) for degrees in span)
            value = last_torque
            if name != "end_torque":
                value = last_torque - first
            if name == "end_stiffness":
                value = value / (span[1] - span[0])
            made.append(legs.scale * value)
        yield replace(bare, device=made[0], ankle=made[1])


def _at_torques(curve: RelaxedCurve, legs: PossibleLegs) -> Iterator[_Asked]:
    """Angles at which torques are reached, and how stiff the ankle is there."""
    degrees = np.arange(curve.low, curve.high + 0.25, 0.5)
    torque = legs.scale[:, None] * (legs.weights @ curve.basis.features(degrees).T)
    torque = np.maximum.accumulate(torque, axis=1)
    for wanted in RANGE_TORQUES:
        bare = _Asked(
            f"range_at_torque@{wanted:g}Nm",
            "deg",
            "Angle of the ankle at which its relaxed torque is so large.",
        )
        stiff = _Asked(
            f"stiffness_at_torque@{wanted:g}Nm",
            "Nm/deg",
            "Stiffness of the relaxed ankle at the angle where its relaxed torque is so large.",
        )
        within = (torque[:, 0] < wanted) & (torque[:, -1] > wanted)
        if legs.share[within].sum() < _REACHING:
            largest = float(np.average(torque[:, -1], weights=legs.share))
            why = Message("none/rest-torque", torque=wanted, largest=largest)
            bare = replace(bare, missing=why)
            stiff = replace(stiff, missing=why)
        else:
            at = _crossing(degrees, torque, wanted)
            own = at + curve.zero_deg
            bare = replace(bare, device=own, ankle=own + legs.zero, power=0.0)
            slope = legs.scale * _relaxed_stiffness(curve, legs, at)
            stiff = replace(stiff, device=slope, ankle=slope)
        yield bare
        if wanted in STIFFNESS_TORQUES:
            yield stiff


def _crossing(degrees: FloatArray, torque: FloatArray, wanted: float) -> FloatArray:
    """Where each row of a growing torque is so large [deg]; at an end where it never is."""
    i = np.clip((torque < wanted).sum(axis=1), 1, len(degrees) - 1)
    row = np.arange(len(torque))
    before = torque[row, i - 1]
    after = torque[row, i]
    part = np.clip((wanted - before) / np.maximum(after - before, 1e-12), 0.0, 1.0)
    made: FloatArray = degrees[i - 1] + part * (degrees[i] - degrees[i - 1])
    return made


def _of_time(
    curve: RelaxedCurve, legs: PossibleLegs, moved: tuple[float, float]
) -> Iterator[_Asked]:
    """What relaxes, and what a stretch to and fro takes."""
    gone = 1.0 - np.exp(-_RELAXED / np.array(TAUS))
    share = 100.0 * (legs.gamma @ gone) / (1.0 + legs.gamma.sum(axis=1))
    power = _SHARE_LEFT_OUT / LEFT_OUT
    share = share * legs.scale**power
    yield _Asked(
        f"relaxed_share@{_RELAXED:g}s",
        "%",
        "Part of a sudden stretch's torque that has relaxed after some seconds.",
        device=share,
        ankle=share,
        power=power,
    )
    loop = _Asked(
        "hysteresis",
        "%",
        "Energy that the relaxed ankle takes from a slow stretch from −30° to the end of the "
        "dorsiflexion that was moved and back, at 5°/s, as a part of the work of the way there.",
        span=(SLOW_FROM, moved[1]),
    )
    low, high = moved
    if curve.high < high - _REACHES or high < SLOW_FROM + _ON_ITS_WAY:
        why = Message("none/rest-short", low=curve.low, high=curve.high, first=low, last=high)
        yield replace(loop, missing=why)
        return
    power = _LOOP_LEFT_OUT / LEFT_OUT
    lost = _hysteresis(curve, legs, high) * legs.scale**power
    yield replace(loop, device=lost, ankle=lost, power=power)


def _hysteresis(curve: RelaxedCurve, legs: PossibleLegs, end: float) -> FloatArray:
    """100·∮T dθ/∫(T − T₀) dθ of the way to `end` [deg], T₀ the torque at its start."""
    elastic, lagging, angle = _loop_features(curve.low, curve.high, end)
    torque = legs.weights @ elastic.T
    for k, each in enumerate(lagging):
        torque = torque + legs.gamma[:, [k]] * (legs.weights @ each.T)
    between = 0.5 * (torque[:, 1:] + torque[:, :-1]) - torque[:, [0]]
    steps = np.diff(angle)
    lost = between @ steps
    there = between @ np.maximum(steps, 0.0)
    return np.asarray(100.0 * lost / np.where(there > 0.0, there, np.nan))


@lru_cache(maxsize=16)
def _loop_features(
    low: float, high: float, end: float
) -> tuple[FloatArray, list[FloatArray], FloatArray]:
    there = np.arange(SLOW_FROM, end + 0.5 * _LOOP_STEP, _LOOP_STEP)
    angle = np.concatenate([there, there[-2::-1]])
    elastic = Basis(low, high).features(np.clip(angle, low - BEYOND, high + BEYOND))
    return elastic, lags(elastic, SLOW_SPEED / _LOOP_STEP), angle


def _relaxed_torque(curve: RelaxedCurve, legs: PossibleLegs, at: FloatArray) -> FloatArray:
    return _rowwise(curve.basis.features(at), legs.weights)


def _relaxed_stiffness(curve: RelaxedCurve, legs: PossibleLegs, at: FloatArray) -> FloatArray:
    return _rowwise(curve.basis.slopes(at), legs.weights)


def _slow_torque(curve: RelaxedCurve, legs: PossibleLegs, at: FloatArray) -> FloatArray:
    angles, elastic, lagging = slow_features(curve.low, curve.high)
    place = np.clip((at - angles[0]) / (angles[1] - angles[0]), 0, len(angles) - 1.001)
    i = place.astype(int)
    part = (place - i)[:, None]
    torque = np.zeros(len(at))
    for k, rows in enumerate((elastic, *lagging)):
        there = (1.0 - part) * rows[i] + part * rows[i + 1]
        torque += (1.0 if k == 0 else legs.gamma[:, k - 1]) * _rowwise(there, legs.weights)
    return torque


def _slow_stiffness(curve: RelaxedCurve, legs: PossibleLegs, at: FloatArray) -> FloatArray:
    return 0.5 * (_slow_torque(curve, legs, at + 1.0) - _slow_torque(curve, legs, at - 1.0))


def _rowwise(rows: FloatArray, weights: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ij,ij->i", rows, weights))


def _quantiles(values: FloatArray, share: FloatArray) -> tuple[float, float, float]:
    """Weighted 2.5 %, 50 % and 97.5 % of possible legs."""
    order = np.argsort(values)
    below = np.cumsum(share[order]) - 0.5 * share[order]
    low, middle, high = np.interp(_QUANTILES, below, values[order])
    return float(low), float(middle), float(high)


def _measure(asked: _Asked, curve: RelaxedCurve, legs: PossibleLegs) -> RestMeasure:
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
    if legs.share[there].sum() < _REACHING:
        return RestMeasure(replace(bare, note=Message("measure/lacking")))
    share = legs.share[there] / legs.share[there].sum()
    same = legs.scale[there] ** asked.power  # what the equations leave out of this leg
    first, value, last = _quantiles(asked.device[there], share)
    low, _, high = _quantiles(asked.ankle[there], share)
    ci95 = (min(low, first), max(high, last))  # the zero makes nothing surer
    verdict, note = _judged(value, ci95, asked.unit, curve)
    anew = math.sqrt(2.0)
    begin, middle, end = _quantiles(asked.device[there] / same, share)
    own, _, other = _quantiles(asked.ankle[there] / same, share)
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
    session = standard_error_of((min(own, begin), max(other, end)))
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
) -> tuple[_Asked, ...]:
    """Every measure of these possible legs of a curve, not judged: values by leg, or why none.

    The range is the device's, through which a leg that is mounted anew moves otherwise, so that the
    whole of its zero is in what is over that range.
    """
    return (
        *_at_angles(curve, legs, angles),
        *_of_range(curve, legs, curve.moved, 1.0),
        *_at_torques(curve, legs),
        *_of_time(curve, legs, curve.moved),
    )
