"""From a recording to model inputs: the whole chain, and a plain account of it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from surae.base.errors import InputError, within
from surae.base.frozen import as_read_only, read_only
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.recording import MUSCLES, Channel, Recording
from surae.recording.emg_kind import contradiction, look_of
from surae.signals.filters import ANTIALIAS_PASS, ANTIALIAS_STOP, HIGHEST_CUTOFF, zero_phase
from surae.signals.inputs import Film, ModelInputs
from surae.signals.rectified import lost_to_rate, rectified_density
from surae.signals.resample import (
    MINIMUM_SAMPLES,
    Uniform,
    derivatives,
    needs_antialias,
    resample,
    uniform,
)
from surae.signals.settings import Preparation
from surae.signals.timebase import SAME_STEPS, UNIFORM_STEPS, Axis, common_axis, timing

_DEFAULTS = Preparation()
#: The angle's derivatives and the channels that have them where they were measured.
_DERIVATIVES = {"velocity": "angular_velocity", "acceleration": "angular_acceleration"}
_SECOND = "second_angle"


def prepare(
    recording: Recording, settings: Preparation = _DEFAULTS, *, prepared: bool = False
) -> ModelInputs:
    """Bring a recording to what a model reads.

    Raw EMG: mean removed, high-pass, rectified, optional low-pass. Angle and torque: Bessel
    low-pass. Then every channel is anti-aliased where that is needed and given on one uniform axis
    over the span that all share, at `settings.rate_hz` or the rate of the slowest channel where
    that is lower: samples added in between would carry no information, but correlate the residuals
    and make the estimates look more certain than they are. EMG envelopes and measured derivatives
    are only resampled; derivatives that were not measured come from the prepared angle.

    Parameters
    ----------
    recording : Recording
        The trial; its own `prepare` settings override `settings`.
    settings : Preparation
        Cut-offs, orders and rate.
    prepared : bool
        Use all signals as they are: no filter goes over them. They must share one uniform time
        axis; only derivatives that are not given are computed. A fit by `auto` may lower their rate
        (`surae.signals.thinned`); predictions and simulations never do.

    Returns
    -------
    ModelInputs
        Without `torque` where none was recorded. The muscles without EMG are in `missing_emg`.

    Raises
    ------
    InputError
        The time axes, rates, units or EMG do not allow it; the message names the recording, the
        channel and what to do.

    Examples
    --------
    >>> surae.prepare(surae.read("trial.csv")).rate_hz
    """
    if "angle" not in recording.channels:
        raise InputError(f"{recording.where}: there is no angle; add its column")
    with within(recording.where):
        settings = settings.updated(recording.prepare)
    rate_hz, time, signals, steps = (
        _as_they_are(recording) if prepared else _chain(recording, settings)
    )
    computed = derivatives(signals["angle"], rate_hz, where=f"{recording.where}: angle")
    steps = [*steps, _derivative_step(signals)]
    second = [signals[_SECOND]] if _SECOND in signals else []
    second += [derivatives(a, rate_hz, where=f"{recording.where}: {_SECOND}")[0] for a in second]

    present = tuple(muscle for muscle in MUSCLES if f"emg_{muscle}" in signals)
    emg = np.zeros((len(time), len(MUSCLES)))
    for muscle in present:
        emg[:, MUSCLES.index(muscle)] = signals[f"emg_{muscle}"]
    missing = tuple(muscle for muscle in MUSCLES if muscle not in present)
    if missing:
        steps.append(Message("made/no-emg", muscles=", ".join(missing)))
    if present and recording.emg != "raw":
        steps += _envelope_rate_step([recording.channels[f"emg_{m}"] for m in present])
    torque = signals.get("torque")
    units = (c.unit for role, c in recording.channels.items() if role.startswith("emg_"))
    cutoff = None if prepared else settings.bessel_hz
    rectifies = bool(present) and recording.emg == "raw" and not prepared
    return ModelInputs(
        name=recording.name,
        rate_hz=rate_hz,
        time=read_only(time),
        angle=read_only(signals["angle"]),
        velocity=read_only(signals.get("angular_velocity", computed[0])),
        acceleration=read_only(signals.get("angular_acceleration", computed[1])),
        emg=read_only(emg),
        emg_unit=next(units, "V"),  # a recording has but one
        torque=None if torque is None else read_only(torque),
        missing_emg=missing,
        steps=tuple(steps),
        prepared=prepared,
        fixed=recording.fixed,
        files=recording.files,
        films=tuple(
            _film(recording, role) for role in recording.films if role.startswith("fascicle_")
        ),
        own_envelopes=rectifies,
        rectified=_rectified(recording, settings) if rectifies else (),
        emg_lost=_lost(recording, settings) if rectifies else 0.0,
        measured=tuple(name for name, role in _DERIVATIVES.items() if role in signals),
        second=tuple(map(read_only, second)),
        lowpass=None if cutoff is None else (cutoff, settings.bessel_order),
    )


def _film(recording: Recording, role: str) -> Film:
    """A muscle in a film: its fascicle’s length, and how thick it is where pennation was filmed."""
    channel = recording.films[role]
    slant = recording.films.get(role.replace("fascicle", "pennation"))
    thickness = 0.0
    if slant is not None and len(slant.time) > 1:
        seen = (channel.time >= slant.time[0]) & (channel.time <= slant.time[-1])
        angle = np.interp(channel.time[seen], slant.time, slant.values)
        across = channel.values[seen] * np.sin(angle)
        thickness = max(float(np.mean(across)), 0.0) if seen.any() else 0.0
    return Film(role, as_read_only(channel.time), as_read_only(channel.values), thickness)


def smoothed(inputs: ModelInputs) -> ModelInputs:
    """The inputs with the low-pass that motion and torque went through, once more.

    The same where there was none, or none that the rate can tell. A derivative that was measured
    went through no filter, and goes through none here.
    """
    if inputs.lowpass is None or inputs.lowpass[0] >= HIGHEST_CUTOFF * inputs.rate_hz:
        return inputs
    cutoff, order = inputs.lowpass

    signals = _filtered(inputs)
    rows = np.stack([*signals.values(), *inputs.second])  # at once: calls take as long as filters
    low = zero_phase("bessel", rows, inputs.rate_hz, cutoff, order, where=inputs.where)
    left: dict[str, Any] = {name: read_only(row) for name, row in zip(signals, low, strict=False)}
    return replace(inputs, **left, second=tuple(map(read_only, low[len(signals) :])))


def sharpened(inputs: ModelInputs) -> ModelInputs:
    """The inputs with what the low-pass took from motion and torque given back, nearly.

    A filter and a muscle do not commute: the torque at a smoothed angle is not the smoothed torque,
    and the EMG went through no filter. What is taken from a fast movement would pass for a weaker
    muscle or a softer tendon. Filtering once more shows what is lost, and twice the signal less
    what is left of it (Tukey's twicing) has it back: the gain is 1 − (1 − H)² in place of H, and
    nowhere above one.
    """
    once = smoothed(inputs)
    if once is inputs:
        return inputs
    left = _filtered(once)
    twice: dict[str, Any] = {
        name: read_only(2.0 * signal - left[name]) for name, signal in _filtered(inputs).items()
    }
    second = zip(inputs.second, once.second, strict=True)
    return replace(inputs, **twice, second=tuple(read_only(2.0 * a - b) for a, b in second))


def _filtered(inputs: ModelInputs) -> dict[str, FloatArray]:
    """What the low-pass went over, by field of `ModelInputs`."""
    signals = {name: getattr(inputs, name) for name in ("angle", *_DERIVATIVES)}
    if inputs.torque is not None:
        signals["torque"] = inputs.torque
    return {name: signal for name, signal in signals.items() if name not in inputs.measured}


#: Rate [Hz], time, signals by role on it, and the account of how they came there.
_Signals = tuple[float, FloatArray, dict[str, FloatArray], list[str]]


def _as_they_are(recording: Recording) -> _Signals:
    """Signals that need no preparation."""
    name = recording.where
    channels = recording.signals
    angle = channels["angle"]
    timings = {role: timing(channel, name) for role, channel in channels.items()}
    stamps = timings["angle"]
    instead = "prepare them on one uniform time axis, or leave out --prepared (prepared=False)"
    if not stamps.uniform:
        raise InputError(
            f"{name}: prepared signals are not sampled uniformly (time stamps are off by up to "
            f"{1e3 * stamps.jitter_s:.3g} ms); {instead}"
        )
    tolerance = SAME_STEPS / stamps.axis.rate_hz
    for role, channel in channels.items():
        same = len(channel.time) == len(angle.time)
        if not same or np.max(np.abs(channel.time - angle.time)) > tolerance:
            raise InputError(
                f"{name}: prepared signals do not share one time axis (angle and {role} differ); "
                f"{instead}"
            )
        if role.startswith("emg_"):
            refuse_negative(channel, f"{name}: {role}", recording.emg)
    time = angle.time if stamps.jitter_s <= tolerance else stamps.axis.time
    step = f"All signals are used as they are, at {stamps.axis.rate_hz:.6g} Hz."
    return stamps.axis.rate_hz, time, {role: c.values for role, c in channels.items()}, [step]


def _chain(recording: Recording, settings: Preparation) -> _Signals:
    """Filtered and resampled signals."""
    sources = {
        role: uniform(channel, recording.where) for role, channel in recording.signals.items()
    }
    axis = common_axis(
        [source.axis for source in sources.values()],
        settings.rate_hz,
        recording.where,
        MINIMUM_SAMPLES,
    )
    steps = [step for role, source in sources.items() if (step := _jitter_step(role, source))]
    filtered = dict(sources)
    emg = [role for role in sources if role.startswith("emg_")]
    for role in emg:
        if recording.emg == "raw":
            refuse_not_raw(recording.channels[role], sources[role], settings)
            filtered[role] = envelope(sources[role], settings)
        else:
            refuse_negative(recording.channels[role], sources[role].where, recording.emg)
    if emg and recording.emg == "raw":
        steps.append(envelope_step([sources[role] for role in emg], settings))
    mechanical = [role for role in ("angle", _SECOND, "torque") if role in sources]
    if settings.bessel_hz is not None:
        for role in mechanical:
            source = sources[role]
            values = zero_phase(
                "bessel",
                source.values,
                source.axis.rate_hz,
                settings.bessel_hz,
                settings.bessel_order,
                where=source.where,
            )
            filtered[role] = source.replaced(values)
        which = " and ".join(mechanical).replace("_", " ").capitalize()
        how = {"order": settings.bessel_order, "hz": settings.bessel_hz}
        steps.append(Message("made/bessel", which=which, **how))

    signals = {
        role: resample(signal, axis, ends="even" if role in emg else "odd")
        for role, signal in filtered.items()
    }
    steps += _resampling_steps(sources, axis, settings.rate_hz)
    # Of every muscle its most negative sample, as a part of its maximum.
    shares = [-float(signals[r].min()) / top for r in emg if (top := float(signals[r].max())) > 0.0]
    if (negative := max(shares, default=0.0)) > 0.0:
        signals |= {role: np.maximum(signals[role], 0.0) for role in emg}
        steps.append(Message("made/negative", percent=100 * negative))
    return axis.rate_hz, axis.time, signals, steps


def _jitter_step(role: str, source: Uniform) -> str:
    """What was made of time stamps that are not uniform; empty where they are."""
    stamps = source.timing
    hz = source.timing.axis.rate_hz
    if stamps.uniform and stamps.jitter_s * hz <= UNIFORM_STEPS:
        return ""
    code = "made/rounded" if stamps.uniform else "made/jitter"
    return Message(code, role=role, ms=1e3 * stamps.jitter_s, hz=hz)


def _resampling_steps(
    sources: Mapping[str, Uniform], axis: Axis, wanted_hz: float
) -> list[Message]:
    """What was done to bring the signals on the common axis."""
    fast = [role for role, source in sources.items() if needs_antialias(source.axis, axis)]
    moved = [role for role, source in sources.items() if source.axis != axis]
    steps = []
    if fast:
        edges = {"hz": ANTIALIAS_PASS * axis.rate_hz, "stop": ANTIALIAS_STOP * axis.rate_hz}
        steps.append(Message("made/antialiased", roles=", ".join(fast), **edges))
    ends = {"n": axis.n, "start": axis.start, "end": axis.end, "hz": axis.rate_hz}
    steps.append(Message("made/resampled" if moved else "made/kept", **ends))
    if axis.rate_hz < wanted_hz and not math.isclose(axis.rate_hz, wanted_hz, rel_tol=SAME_STEPS):
        slowest = min(sources, key=lambda role: sources[role].axis.rate_hz)
        steps.append(Message("made/slowest", role=slowest, hz=wanted_hz))
    return steps


#: Envelopes of a lower rate [Hz] say less than a fit by `auto` reads.
_FULL_HZ = 64.0


def _envelope_rate_step(envelopes: Sequence[Channel]) -> list[Message]:
    """What envelopes of this rate cannot say: nothing brings back what lies above half of it."""
    rate_hz = min(channel.rate_hz for channel in envelopes)
    if rate_hz >= _FULL_HZ * (1.0 - UNIFORM_STEPS):
        return []
    return [Message("made/slow-envelope", hz=rate_hz, half=rate_hz / 2.0)]


def _derivative_step(signals: Mapping[str, FloatArray]) -> str:
    """Say where velocity and acceleration come from."""
    how = "from the angle by central differences over 15 samples"
    measured = [role for role in _DERIVATIVES.values() if role in signals]
    if len(measured) == 2:
        return "Angular velocity and acceleration are those given."
    if not measured:
        return f"Angular velocity and acceleration {how}."
    other = next(role for role in _DERIVATIVES.values() if role not in signals)
    given, computed = (role.replace("_", " ") for role in (measured[0], other))
    return f"The {given} is that given. {computed.capitalize()} {how}."


#: Filters of raw EMG in their order, which is rectified between them.
_EMG_FILTERS: dict[Literal["highpass", "lowpass"], str] = {
    "highpass": "high-pass",
    "lowpass": "low-pass",
}
#: Raw EMG must be sampled at this many times its high-pass cut-off.
RATE_FACTOR = 4.0

#: An envelope may be negative by this fraction of its maximum: a low-pass filter rings by a few
#: hundredths, raw EMG is as negative as it is positive.
NEGATIVE_FRACTION = 0.1


def envelope(source: Uniform, settings: Preparation) -> Uniform:
    """Mean removed, high-passed, rectified and, where set, low-passed EMG at its own rate."""
    highpassed = _filtered_emg("highpass", source.values - source.values.mean(), source, settings)
    return source.replaced(_filtered_emg("lowpass", np.abs(highpassed), source, settings))


def _filtered_emg(
    kind: Literal["highpass", "lowpass"], values: FloatArray, source: Uniform, settings: Preparation
) -> FloatArray:
    """The values of an EMG channel through one of its filters, if that is set."""
    cutoff, order = (getattr(settings, f"emg_{kind}_{what}") for what in ("hz", "order"))
    if cutoff is None:
        return values
    rate_hz = source.axis.rate_hz
    return zero_phase(kind, values, rate_hz, cutoff, order, ends="even", where=source.where)


def _rectified(recording: Recording, settings: Preparation) -> tuple[float, ...]:
    """Noise that rectifying leaves in each envelope, see `rectified_density`; 0 without EMG."""
    density = dict.fromkeys(MUSCLES, 0.0)
    for muscle in MUSCLES:
        if channel := recording.signals.get(f"emg_{muscle}"):
            source = uniform(channel, recording.where)
            values = source.values - source.values.mean()
            values = _filtered_emg("highpass", values, source, settings)
            density[muscle] = rectified_density(values, source.axis.rate_hz)
    return tuple(density.values())


def _lost(recording: Recording, settings: Preparation) -> float:
    """How far the EMG may be too small for its rate, see `lost_to_rate`."""
    rates = [c.rate_hz for role, c in recording.signals.items() if role.startswith("emg_")]
    return max(lost_to_rate(rate, settings.emg_highpass_hz or 0.0) for rate in rates)


def refuse_not_raw(channel: Channel, source: Uniform, settings: Preparation) -> None:
    """Raise InputError where raw EMG is an envelope, or too slow for the high-pass filter."""
    lowest = float(channel.values.min())
    highest = float(channel.values.max())
    if lowest >= 0.0 and highest > lowest:
        # On a constant offset, which the filter takes away, raw EMG has no negative sample either.
        sentence = contradiction(channel.role, look_of(channel.time, channel.values), "raw")
        if sentence:
            trial = source.where.removesuffix(f": {channel.role}")
            raise InputError(f"{trial}: {sentence}, or use --prepared if all signals are")
    cutoff = settings.emg_highpass_hz
    if cutoff is not None and source.axis.rate_hz < RATE_FACTOR * cutoff:
        raise InputError(
            f"{source.where}: raw EMG at {source.axis.rate_hz:g} Hz is too slow for the high-pass "
            f"at {cutoff:g} Hz, which needs {RATE_FACTOR * cutoff:g} Hz; if it is an envelope "
            f"say so (# emg: envelope), else lower emg_highpass_hz in the [prepare] settings"
        )


def refuse_negative(channel: Channel, where: str, declared: str) -> None:
    """Refuse an envelope that is negative by more than a tenth of its maximum."""
    at = int(np.argmin(channel.values))
    lowest = float(channel.values[at])
    highest = float(channel.values.max())
    if lowest < -NEGATIVE_FRACTION * max(highest, 0.0):
        sentence = contradiction(channel.role, look_of(channel.time, channel.values), declared)
        if sentence:
            raise InputError(f"{where.removesuffix(f': {channel.role}')}: {sentence}")
        raise InputError(
            f"{where}: an EMG envelope cannot be negative, but it is {lowest:.3g} at "
            f"{channel.time[at]:.6g} s (maximum {highest:.3g}); fit raw EMG without --prepared"
        )


def envelope_step(sources: list[Uniform], settings: Preparation) -> str:
    """What was done to raw EMG."""
    rates = sorted({source.axis.rate_hz for source in sources})
    parts = ["mean removed"]
    for kind, words in _EMG_FILTERS.items():
        cutoff, order = (getattr(settings, f"emg_{kind}_{what}") for what in ("hz", "order"))
        parts += ["rectified"] if kind == "lowpass" else []
        if cutoff is not None:
            parts.append(
                f"zero-phase Butterworth {words} of order {order} (-3 dB at {cutoff:g} Hz after "
                "both passes)"
            )
    return f"EMG ({', '.join(f'{rate:.6g}' for rate in rates)} Hz): {', '.join(parts)}."
