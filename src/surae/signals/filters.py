"""Zero-phase filters whose stated cut-off is the −3 dB point of both passes together.

A filter that runs forward and backward has the squared gain of one pass, so a corner placed at the
cut-off would lose 6 dB there. The corner of the single pass is therefore moved until one pass loses
1.5 dB at the cut-off. Corners are moved on the pre-warped axis tan(π·f/rate), on which the bilinear
transform keeps the analog gain exactly.

Before a pass, the signal is extended at both ends by as many samples as the filter's memory is long
(decay to 1e-4): reflected about its end point (angle and torque keep their slope and the end point
itself), or mirrored (EMG, which must not change sign).
"""

import math
from functools import lru_cache
from typing import Literal

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray

Ends = Literal["odd", "even"]
Kind = Literal["lowpass", "highpass", "bessel"]

#: A cut-off must lie below this fraction of the sampling rate.
HIGHEST_CUTOFF = 0.45

#: The anti-aliasing filter loses 3 dB at `ANTIALIAS_PASS` × target rate, and at least 60 dB from
#: `ANTIALIAS_STOP` × target rate on: what lies beyond would fold back below the former.
ANTIALIAS_PASS = 0.4
ANTIALIAS_STOP = 0.6
ANTIALIAS_ORDER = 10

#: Extension at the ends lasts until the slowest pole has decayed to this.
_MEMORY = 1e-4

#: One pass is to lose half of 3.01 dB at the cut-off: |H|² = 1/√2, so |H|²⁻¹ − 1 = √2 − 1.
_HALF = math.sqrt(2.0) - 1.0


def zero_phase(
    kind: Kind,
    values: FloatArray,
    rate_hz: float,
    cutoff_hz: float,
    order: int,
    *,
    ends: Ends = "odd",
    where: str = "signal",
) -> FloatArray:
    """A Butterworth filter, or a Bessel low-pass, which does not overshoot at a step, of (…, n).

    `cutoff_hz` is the −3 dB point of both passes together, `order` that of one; `ends` says how the
    signal is extended, reflected about its end point or mirrored; `where` begins an error.
    """
    from scipy.signal import sosfiltfilt

    if cutoff_hz >= HIGHEST_CUTOFF * rate_hz:
        raise InputError(
            f"{where}: a filter at {cutoff_hz:g} Hz needs a sampling rate above "
            f"{cutoff_hz / HIGHEST_CUTOFF:g} Hz, it is {rate_hz:g} Hz; lower the cut-off in the "
            f"[prepare] settings"
        )
    sections, memory = _one_pass(kind, rate_hz, cutoff_hz, order)
    if (n := values.shape[-1]) <= memory:
        raise InputError(
            f"{where}: {n} samples ({n / rate_hz:.3g} s) are too few for a "
            f"filter at {cutoff_hz:g} Hz; record at least {(memory + 1) / rate_hz:.3g} s"
        )
    return np.asarray(sosfiltfilt(sections, values, padtype=ends, padlen=memory))


def antialias(
    values: FloatArray,
    rate_hz: float,
    target_hz: float,
    *,
    ends: Ends = "odd",
    where: str = "signal",
) -> FloatArray:
    """Low-pass before the signal is sampled at `target_hz`; ends and errors as of `zero_phase`.

    Gain of the 10th-order Butterworth, both passes, as a fraction of the target rate: within 1e-6
    of one up to 0.2 (20 Hz at 100 Hz), −3 dB at 0.4, at most −60 dB from 0.6 on.
    """
    cutoff = ANTIALIAS_PASS * target_hz
    return zero_phase("lowpass", values, rate_hz, cutoff, ANTIALIAS_ORDER, ends=ends, where=where)


def one_pass(kind: Kind, rate_hz: float, cutoff_hz: float, order: int) -> FloatArray:
    """One pass of a filter as second-order sections, shape (k, 6): two of them make `zero_phase`.

    What runs while samples come has no second pass back: two passes forward have the same gain, and
    a delay.

    Raises
    ------
    InputError
        The cut-off is too high for the rate.
    """
    if cutoff_hz >= HIGHEST_CUTOFF * rate_hz:
        raise InputError(
            f"a filter at {cutoff_hz:g} Hz needs a sampling rate above "
            f"{cutoff_hz / HIGHEST_CUTOFF:g} Hz, it is {rate_hz:g} Hz"
        )
    return _one_pass(kind, rate_hz, cutoff_hz, order)[0]


@lru_cache
def _one_pass(kind: Kind, rate_hz: float, cutoff_hz: float, order: int) -> tuple[FloatArray, int]:
    """One pass as second-order sections, shape (k, 6), and the samples until it has forgotten.

    To design it takes longer than to run it over a trial.
    """
    from scipy.signal import bessel, butter, zpk2sos

    ratio = _bessel_ratio(order) if kind == "bessel" else _HALF ** (1.0 / (2 * order))
    shift = ratio if kind == "highpass" else 1.0 / ratio
    corner = rate_hz / math.pi * math.atan(shift * math.tan(math.pi * cutoff_hz / rate_hz))
    if kind == "bessel":
        zpk = bessel(order, corner, "lowpass", fs=rate_hz, norm="mag", output="zpk")
    else:
        zpk = butter(order, corner, kind, fs=rate_hz, output="zpk")
    slowest = float(np.max(np.abs(zpk[1])))
    memory = math.ceil(math.log(_MEMORY) / math.log(slowest)) if slowest > 0.0 else 1
    return zpk2sos(*zpk), memory


def _bessel_ratio(order: int) -> float:
    """Frequency at which one pass loses 1.5 dB, in units of that at which it loses 3 dB."""
    from scipy.optimize import brentq
    from scipy.signal import bessel, freqs_zpk

    zeros, poles, gain = bessel(order, 1.0, analog=True, norm="mag", output="zpk")

    def excess(frequency: float) -> float:
        response = freqs_zpk(zeros, poles, gain, worN=[frequency])[1][0]
        return float(abs(response) ** 2 - math.sqrt(0.5))

    return float(brentq(excess, 0.1, 1.0, xtol=1e-14))
