"""Noise that is correlated over time: an autoregressive model of it, and its spectrum."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from surae.base.frozen import Comparable
from surae.base.records import Listed
from surae.base.units import FloatArray

#: Frequencies at which a spectrum is looked at, up to half the sampling rate.
_GRID = 2048
#: Rounds of a noise model and what a fit took of it; each settles an order of magnitude more.
_ROUNDS = 3


@dataclass(frozen=True, slots=True, eq=False)
class NoiseModel(Comparable):
    """Stationary noise e[t] = Σ φ[k]·e[t − k] + white noise."""

    coefficients: Listed  #: φ, from lag 1 on; none for white noise, shape (q,).
    variance: float  #: Of the white noise that drives it.
    autocovariance: Listed  #: What the model was made of, m > q, shape (m,).
    samples: float  #: How many samples that came from.

    @classmethod
    def white(cls, variance: float, samples: float) -> "NoiseModel":
        """White noise."""
        return cls(np.zeros(0), variance, np.array([variance]), samples)

    def slow(self, part: float, least: float = 0.0) -> "NoiseModel":
        """White noise as strong as this is below a part of the sampling rate."""
        level = max(self.below(part), self.variance, least)
        return replace(self, coefficients=np.zeros(0), variance=level)

    @property
    def order(self) -> int:
        """Number q of coefficients."""
        return len(self.coefficients)

    def transfer(self, size: int) -> npt.NDArray[np.complex128]:
        """1 − Σ φ[k]·exp(−iωk) at the frequencies of a real FFT of `size`."""
        return np.asarray(np.fft.rfft(np.concatenate([[1.0], -self.coefficients]), size))

    def spectrum(self, size: int) -> FloatArray:
        """Spectral density at the frequencies of a real FFT of `size`; its mean is the variance."""
        return np.asarray(self.variance / np.abs(self.transfer(size)) ** 2, dtype=np.float64)

    def below(self, part: float) -> float:
        """Mean spectral density below a part of the sampling rate; the variance if it is white."""
        density = self.spectrum(4096)
        return float(density[: max(2, int(4096 * part))].mean())

    def uncertainty(self) -> FloatArray:
        """Covariance of the coefficients, shape (q, q), for a long series: σ²Γ⁻¹/n."""
        from scipy.linalg import toeplitz

        if not self.order:
            return np.empty((0, 0))
        gamma = toeplitz(self.autocovariance[: self.order])
        return np.asarray(self.variance / self.samples * np.linalg.pinv(gamma, hermitian=True))


def autoregressive(autocovariance: FloatArray, samples: float) -> NoiseModel:
    """The autoregressive model of the order below m that Akaike's criterion prefers.

    The Yule–Walker equations are solved for all orders by the recursion of Levinson and Durbin;
    it ends where the autocovariance, shape (m,), stops being one.
    """
    coefficients = np.zeros(0)
    variance = float(autocovariance[0])
    best = (coefficients, variance)
    lowest = samples * np.log(variance) if variance > 0 else 0.0
    for order in range(1, len(autocovariance)):
        if not variance > 0:
            break
        past = autocovariance[order - 1 : 0 : -1]
        reflection = float(autocovariance[order] - coefficients @ past) / variance
        if not abs(reflection) < 1:
            break
        coefficients = np.append(coefficients - reflection * coefficients[::-1], reflection)
        variance *= 1 - reflection * reflection
        criterion = samples * np.log(variance) + 2 * order
        if criterion < lowest:
            best = (coefficients, variance)
            lowest = criterion
    return NoiseModel(best[0], best[1], autocovariance, samples)


def noise_behind(residual: FloatArray, taken: FloatArray, lags: int) -> NoiseModel:
    """The autoregressive noise whose residual, after a fit, would be as this residual is.

    A fit with the hat matrix H = UᵀU leaves (1 − H)·noise. Of the noise's power at a frequency it
    takes the part that U, `taken`, shape (q, n), has there, so that is given back until the noise
    model, of at most so many lags, rests (the idea is Worsley's, NeuroImage 15, 2002).
    """
    from scipy.fft import next_fast_len

    n = len(residual)
    size = next_fast_len(2 * n, real=True)
    left = np.abs(np.fft.rfft(residual, size)) ** 2
    part = np.zeros(len(left))
    for row in taken:  # all their spectra at once would be twice as large as they
        part += np.abs(np.fft.rfft(row, size)) ** 2
    power = left
    for _ in range(_ROUNDS):
        model = autoregressive(np.fft.irfft(power, size)[: lags + 1] / n, n)
        power = left + part * model.spectrum(size)
    model = autoregressive(np.fft.irfft(power, size)[: lags + 1] / n, n)
    return replace(model, variance=max(model.variance, 1e-30))


def level_above(noise: NoiseModel, part: float) -> NoiseModel:
    """The noise with a spectrum that falls no further above a part of the sampling rate."""
    if not noise.order or part >= 0.5:
        return noise
    density = noise.spectrum(2 * _GRID)
    edge = int(2 * _GRID * part)
    density[edge:] = np.maximum(density[edge:], density[edge])
    covariance = np.fft.irfft(density)[: noise.order + 1]
    return autoregressive(covariance, noise.samples)


def whitened(rows: FloatArray, noise: NoiseModel) -> FloatArray:
    """Rows behind the filter that makes their noise white and of variance 1."""
    from scipy.signal import lfilter

    if noise.order:
        rows = lfilter(np.concatenate([[1.0], -noise.coefficients]), [1.0], rows, axis=1)
    return np.asarray(rows / np.sqrt(noise.variance))
