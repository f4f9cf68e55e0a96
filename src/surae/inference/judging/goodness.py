"""How well a modelled torque follows the measured one, and whether what is left is white noise."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surae.base.file_form import filed
from surae.base.frozen import Comparable
from surae.base.normal import NORMAL
from surae.base.units import FloatArray
from surae.signals import ModelInputs

#: Probability with which the test calls white noise coloured.
LEVEL = 0.05


@filed("rate_hz", "correlation", "band", "fall_s", statistic="ljung_box", lag1="lag1")
@dataclass(frozen=True, slots=True, eq=False)
class Whiteness(Comparable):
    """The autocorrelation of a residual, and the test of whether it is more than chance."""

    rate_hz: float  #: Sampling rate [Hz].
    #: Autocorrelation from lag 0 about zero, not about the mean, as many lags as are worth showing;
    #: NaN where the residual is not finite, shape (k + 1,).
    correlation: FloatArray
    #: Half-width of the band that holds 95 % of the values if the residual is white, 1.96/√n.
    band: float
    #: Time after which the autocorrelation is within the band for the first time [s].
    fall_s: float
    lags: int  #: Lags that are tested.
    #: `statistic`, `p_value`: of Ljung and Box: how likely white noise is at least as correlated
    #: over the tested lags.
    statistic: float
    p_value: float

    @property
    def lag1(self) -> float:
        """Autocorrelation of neighbouring samples."""
        return float(self.correlation[1])

    @property
    def white(self) -> bool:
        """Whether white noise is often as correlated as this."""
        return self.p_value >= LEVEL


def whiteness(
    residual: FloatArray,
    rate_hz: float,
    counted: npt.NDArray[np.bool_] | None = None,
    absorbed: FloatArray | None = None,
) -> Whiteness:
    """Describe the autocorrelation of a residual, and test it.

    The test is that of Ljung and Box (1978), Σ (ρ − E ρ)²/var ρ over the lags up to 10·log₁₀ n,
    against χ². Estimated parameters take correlation out of a residual; under white noise they take
    out a known amount, E ρ, which matters as soon as there are many of them.

    `residual` has n at least 2 samples [Nm], of which some are `counted`; the others are gaps,
    across which time goes on. `absorbed`, shape (most_lags(n) + 1,), is the sum of the
    autocovariances, at each lag, of an orthonormal basis of what the parameters can do; without it
    they are taken to have none.
    """
    from scipy.special import chdtrc

    n = len(residual)
    mask = np.ones(n, dtype=bool) if counted is None else counted
    samples = max(int(np.count_nonzero(mask)), 1)
    band = NORMAL / math.sqrt(samples)
    sums, pairs = autocovariance(residual, mask, n - 1)
    if not np.isfinite(sums[0]):
        return Whiteness(rate_hz, np.full(2, np.nan), band, math.nan, 0, math.nan, math.nan)
    lags = most_lags(n)
    if sums[0] <= 0.0:
        none = np.concatenate([[1.0], np.zeros(min(40, n - 1))])
        return Whiteness(rate_hz, none, band, 1 / rate_hz, lags, 0.0, 1.0)
    rho = sums / sums[0]
    share = np.arange(n, 0, -1) / n
    shown_rho = np.divide(rho * share * samples, pairs, out=np.zeros(n), where=pairs > 0)
    within = np.flatnonzero(np.abs(shown_rho) <= band)
    fall = int(within[0]) if len(within) else n - 1
    shown = min(max(3 * fall, 40), n - 1)
    taken = np.zeros(lags + 1) if absorbed is None else absorbed[: lags + 1]
    expected = -taken / max(samples - taken[0], 1.0)
    tested = slice(1, lags + 1)
    weight = samples * (samples + 2) / np.maximum(pairs[tested], 1.0)
    used = pairs[tested] > 0
    statistic = float(np.sum((weight * (rho[tested] - expected[1:]) ** 2)[used]))
    p_value = float(chdtrc(np.count_nonzero(used), statistic)) if used.any() else 1.0
    correlation = shown_rho[: shown + 1]
    return Whiteness(rate_hz, correlation, band, fall / rate_hz, lags, statistic, p_value)


def most_lags(n: int) -> int:
    """Lags that n samples tell something about: 10·log₁₀ n, at most a tenth of them, at least 1."""
    return max(min(int(10 * math.log10(n)), n // 10), 1)


def autocovariance(
    residual: FloatArray, counted: npt.NDArray[np.bool_], lags: int
) -> tuple[FloatArray, FloatArray]:
    """Sums of products about zero, and the pairs in each, at lags 0 … `lags`.

    Samples that do not count may hold anything; sums are NaN where the signal is not finite.
    """
    n = len(residual)
    counting = np.where(counted, residual, 0.0)
    largest = float(np.abs(counting).max())
    pairs = np.arange(n, n - lags - 1, -1.0)
    if not counted.all():
        pairs = np.rint(_correlated(counted.astype(float), lags))
    if not math.isfinite(largest):
        return np.full(lags + 1, np.nan), pairs
    with np.errstate(over="ignore", invalid="ignore"):  # divided, no square overflows
        sums = _correlated(counting / (largest or 1.0), lags) * largest * largest
    return (sums if np.isfinite(sums).all() else np.full(lags + 1, np.nan)), pairs


def _correlated(signal: FloatArray, lags: int) -> FloatArray:
    from scipy.fft import next_fast_len

    size = next_fast_len(len(signal) + lags, real=True)
    spectrum = np.fft.rfft(signal, size)
    return np.asarray(np.fft.irfft(np.abs(spectrum) ** 2, size)[: lags + 1], dtype=np.float64)


def counted(recording: ModelInputs, residual: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Measured torque, NaN where there is none, and residual where samples count [Nm]."""
    torque = np.full(recording.n, np.nan) if recording.torque is None else recording.torque
    return torque[recording.counts], residual[recording.counts]


def vaf(measured: FloatArray, residual: FloatArray) -> float:
    """Variance accounted for, equation (31): (1 − Σe²/ΣT²)·100 %.

    Parameters
    ----------
    measured : ndarray, shape (n,)
        Measured torque T [Nm].
    residual : ndarray, shape (n,)
        Measured minus modelled torque e [Nm].

    Returns
    -------
    float
        Percentage, at most 100; the mean of T is not subtracted, as in the thesis. NaN where the
        residual has no finite sum of squares.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        missed = residual @ residual
    return float(100.0 * (1.0 - missed / (measured @ measured))) if np.isfinite(missed) else np.nan


def centred_r2(parts: Sequence[tuple[FloatArray, FloatArray]]) -> float:
    """Part of the torque's changes that is followed, 100·(1 − Σe²/Σ(T − T̄)²) [%].

    Unlike the VAF it does not reward a model for an offset. Each recording has its own mean.

    `parts` are (measured, residual) of each recording [Nm]. NaN where the residual has no finite
    sum of squares, or no torque changes.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        missed = sum(float(e @ e) for _, e in parts)
        changes = sum(float(np.sum((torque - torque.mean()) ** 2)) for torque, _ in parts)
        value = 100.0 * (1.0 - missed / changes) if changes > 0.0 else np.nan
    return float(value) if np.isfinite(value) else np.nan


def weighted_vaf(parts: Sequence[tuple[FloatArray, FloatArray, FloatArray]]) -> float | None:
    """Variance accounted for with samples that count unequally: (1 − Σwe²/ΣwT²)·100 %.

    `parts` are (measured, residual, weight) of each recording, where its weight is above zero. None
    where all samples count alike; NaN as `vaf`.
    """
    measured, residual, weights = (np.concatenate(each) for each in zip(*parts, strict=True))
    if np.all(weights == weights[0]):
        return None
    roots = np.sqrt(weights)
    return vaf(roots * measured, roots * residual)


def rmse(residual: FloatArray) -> float:
    """Root mean square of a residual, in its own unit; NaN where it has none that is finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        mean = np.mean(residual**2)
    return float(np.sqrt(mean)) if np.isfinite(mean) else np.nan


def akaike(count: int, sse: float, free: int) -> float | None:
    """Akaike's information criterion n·ln(Σwe²/n) + 2k of least squares (Akaike 1974).

    Parameters
    ----------
    count : int
        Samples n that count.
    sse : float
        Weighted sum of squared residuals Σwe² [Nm²].
    free : int
        Estimated parameters k.

    Returns
    -------
    float or None
        But for a constant that fits of the same samples share; None without a residual. Samples
        are taken for independent, which those of a torque are not: differences look larger than
        they are.
    """
    return _criterion(count, sse, 2.0 * free)


def bayesian(count: int, sse: float, free: int) -> float | None:
    """Bayes' information criterion n·ln(Σwe²/n) + k·ln n (Schwarz 1978); all as of `akaike`."""
    return _criterion(count, sse, free * math.log(count) if count else 0.0)


def _criterion(count: int, sse: float, penalty: float) -> float | None:
    if count == 0 or not 0.0 < sse < math.inf:
        return None
    return count * math.log(sse / count) + penalty
