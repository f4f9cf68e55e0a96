"""Units that cannot be what a recording says they are, put right."""

from dataclasses import replace

import numpy as np

from surae.base.frozen import read_only
from surae.inference.diagnosis.explanations import Explanation, compared, possible, tried
from surae.quality import Finding
from surae.quality.finding import make_finding
from surae.quality.numeric import quantile, quantiles, span_of
from surae.quality.registry import unfit
from surae.quality.trial import signals_of
from surae.recording import MUSCLE_NAMES, MUSCLES, Recording
from surae.recording.corrections import Corrections

#: Torque of an ankle [Nm] and duration [s] and rate [Hz] of a trial: least and most.
_TORQUES, _SECONDS, _RATES = (1.0, 400.0), (2.0, 3600.0), (20.0, 50_000.0)
#: A torque that stays below this [Nm] may be per kilogram: 1 to 2 Nm/kg are an ankle's most in
#: walking and jumping (Winter 2009), while gravity alone turns a foot by 2 to 4 Nm.
_SMALL = 4.0
#: Movement [rad] over which the passive torque alone grows by more than that.
_MOVES = 0.35
#: Body mass [kg] for which per kilogram is tried, and the units that a torque may be in.
_BODY, _PER_KG = 70.0, "per kilogram of body mass"
_UNITS = {"in mNm": 1e-3, "in kNm": 1e3, _PER_KG: _BODY}
#: No two muscles of a leg differ by this factor.
_MUSCLES = 100.0
#: The largest EMG that skin gives [V], and the largest of any amplifier's output.
_SKIN, _AMPLIFIER = 0.012, 12.0

#: A finding on a unit, and the recording with that unit put right.
_Righted = tuple[Finding, Recording]


def wrong_units(recording: Recording) -> tuple[list[Finding], Recording]:
    """Units that cannot be what they are declared to be, and the recording with them put right."""
    findings: list[Finding] = []
    if "angle" not in recording.channels:
        return findings, recording
    for of_unit in (_time_unit, _torque_unit, *[_emg_unit] * len(MUSCLES)):
        righted = of_unit(recording)
        if righted is not None and righted[0] not in findings:
            findings.append(righted[0])
            recording = righted[1]
    return findings, recording


def scaled(recording: Recording, role: str, factor: float) -> Recording:
    """The recording with one of its channels times a factor."""
    channel = recording.channels[role]
    larger = replace(channel, values=read_only(channel.values * factor))
    return replace(recording, channels={**recording.channels, role: larger})


def _time_unit(recording: Recording) -> _Righted | None:
    """Times in ms or µs that are declared as seconds."""
    angle = recording.channels["angle"]
    seconds, rate = float(angle.time[-1] - angle.time[0]), angle.rate_hz
    for unit, factor in (("ms", 1e-3), ("µs", 1e-6)):
        lasting, true_rate = seconds * factor, rate / factor
        plausible = _SECONDS[0] <= lasting <= _SECONDS[1] and _RATES[0] <= true_rate <= _RATES[1]
        if rate >= _RATES[0] or not plausible:
            continue
        finding = make_finding(
            "time-unit", "time", span_of(angle.time), seconds,
            f"The time goes on for {seconds:.4g} s with {rate:.3g} samples a second: in {unit}, "
            f"these are {lasting:.3g} s at {true_rate:.4g} Hz.",
            advice=f"The times are in {unit}: name the column time_{unit}, or divide by "
            f"{1 / factor:g}.",
        )  # fmt: skip
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
    top, (least, most) = quantile(np.abs(torque.values), 0.99), _TORQUES
    if _SMALL <= top <= 2.0 * most:
        return None
    others = [
        Explanation(words, Corrections(scale={"torque": factor}))
        for words, factor in _UNITS.items()
        if least <= top * factor <= most
    ]
    as_it_is = Explanation("")
    if unfit(recording) is None:
        signals = signals_of(recording)
        as_it_is, *others = (tried(recording, signals, each) for each in (as_it_is, *others))
    good = possible([as_it_is, *others])
    likely = [each for each in good or others if each is not as_it_is]
    plausible = least <= top <= most and (as_it_is in good or not good)
    # Without gravity a fit of a small torque is as good: but no ankle moves so far with so little.
    moved = float(np.ptp(recording.channels["angle"].values)) > _MOVES
    if not likely or (plausible and not (moved and recording.fixed.get("m") == 0.0)):
        return None
    best, *more = likely
    text = f"The torque reaches {top:.3g} Nm, "
    text += "more than any ankle makes: " if top > most else "too little for an ankle: "
    if more or plausible:
        likely = [*likely, *([Explanation("in Nm and slight")] if plausible else ())]
        text += f"the data cannot tell whether it is {' or '.join(each.words for each in likely)}."
    else:
        numbers = compared(best, as_it_is, [each for each in others if each is not best])
        text += f"it is {best.words}{', ' if numbers else ''}{numbers}."
    advice = best.right.lines(recording)
    if best.words == _PER_KG:
        advice += f" {_BODY:g} stands for the body mass in kg."
    righted = recording if more or plausible else best.right(recording)
    return make_finding(
        "torque-unit", "torque", span_of(torque.time), top, text, advice=advice,
        severity="warning" if plausible else "error",
    ), righted  # fmt: skip


def _emg_unit(recording: Recording) -> _Righted | None:
    """EMG of one muscle, or of all, in mV or µV that is declared as volts."""
    tops = {}
    for role, channel in recording.channels.items():
        if role.startswith("emg_") and channel.unit == "V":
            low, middle, high = quantiles(channel.values, 0.01, 0.5, 0.99)
            if high > low:
                tops[role] = max(high - middle, middle - low)
    largest = max(tops, key=lambda role: tops[role], default="")
    top = tops.get(largest, 0.0)
    others = max((top for role, top in tops.items() if role != largest), default=0.0)
    one = len(tops) > 1 and top > _MUSCLES * others
    if not one and top <= _SKIN:
        return None
    span = span_of(recording.channels[largest].time)
    if not one and top <= _AMPLIFIER:
        return make_finding(
            "emg-unit", None, span, top,
            f"The EMG reaches {top:.2g} V, more than skin gives: mV, or volts behind an amplifier.",
            severity="info",
            advice="Give the unit or the amplifier's gain if weights are to be compared with "
            "other legs.",
        ), recording  # fmt: skip
    if not one:
        for role in tops:
            recording = scaled(recording, role, 1e-6)
        text = f"The EMG reaches {top:.3g} V: taken as µV, {top * 1e-6:.2g} V."
        return make_finding("emg-unit", None, span, top, text), recording
    factor, unit = (1e-6, "µV") if top > 1e4 * others else (1e-3, "mV")
    muscle = MUSCLE_NAMES[largest.removeprefix("emg_")]
    finding = make_finding(
        "emg-unit", largest, span, top,
        f"The EMG of the {muscle} reaches {top:.3g} V, that of the others {others:.2g} V: "
        f"taken as {unit}, {top * factor:.2g} V.",
        advice=f'Write unit = "{unit}" for {largest} in the TOML.',
    )  # fmt: skip
    return finding, scaled(recording, largest, factor)
