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
#: Degrees of freedom of the bends of a drive's logarithm, and their sizes that are tried [1/s²]:
#: one step from the truth f0 and β are 0.1 to 0.6 standard deviations off on three virtual legs,
#: 2 to 4 with envelopes as they are, and as much the other way with Wiener's filter.
_TAILS, _BENDS = 4.0, (1200.0, 400.0, 120.0, 40.0, 12.0)
#: Second difference.
_BEND = (1.0, -2.0, 1.0)
#: Time [s] over which an envelope is averaged to begin with, steps at most, and the change of a
#: logarithm below which they end.
_BEGIN_S, _STEPS, _ENDS = 0.12, 25, 0.01


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

    Noise of a regressor pulls estimates: muscles seem slower, and let go more slowly than they take
    hold, for the product of noise with itself is not zero on average. What is expected of the drive
    errs without regard to itself (Berkson), and pulls nowhere (regression calibration, Carroll et
    al. 2006, chapter 4). The same inputs where no noise is known.
    """
    if not inputs.rectified:
        return inputs
    emg = inputs.emg.copy()
    for column, density in enumerate(inputs.rectified):
        if density > 0.0:
            emg[:, column] = _expected(emg[:, column], density * inputs.rate_hz, inputs.rate_hz)
    return replace(inputs, emg=read_only(emg))


def _expected(envelope: FloatArray, relative: float, rate_hz: float) -> FloatArray:
    """The likeliest drive behind an envelope with multiplicative noise of this relative variance.

    The envelope has a Gamma distribution about the drive; second differences of the drive's
    logarithm have Student's: most of the time it hardly bends, where a burst begins or ends it does
    (Sanger 2007, J. Neurophysiol. 97:1839, has jumps). Their size is that of greatest evidence.
    """
    from scipy.ndimage import gaussian_filter1d

    least = 1e-6 * float(np.percentile(envelope, 99.0)) + 1e-300
    envelope = np.maximum(envelope, least)
    log = np.log(gaussian_filter1d(envelope, 0.25 * _BEGIN_S * rate_hz, mode="nearest"))
    tried = []
    for size in _BENDS:
        log, evidence = _likeliest(envelope, 1.0 / relative, size / rate_hz**2, log)
        tried.append((evidence, log))
    return np.exp(max(tried, key=lambda each: each[0])[1])


def _likeliest(
    envelope: FloatArray, shape: float, size: float, log: FloatArray
) -> tuple[FloatArray, float]:
    """Logarithm of the likeliest drive whose bends have this size, from a first one; ln Z.

    Steps are Newton's, of bends whose weights are those of the last step (Lange et al. 1989).
    """
    from scipy.linalg import cho_solve_banded, cholesky_banded

    for _ in range(_STEPS):
        bends = np.diff(log, 2)
        weights = (_TAILS + 1.0) / (_TAILS * size**2 + bends**2)
        above = np.minimum(envelope * np.exp(-log), 20.0)
        band = np.zeros((3, len(log)))
        band[0] = shape * np.maximum(above, 0.3)
        pull = shape * (above - 1.0)
        for i, own in enumerate(_BEND):
            pull[i : i + len(bends)] -= own * weights * bends
            for j in range(i, 3):
                band[j - i, i : i + len(bends)] += own * _BEND[j] * weights
        factor = cholesky_banded(band, lower=True)
        step = np.clip(cho_solve_banded((factor, True), pull), -1.5, 1.5)
        log = log + step
        if np.max(np.abs(step)) < _ENDS:
            break
    fits = -shape * float(np.sum(envelope * np.exp(-log) + log)) - len(bends) * np.log(size)
    tails = float(np.log1p(np.diff(log, 2) ** 2 / (_TAILS * size**2)).sum())
    return log, fits - 0.5 * (_TAILS + 1.0) * tails - float(np.log(factor[0]).sum())
