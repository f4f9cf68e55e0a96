"""Noise that rectifying leaves in the envelope of raw EMG: how much.

Raw EMG is noise whose size is the drive. Its modulus fluctuates by as much as itself, by the same
part whatever the drive, with a spectrum that is flat where muscles act. So an envelope that is made
here has an error that is known beforehand.
"""

import numpy as np

from surae.base.units import FloatArray

#: Time [s] over which the size of raw EMG is averaged, and up to which it is correlated.
_SIZE_S = 0.25
_CORRELATED_S = 0.1
#: Rate [Hz] at which EMG is sampled whole, for which weights are meant: that of virtual legs.
_WHOLE_HZ = 1024.0


def lost_to_rate(rate_hz: float, highpass_hz: float) -> float:
    """How far an envelope may be too small, as a standard deviation of its logarithm [-].

    Of a flat band up to half the rate a high-pass leaves the part 1 − 2·f/rate of the power. What
    is lost beside a recording at 1024 Hz makes weights larger by ½·ln of the ratio of these parts,
    if it aliases, and by nothing if EMG has no more than the band that is left.
    """
    left, whole = (1.0 - 2.0 * highpass_hz / rate for rate in (rate_hz, _WHOLE_HZ))
    return 0.5 * float(np.log(max(whole / left, 1.0)))


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
