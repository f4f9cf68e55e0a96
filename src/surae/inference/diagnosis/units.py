"""Units that cannot be what a recording says they are, put right."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from surae.base.frozen import read_only
from surae.base.words import Message
from surae.inference.diagnosis.explanations import (
    SIGNS,
    Explanation,
    compared,
    joined,
    possible,
    tried,
)
from surae.quality import Finding
from surae.quality.electrodes import Electrode, Electrodes, electrodes_of
from surae.quality.finding import make_finding
from surae.quality.numeric import quantile, span_of
from surae.quality.registry import unfit
from surae.quality.trial import signals_of
from surae.recording import MUSCLE_NAMES, MUSCLES, Channel, Recording
from surae.recording.corrections import Corrections

#: Torque of an ankle [Nm] and duration [s] and rate [Hz] of a trial: least and most.
_TORQUES = (1.0, 400.0)
_SECONDS = (2.0, 3600.0)
_RATES = (20.0, 50_000.0)
#: A torque that stays below this [Nm] may be per kilogram: 1 to 2 Nm/kg are an ankle's most in
#: walking and jumping (Winter 2009), while gravity alone turns a foot by 2 to 4 Nm.
_SMALL = 4.0
#: Movement [rad] over which the passive torque alone grows by more than that.
_MOVES = 0.35
#: Seconds of a trial below which a torque that an ankle may have is not said to be in another unit.
_TELLS = 3.0
#: Body mass [kg] for which per kilogram is tried, and the units that a torque may be in.
_BODY = 70.0
_UNITS = {"mNm": 1e-3, "cNm": 1e-2, "kNm": 1e3, "per-kg": _BODY, "mNm-per-kg": 1e-3 * _BODY}
#: No two muscles of a leg differ by this factor.
_MUSCLES = 100.0
#: The largest EMG that skin gives [V], and the largest of any amplifier's output.
_SKIN = 0.012
_AMPLIFIER = 12.0
#: Skin and amplifier alone make more [V].
_NOISE = 1e-6
#: Rest of an amplifier, over so long [s], is never less [V]; the least EMG of an effort [V].
_AMPLIFIERS_REST = 1e-7
_QUIET_S = 0.25
_EFFORT = 5e-5

#: A finding on a unit, and the recording with that unit put right.
_Righted = tuple[Finding, Recording]


def wrong_units(
    recording: Recording, electrodes: Electrodes | None = None
) -> tuple[list[Finding], Recording]:
    """Units that cannot be what they are declared to be, and the recording with them put right.

    `electrodes` are what all trials of the leg show of theirs, else this one's are taken.
    """
    findings: list[Finding] = []
    if "angle" not in recording.channels:
        return findings, recording
    for of_unit in (_time_unit, _torque_unit):
        if (righted := of_unit(recording)) is not None:
            findings.append(righted[0])
            recording = righted[1]
    for _ in MUSCLES:
        as_read = recording
        if (righted := _emg_unit(recording, electrodes)) is None or righted[0] in findings:
            break
        findings.append(righted[0])
        recording = righted[1]
        electrodes = electrodes and electrodes.in_units(as_read, recording)
    return findings, recording


def scaled(recording: Recording, role: str, factor: float) -> Recording:
    """The recording with one of its channels times a factor."""
    channel = recording.channels[role]
    larger = replace(channel, values=read_only(channel.values * factor))
    return replace(recording, channels={**recording.channels, role: larger})


def _time_unit(recording: Recording) -> _Righted | None:
    """Times in ms or µs that are declared as seconds."""
    angle = recording.channels["angle"]
    seconds = float(angle.time[-1] - angle.time[0])
    rate = angle.rate_hz
    for unit, factor in (("ms", 1e-3), ("µs", 1e-6)):
        lasting = seconds * factor
        true_rate = rate / factor
        plausible = _SECONDS[0] <= lasting <= _SECONDS[1] and _RATES[0] <= true_rate <= _RATES[1]
        if rate >= _RATES[0] or not plausible:
            continue
        finding = make_finding(
            "time-unit",
            "time",
            span_of(angle.time),
            seconds,
            advice="time-unit/named",
            seconds=seconds,
            rate=rate,
            read=unit,
            lasting=lasting,
            hz=true_rate,
            times=1 / factor,
        )
        channels = {
            role: replace(c, time=read_only(c.time * factor))
            for role, c in recording.channels.items()
        }
        return finding, replace(recording, channels=channels)
    return None


def _torque_unit(recording: Recording) -> _Righted | None:
    """A torque in mNm, in kNm or per kilogram that is declared as Nm."""
    if (torque := recording.channels.get("torque")) is None:
        return None
    top = quantile(np.abs(torque.values), 0.99)
    (least, most) = _TORQUES
    if _SMALL <= top <= most:
        return None
    others = [
        Explanation(Message(f"read/{unit}"), Corrections(scale={"torque": factor}))
        for unit, factor in _UNITS.items()
        if least <= top * factor <= most
    ]
    as_it_is = Explanation("")
    signs: list[Explanation] = []
    if unfit(recording) is None:
        signals = signals_of(recording)
        as_it_is, *others = (tried(recording, signals, each) for each in (as_it_is, *others))
        if least <= top <= most:  # so large an ankle's may be, and a sign be what is wrong
            signs = [tried(recording, signals, each) for each in SIGNS]
    clearly = possible([as_it_is, *others, *signs])
    if clearly and all(each in signs for each in clearly):
        return None
    good = possible([as_it_is, *others])
    likely = [each for each in good or others if each is not as_it_is]
    plausible = least <= top <= most and (as_it_is in good or not good)
    # Without gravity a fit of a small torque is as good: but no ankle moves so far with so little.
    moved = float(np.ptp(recording.channels["angle"].values)) > _MOVES
    if not likely or (plausible and not (moved and recording.fixed.get("m") == 0.0)):
        return None
    start, end = recording.shared
    if least <= top <= most and not moved and end - start < _TELLS:
        return None  # a part of one movement: so little torque is an ankle's too
    best, *more = likely
    if more or plausible:
        likely = [*likely, *([Explanation(Message("read/Nm"))] if plausible else ())]
        what = Message("read/either", what=joined(*(each.words for each in likely), by="or"))
    else:
        rest = [each for each in (*others, *signs) if each is not best]
        numbers = compared(best, as_it_is, rest)
        which = "read/it-is/compared" if numbers else "read/it-is"
        what = Message(which, what=best.words, numbers=numbers)
    advice = best.right.lines(recording)
    scale = best.right.scale["torque"]
    if more:
        advice = Message("advice/torque-unit")
    elif scale in (_BODY, _UNITS["mNm-per-kg"]):
        advice = Message("advice/torque-unit/per-kg", lines=advice, scale=scale, kg=_BODY)
    righted = recording if more or plausible else best.right(recording)
    return make_finding(
        "torque-unit",
        "torque",
        span_of(torque.time),
        top,
        advice=advice,
        severity="warning" if plausible else "error",
        what=what,
        reach=Message("read/reach/large" if top > most else "read/reach/small", top=top),
    ), righted


def _named_smaller(recording: Recording, levels: Mapping[str, Electrode]) -> Finding | None:
    """EMG in V that is declared as mV or µV: its rest is less than any amplifier's noise.

    Skin at rest, and the best amplifiers, have 0.3 µV and more; an effort is far above both.
    """
    channels = [recording.channels[role] for role in levels]
    most = max((float(np.abs(c.values).max()) for c in channels), default=0.0)
    rests = [rest for c in channels if (rest := _quietest(c)) > 0.0]
    if recording.emg != "raw" or not rests or min(rests) >= _AMPLIFIERS_REST:
        return None
    times = next((f for f in (1e3, 1e6) if _EFFORT <= f * most <= _SKIN), None)
    if times is None:
        return None
    span = span_of(channels[0].time)
    named = "mV" if times < 1e6 else "µV"
    return make_finding(
        "emg-unit/smaller", None, span, most, severity="warning", top=most, times=times, named=named
    )


def _quietest(channel: Channel) -> float:
    """Root mean square of the quietest quarter of a second [V], its mean taken out."""
    size = max(round(_QUIET_S * channel.rate_hz), 2)
    n = len(channel.values) // size
    if n < 2:
        return 0.0
    pieces = channel.values[: n * size].reshape(n, size)
    return float(pieces.std(axis=1).min())


def _emg_unit(recording: Recording, electrodes: Electrodes | None) -> _Righted | None:
    """EMG of one muscle in mV or µV among others in volts; what all of it can be for information.

    The weights of the muscles take any unit that all EMG has alike, so a fit cannot tell it.
    """
    volts = [r for r, c in recording.channels.items() if r.startswith("emg_") and c.unit == "V"]
    levels = _levels(recording, electrodes)
    levels = {role: level for role, level in levels.items() if role in volts}
    tops = {role: level.peak for role, level in levels.items()}
    largest = max(tops, key=lambda role: tops[role], default="")
    top = tops.get(largest, 0.0)
    others = max((top for role, top in tops.items() if role != largest), default=0.0)
    span = span_of(recording.channels["angle"].time)
    works = all(level.works for level in levels.values()) and others > 0.0
    if works and top > _MUSCLES * others:
        factor, unit = (1e-6, "µV") if top > 1e4 * others else (1e-3, "mV")
        finding = make_finding(
            "emg-unit/one",
            largest,
            span,
            top,
            muscle=Message(MUSCLE_NAMES[largest.removeprefix("emg_")]),
            top=top,
            others=others,
            read=unit,
            then=top * factor,
            role=largest,
        )
        return finding, scaled(recording, largest, factor)
    if top > _AMPLIFIER:
        taken = make_finding(
            "emg-unit/all", None, span, top, severity="warning", top=top, then=top * 1e-6
        )
        return taken, recording
    if (smaller := _named_smaller(recording, levels)) is not None:
        return smaller, recording
    if 0.0 < top < _NOISE and max(level.top for level in levels.values()) < _NOISE:
        small = make_finding("emg-unit/small", None, span, top, severity="warning", top=top)
        return small, recording
    if top > _SKIN:
        large = make_finding("emg-unit/large", None, span, top, severity="info", top=top)
        return large, recording
    return None


def _levels(recording: Recording, electrodes: Electrodes | None) -> dict[str, Electrode]:
    """What is known of each EMG channel that varies, by role."""
    if electrodes is None and unfit(recording) is None:
        signals = signals_of(recording)
        electrodes = electrodes_of(recording, signals.fast, signals.rate_hz)
    known = {} if electrodes is None else electrodes.levels
    return {f"emg_{muscle}": level for muscle, level in known.items()}
