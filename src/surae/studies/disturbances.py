"""Random disturbances of virtual measurements, and EMG as an electrode sees it."""

import math

import numpy as np

from surae.protocol.profiles import smooth_step
from surae.recording import MUSCLES
from surae.signals import Preparation
from surae.units import FloatArray

#: Band of surface EMG [Hz].
EMG_BAND = (20.0, 450.0)
#: Slowest sampling of raw EMG [Hz].
EMG_LOWEST_RATE = 1000.0


def coloured_noise(
    n: int, rate_hz: float, deviation: float, time: float, rng: np.random.Generator
) -> FloatArray:
    """First-order autoregressive noise, stationary from its first sample.

    The correlation at the lag τ is exp(−τ/`time`) [s]; 0 is white noise.
    """
    from scipy.signal import lfilter

    memory = math.exp(-1.0 / (rate_hz * time)) if time > 0.0 else 0.0
    drive = rng.standard_normal(n)
    drive[1:] *= math.sqrt(1.0 - memory**2)
    noise: FloatArray = deviation * lfilter([1.0], [1.0, -memory], drive)
    return noise


def wandering(t: FloatArray, period: float, columns: int, rng: np.random.Generator) -> FloatArray:
    """Slow noise of mean 0 and variance 1 that does not depend on the sampling rate.

    Independent normal numbers every `period`, joined by minimum-jerk steps and scaled so that the
    variance is 1 in between too.

    `period` [s] lies between two of the numbers: values two periods apart are independent, and so
    are the columns. A longer trial begins as a shorter one.
    """
    knots = rng.standard_normal((int(t[-1] / period) + 2, columns))
    before = np.minimum((t / period).astype(int), len(knots) - 2)
    share = smooth_step(t / period - before)[:, None]
    joined = (1.0 - share) * knots[before] + share * knots[before + 1]
    values: FloatArray = joined / np.hypot(1.0 - share, share)
    return values


def mixing(crosstalk: float) -> FloatArray:
    """What electrodes (rows) pick up of muscles (columns): all of their own, part of others."""
    n = len(MUSCLES)
    return np.full((n, n), crosstalk) + (1.0 - crosstalk) * np.eye(n)


def mixed_envelopes(envelopes: FloatArray, crosstalk: float) -> FloatArray:
    """Envelopes behind electrodes with crosstalk.

    EMG of different muscles is uncorrelated, so raw signals that add up linearly (`mixing`) have
    envelopes that add up in squares.
    """
    if crosstalk == 0.0:
        return envelopes
    squares: FloatArray = envelopes**2 @ (mixing(crosstalk) ** 2).T
    return np.sqrt(squares)


def raw_emg(envelopes: FloatArray, rate_hz: float, rng: np.random.Generator) -> FloatArray:
    """Raw EMG of which the default preparation makes these envelopes, on average.

    Gaussian noise with a flat spectrum in `EMG_BAND`, modulated. Rectified Gaussian noise of the
    standard deviation σ has the mean √(2/π)·σ = 0.798·σ, and the preparation's high-pass leaves
    `passed` = 0.973 of σ at 2048 Hz: so σ = √(π/2)/0.973 = 1.289 times the envelope.

    The envelopes are expected rectified EMG after the high-pass [V]; the rate is at least
    `EMG_LOWEST_RATE`.
    """
    n = len(envelopes)
    spectrum = np.fft.rfft(rng.standard_normal(envelopes.shape), axis=0)
    frequency = np.fft.rfftfreq(n, 1.0 / rate_hz)
    inside = (frequency >= EMG_BAND[0]) & (frequency <= EMG_BAND[1])
    spectrum[~inside] = 0.0
    # What is left has the variance 2·(bins inside)/n.
    unit = np.fft.irfft(spectrum, n, axis=0) * math.sqrt(n / (2 * np.count_nonzero(inside)))
    emg: FloatArray = envelopes * unit * (math.sqrt(math.pi / 2) / passed(rate_hz))
    return emg


def passed(rate_hz: float, settings: Preparation | None = None) -> float:
    """Root-mean-square gain that the EMG high-pass of a preparation has for `raw_emg`.

    It is the default preparation if not given. With another, estimated EMG weights are the true
    ones times ``passed(rate_hz) / passed(rate_hz, settings)``.
    """
    settings = settings or Preparation()
    if settings.emg_highpass_hz is None:
        return 1.0
    frequency = np.linspace(*EMG_BAND, 4001)
    ratio = math.tan(math.pi * settings.emg_highpass_hz / rate_hz) / np.tan(
        np.pi * frequency / rate_hz
    )
    # Both passes together, 3 dB at the cut-off.
    gain = 1.0 / (1.0 + (math.sqrt(2.0) - 1.0) * ratio ** (2 * settings.emg_highpass_order))
    return math.sqrt(float((gain**2).mean()))
