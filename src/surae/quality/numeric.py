"""Small numerical tools of the checks, light enough to be run before every fit."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from surae.base.units import FloatArray

#: Share of runs, or of steps between levels, that must be alike for a slower clock or a digit.
_EVENLY = 0.8
#: Most levels of a recorder whose digits show, and how close to whole digits its steps are.
_LEVELS = 2000
_WHOLE = 0.05
BoolArray = npt.NDArray[np.bool_]
IndexArray = npt.NDArray[np.intp]


def smooth(values: FloatArray, width: int) -> FloatArray:
    """Centred moving average over an odd number of about `width` samples, ends shortened."""
    half = max(int(width) // 2, 0)
    if half == 0:
        return values
    n = len(values)
    total = np.zeros(n + 1)
    np.cumsum(values, out=total[1:])
    averaged = np.empty(n)
    inner = slice(half, max(n - half, half))
    np.subtract(total[2 * half + 1 :], total[: max(n - 2 * half, 0)], out=averaged[inner])
    averaged[inner] /= 2 * half + 1
    ends = np.r_[0 : min(half, n), max(n - half, min(half, n)) : n]
    first = np.maximum(ends - half, 0)
    last = np.minimum(ends + half + 1, n)
    averaged[ends] = (total[last] - total[first]) / (last - first)
    return averaged


def quantiles(values: FloatArray, *shares: float) -> tuple[float, ...]:
    """Quantiles, linear between samples; NumPy's own takes three times as long to begin."""
    last = len(values) - 1
    at = [share * last for share in shares]
    below = [int(position) for position in at]
    above = [min(k + 1, last) for k in below]
    ordered = np.partition(values, sorted({*below, *above}))
    return tuple(
        float(ordered[low] + (position - low) * (ordered[high] - ordered[low]))
        for position, low, high in zip(at, below, above, strict=True)
    )


def quantile(values: FloatArray, share: float) -> float:
    """Give a single one of the `quantiles`."""
    return quantiles(values, share)[0]


def shifted(values: FloatArray, samples: int) -> FloatArray:
    """`values` delayed by `samples` (advanced where negative), the end values repeated."""
    return values[np.clip(np.arange(len(values)) - samples, 0, len(values) - 1)]


def responded(values: FloatArray, response: FloatArray) -> FloatArray:
    """`values` from rest through a filter of the given impulse response, by Fourier transform."""
    n = len(values)
    size = 1 << (n + len(response) - 1).bit_length()
    spectrum = np.fft.rfft(values, size) * np.fft.rfft(response, size)
    return np.asarray(np.fft.irfft(spectrum, size)[:n])


def span_of(time: FloatArray, where: IndexArray | None = None) -> tuple[float, float]:
    """The first and last instant, of all or of those at increasing indices."""
    first, last = (0, -1) if where is None else (where[0], where[-1])
    return float(time[first]), float(time[last])


def runs(mask: BoolArray) -> Iterator[tuple[int, int]]:
    """First and one past the last index of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def equal_runs(values: FloatArray) -> tuple[IndexArray, IndexArray]:
    """First index and length of every run of equal values, runs of one included."""
    first = np.concatenate([[0], np.flatnonzero(np.diff(values) != 0.0) + 1])
    return first, np.diff(np.concatenate([first, [len(values)]]))


def correlations(a: FloatArray, b: FloatArray, lags: IndexArray) -> FloatArray:
    """Pearson's correlation of `a`, advanced by each lag, with `b`: nothing beyond their ends."""
    a = a - a.mean()
    b = b - b.mean()
    size = 1 << (2 * len(a) - 1).bit_length()
    products = np.fft.irfft(np.fft.rfft(a, size) * np.conj(np.fft.rfft(b, size)), size)
    scale = float(np.sqrt((a @ a) * (b @ b)))
    return np.asarray(products[lags] / scale if scale > 0.0 else np.zeros(len(lags)))


def correlation(a: FloatArray, b: FloatArray) -> float:
    """Pearson's correlation; 0 where one of the two is constant."""
    a = a - a.mean()
    b = b - b.mean()
    scale = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / scale if scale > 0.0 else 0.0


def held_for(values: FloatArray) -> int:
    """For how many samples each value is kept, of a slower recording that fills a faster file.

    1 where values are new in every sample, or are kept for times that differ.
    """
    length = equal_runs(values)[1][1:-1]
    if not length.size:
        return 1
    usual = int(quantile(length.astype(np.float64), 0.5))
    alike = np.abs(length - usual) <= 1
    return usual if usual > 1 and alike.mean() > _EVENLY else 1


def digit_of(values: FloatArray) -> float:
    """The step in which values were recorded; 0 where they have too many levels to tell."""
    levels = np.unique(values)
    if not 2 <= len(levels) <= _LEVELS:
        return 0.0
    steps = np.diff(levels)
    digit = float(steps.min())
    whole = np.abs(steps / digit - np.round(steps / digit)) < _WHOLE
    return digit if whole.mean() > _EVENLY else 0.0
