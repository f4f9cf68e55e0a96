"""An angle that no ankle has: degrees, jumps by a turn, another zero, each tried by a quick fit."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from surae.base.units import FACTORS, FloatArray
from surae.base.words import Message
from surae.inference.diagnosis.explanations import (
    Explanation,
    compared,
    joined,
    possible,
    tried,
    turned,
)
from surae.quality import Finding
from surae.quality.finding import make_finding
from surae.quality.numeric import quantiles, span_of
from surae.quality.position import HIGHEST, LOWEST
from surae.quality.registry import unfit
from surae.quality.trial import signals_of
from surae.recording import Recording
from surae.recording.corrections import Corrections, stated_unit

#: A range between these [rad] would be one of 20 to 115° had degrees been divided by 57 twice.
_TWICE = (0.006, 0.035)
#: A jump from one sample to the next by more than this part of a turn is one by a whole turn.
_JUMP = 0.8
#: Zeros that laboratories have [deg]: the neutral foot at 90° to the shank, at 180° to it. Others
#: are tried in steps, but for those so close to one of these.
_ZEROS = (0.0, -90.0, 90.0, -180.0, 180.0)
_STEP = 15.0
#: Part of the samples, at either end of the angle's values, that may lie anywhere.
_STRAY = 0.001


def wrong_angle(recording: Recording) -> tuple[Finding, Recording] | None:
    """What is wrong with an angle that an ankle cannot have, and the recording with it put right.

    The recording is as it was where the data cannot tell what its angle is.
    """
    channel = recording.channels["angle"]
    low = float(channel.values.min())
    high = float(channel.values.max())
    noise = float(np.std(np.diff(channel.values))) > 0.5 * float(np.std(channel.values))
    far = high > HIGHEST or low < LOWEST
    if not far and (noise or not _TWICE[0] <= high - low <= _TWICE[1]):
        return None
    unit = stated_unit(channel)
    whats = _far(channel.values, unit) if far else [_RADIANS]
    tries = [(what, each) for what in whats for each in _signed(recording, what)]
    as_it_is = Explanation("")
    if "torque" in recording.channels and unfit(recording) is None:
        signals = signals_of(recording)
        as_it_is = tried(recording, signals, as_it_is)
        tries = [(what, tried(recording, signals, each)) for what, each in tries]
    good = possible([each for _, each in tries] + ([] if far else [as_it_is]))
    if not far and (not good or as_it_is in good):
        return None
    left = [(what, each) for what, each in tries if each in good] or tries
    fewest = min((what.departures for what, _ in left), default=0)
    left = [(what, each) for what, each in left if what.departures == fewest]
    named = {what.words: what for what, _ in left}
    factor = FACTORS["angle"][unit]
    range_said = Message(
        "read/range/far" if far else "read/range",
        low=low / factor,
        high=high / factor,
        unit="°" if unit == "deg" else f" {unit}",
    )
    what: dict[str, Any] = {}
    which = "none"
    right = recording
    advice = Message("advice/angle-units/find")
    if len(named) == 1:
        best = _certain(left, good)
        others = [each for what, each in tries if what.words not in named]
        what = {"what": best.words, "numbers": compared(best, as_it_is, others)}
        which = "compared" if what["numbers"] else "known"
        right = best.right(recording)
        advice = best.right.lines(recording)
        if best.words == _DEGREES.words:
            advice = Message("advice/angle-units/degrees")
    elif named:
        first, second, *_ = named.values()
        which = "either"
        what = {"one": first.words, "other": second.words}
        advice = Message("advice/angle-units/first", lines=first.right.lines(recording))
    value = max(abs(low), abs(high)) if far else high - low
    return make_finding(
        f"angle-units/{which}",
        "angle",
        span_of(channel.time),
        value,
        advice=advice,
        range=range_said,
        **what,
    ), right


_DEGREES, _RADIANS = (
    Explanation(Message(f"read/{unit}"), Corrections(scale={"angle": float(scale)}))
    for unit, scale in (("degrees", np.deg2rad(1.0)), ("radians", np.rad2deg(1.0)))
)


def _far(values: FloatArray, unit: str) -> Iterator[Explanation]:
    """What an angle beyond an ankle's may be."""
    jump = float(np.abs(np.diff(values)).max())
    factor = FACTORS["angle"][unit]
    bases = [(Explanation("", departures=0), 0.0)]
    if unit == "rad":
        bases.append((_DEGREES, 0.0))
    for base, _ in tuple(bases):
        turn = 2.0 * np.pi * (np.rad2deg(1.0) if base.words else 1.0)
        if _JUMP * turn < jump < turn / _JUMP:
            wrap = replace(base.right, wrap={"angle": float(turn / factor)})
            words = joined(base.words, Message("read/turn"))
            # It may have begun a turn away.
            turns = round(float(np.median(np.unwrap(values, period=turn))) / turn)
            bases.append((Explanation(words, wrap, base.departures + 1), -360.0 * turns))
    grid = np.arange(-180.0 + 2 * _STEP, 180.0, _STEP)
    elsewhere = [x for x in grid if min(abs(x - zero) for zero in _ZEROS) > 1.5 * _STEP]
    for base, away in bases:
        for zero in (*_ZEROS, *elsewhere):
            # The offset is in the unit that the angle has once it is scaled.
            offset = away + zero if unit == "deg" else float(np.deg2rad(away + zero))
            about = zero in elsewhere
            which = "read/zero/about" if about else "read/zero"
            words = joined(base.words, Message(which, degrees=-zero) if zero else "")
            departures = base.departures + (1 if zero else 0) + (1 if about else 0)
            if words:
                right = replace(base.right, offset={"angle": offset} if offset else {})
                yield Explanation(words, right, departures)


def _signed(recording: Recording, what: Explanation) -> Iterator[Explanation]:
    """The same with each pair of signs with which an ankle can have the angle."""
    angle = what.right(recording).channels["angle"].values
    for sign in (1.0, -1.0):
        low, high = quantiles(sign * angle, _STRAY, 1.0 - _STRAY)
        if low < LOWEST or high > HIGHEST:
            continue
        for torque in (1.0, -1.0):
            signs = turned(sign, torque)
            if torque > 0.0 or "torque" in recording.channels:
                words = joined(what.words, signs.words)
                right = replace(what.right, sign=signs.right.sign)
                yield Explanation(words, right, what.departures + signs.departures)


def _certain(left: list[tuple[Explanation, Explanation]], good: list[Explanation]) -> Explanation:
    """What is wrong for certain: with its signs where just one pair is possible, and right."""
    what = left[0][0]
    signed = [each for _, each in left]
    if not good:
        return what
    if len(signed) == 1:
        return signed[0]
    best = max(signed, key=lambda each: each.r2)
    return replace(what, fit=best.fit)
