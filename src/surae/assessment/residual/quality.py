"""How well a modelled torque follows the measured one."""

from collections.abc import Sequence

import numpy as np

from surae.units import FloatArray


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
    weights = np.concatenate([weight for _, _, weight in parts])
    if np.all(weights == weights[0]):
        return None
    roots = np.sqrt(weights)
    measured = roots * np.concatenate([torque for torque, _, _ in parts])
    return vaf(measured, roots * np.concatenate([residual for _, residual, _ in parts]))


def rmse(residual: FloatArray) -> float:
    """Root mean square of a residual, in its own unit; NaN where it has none that is finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        mean = np.mean(residual**2)
    return float(np.sqrt(mean)) if np.isfinite(mean) else np.nan


def autocorrelation(residual: FloatArray, lags: int) -> FloatArray:
    """Autocorrelation of a residual at lags 0 … `lags` samples.

    Parameters
    ----------
    residual : ndarray, shape (n,)
        Residual; its mean is removed.
    lags : int
        Largest lag, below n.

    Returns
    -------
    ndarray, shape (lags + 1,)
        Biased estimate, 1 at lag 0; all zero but the first when the residual never changes, NaN
        when it is not finite.
    """
    largest = float(np.abs(residual).max())
    if not np.isfinite(largest):
        return np.full(lags + 1, np.nan)
    e = residual / (largest or 1.0)  # so that no square overflows
    e -= e.mean()
    size = 1 << (2 * len(e) - 1).bit_length()
    spectrum = np.fft.rfft(e, size)
    full = np.fft.irfft(np.abs(spectrum) ** 2, size)[: lags + 1]
    if full[0] <= 0:
        return np.concatenate([[1.0], np.zeros(lags)])
    return np.asarray(full / full[0], dtype=np.float64)
