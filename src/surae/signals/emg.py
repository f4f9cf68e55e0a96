"""EMG: from electrodes to envelopes, and what cannot be an envelope or raw EMG."""

import numpy as np

from surae.errors import InputError
from surae.recording import Channel
from surae.recording.emg_kind import contradiction, look_of
from surae.signals.filters import butterworth
from surae.signals.resample import Uniform
from surae.signals.settings import Preparation

#: Raw EMG must be sampled at this many times its high-pass cut-off.
RATE_FACTOR = 4.0

#: An envelope may be negative by this fraction of its maximum: a low-pass filter rings by a few
#: hundredths, raw EMG is as negative as it is positive.
NEGATIVE_FRACTION = 0.1


def envelope(source: Uniform, settings: Preparation) -> Uniform:
    """Mean removed, high-passed, rectified and, where set, low-passed EMG at its own rate."""
    rate, where = source.axis.rate_hz, source.where
    values = source.values - source.values.mean()
    high, low = settings.emg_highpass_hz, settings.emg_lowpass_hz
    if high is not None:
        values = butterworth(
            values, rate, high, settings.emg_highpass_order, "highpass", ends="even", where=where
        )
    values = np.abs(values)
    if low is not None:
        values = butterworth(
            values, rate, low, settings.emg_lowpass_order, "lowpass", ends="even", where=where
        )
    return source.replaced(values)


def refuse_not_raw(channel: Channel, source: Uniform, settings: Preparation) -> None:
    """Raise InputError where raw EMG is an envelope, or too slow for the high-pass filter."""
    lowest, highest = float(channel.values.min()), float(channel.values.max())
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
    """Raise InputError where an envelope is negative by more than a tenth of its maximum.

    `declared` is what the recording says that its EMG is.
    """
    at = int(np.argmin(channel.values))
    lowest, highest = float(channel.values[at]), float(channel.values.max())
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
    if settings.emg_highpass_hz is not None:
        parts.append(
            f"zero-phase Butterworth high-pass of order {settings.emg_highpass_order} (-3 dB at "
            f"{settings.emg_highpass_hz:g} Hz after both passes)"
        )
    parts.append("rectified")
    if settings.emg_lowpass_hz is not None:
        parts.append(
            f"zero-phase Butterworth low-pass of order {settings.emg_lowpass_order} (-3 dB at "
            f"{settings.emg_lowpass_hz:g} Hz after both passes)"
        )
    return f"EMG ({', '.join(f'{rate:.6g}' for rate in rates)} Hz): {', '.join(parts)}."
