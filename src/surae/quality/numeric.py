"""Small numerical tools of the checks, light enough to be run before every fit."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from surae.units import FloatArray

BoolArray = npt.NDArray[np.bool_]
IndexArray = npt.NDArray[np.intp]


def smooth(values: FloatArray, width: int) -> FloatArray:
    """Centred moving average over an odd number of about `width` samples, ends shortened."""
    half = max(int(width) // 2, 0)
    if half == 0:
        return values
    total = np.concatenate([[0.0], np.cumsum(values)])
    n = len(values)
    first = np.maximum(np.arange(n) - half, 0)
    last = np.minimum(np.arange(n) + half + 1, n)
    averaged: FloatArray = (total[last] - total[first]) / (last - first)
    return averaged


def shifted(values: FloatArray, samples: int) -> FloatArray:
    """`values` delayed by `samples` (advanced where negative), the end values repeated."""
    index = np.clip(np.arange(len(values)) - samples, 0, len(values) - 1)
    return values[index]


def runs(mask: BoolArray) -> Iterator[tuple[int, int]]:
    """First and one past the last index of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def equal_runs(values: FloatArray) -> tuple[IndexArray, IndexArray]:
    """First index and length of every run of equal values, runs of one included."""
    first = np.concatenate([[0], np.flatnonzero(np.diff(values) != 0.0) + 1])
    return first, np.diff(np.concatenate([first, [len(values)]]))


def correlation(a: FloatArray, b: FloatArray) -> float:
    """Pearson's correlation; 0 where one of the two is constant."""
    a, b = a - a.mean(), b - b.mean()
    scale = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / scale if scale > 0.0 else 0.0
