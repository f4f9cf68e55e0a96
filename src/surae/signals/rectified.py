"""Noise that rectifying leaves in the envelope of raw EMG: how much, and the drive behind it.

Raw EMG is noise whose size is the drive. Its modulus fluctuates by as much as itself, by the same
part whatever the drive, with a spectrum that is flat where muscles act. So an envelope that is made
here has an error that is known beforehand.
"""

from dataclasses import replace

import numpy as np

from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.signals.inputs import ModelInputs

#: Time [s] over which the size of raw EMG is averaged, and up to which it is correlated.
_SIZE_S, _CORRELATED_S = 0.25, 0.1
#: Density [s] of noise that is worth a smoother, EMG below some 700 Hz. Bursts change a muscle's
#: EMG more than one smoother allows for: on legs that were sampled faster that passed for a curve
#: from EMG to force (65 % likely on a leg without one, 14 % without the smoother), while f0 and β
#: are off by −0.3 standard deviations without it.
_STRONG = 1e-3
#: Least half-width [Hz] over which a spectrum is averaged, the part of a frequency to which that
#: grows, and samples below which a signal has no spectrum.
_BROAD_HZ, _BROAD_PART, _FEWEST = 0.15, 0.2, 200


def rectified_density(emg: FloatArray, rate_hz: float) -> float:
    """Spectral density at 0 Hz, two-sided [s], of |x|/E|x| − 1, x Gaussian with its spectrum.

    S = (1/rate)·Σₖ [√(1 − ρₖ²) + ρₖ·asin ρₖ − 1], ρₖ the autocorrelation of the EMG over its own
    root mean square of 0.25 s: two Gaussian values of correlation ρ have moduli of that relative
    covariance (Price 1958), π/2 − 1 at ρ = 1. A smoother of effective length T leaves the relative
    variance S/T; of a flat band of width B, S is about (π/2 − 1)/(2B).

    `emg` is filtered, and not rectified, shape (n,); 0 where there is none.
    """
    from scipy.fft import next_fast_len
    from scipy.ndimage import uniform_filter1d

    lags = int(_CORRELATED_S * rate_hz)
    power = uniform_filter1d(emg**2, max(3, int(_SIZE_S * rate_hz)), mode="nearest")
    top = float(power.max())
    if not top > 0.0 or len(emg) <= lags:
        return 0.0
    equal = emg / np.sqrt(np.maximum(power, 1e-12 * top))
    size = next_fast_len(len(equal) + lags, real=True)
    r = np.fft.irfft(np.abs(np.fft.rfft(equal, size)) ** 2, size)[: lags + 1]
    r = np.clip(r / r[0], -1.0, 1.0)
    covariance = np.sqrt(1.0 - r**2) + r * np.arcsin(r) - 1.0
    return float((covariance[0] + 2.0 * covariance[1:].sum()) / rate_hz)


def expected_drives(inputs: ModelInputs) -> ModelInputs:
    """The inputs with what is expected of the drives, given envelopes whose noise is known.

    Noise of a regressor pulls estimates towards nothing: gains seem too small and muscles too slow.
    What is expected of the drive, by Wiener's filter, errs without regard to itself (Berkson), and
    pulls nowhere (regression calibration, Carroll et al. 2006, chapter 4). The same inputs where no
    noise is known, or little.
    """
    if not inputs.rectified or inputs.n < _FEWEST:
        return inputs
    emg = inputs.emg.copy()
    for column, density in enumerate(inputs.rectified):
        if density > _STRONG:
            emg[:, column] = _expected(emg[:, column], density * inputs.rate_hz, inputs.rate_hz)
    return replace(inputs, emg=read_only(emg))


def _expected(envelope: FloatArray, relative: float, rate_hz: float) -> FloatArray:
    """Wiener's filter of an envelope with multiplicative white noise of this relative variance."""
    n = len(envelope)
    mirrored = np.concatenate([envelope, envelope[::-1]])
    mean = float(mirrored.mean())
    spectrum = np.fft.rfft(mirrored - mean)
    # mean power in a band about each frequency
    step, at = rate_hz / (2 * n), np.arange(len(spectrum))
    sums = np.concatenate([[0.0], np.cumsum(np.abs(spectrum) ** 2 / (2 * n))])
    half = np.maximum(np.maximum(_BROAD_HZ / step, _BROAD_PART * at), 1.0).astype(int)
    low, high = np.maximum(at - half, 0), np.minimum(at + half + 1, len(spectrum))
    power = (sums[high] - sums[low]) / (high - low)
    noise = relative * float(np.mean(envelope**2)) / (1.0 + relative)
    kept = np.maximum(1.0 - noise / np.maximum(power, 1e-300), 0.0)
    return np.maximum(mean + np.fft.irfft(kept * spectrum, 2 * n)[:n], 0.0)
