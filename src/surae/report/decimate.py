"""Fewer points than samples, without losing a peak."""

from itertools import pairwise

import numpy as np

from surae.units import FloatArray

#: Points of a curve from which more cannot be told apart on paper or screen.
POINTS = 4000


def min_max(
    time: FloatArray, values: FloatArray, points: int = POINTS
) -> tuple[FloatArray, FloatArray]:
    """The smallest and the largest sample of each of `points`/2 equal stretches, and both ends.

    Parameters
    ----------
    time, values : ndarray, shape (n,)
        A signal.
    points : int
        A signal of no more samples is returned as it is.

    Returns
    -------
    tuple of ndarray
        Times and values of the samples that were kept, in order; at most `points` + 2 of them.
    """
    n = len(values)
    if n <= points:
        return time, values
    edges = np.linspace(0, n, max(points // 2, 1) + 1).astype(int)
    kept = [0, n - 1]
    for begin, end in pairwise(edges.tolist()):
        stretch = values[begin:end]
        kept += [begin + int(stretch.argmin()), begin + int(stretch.argmax())]
    index = np.unique(kept)
    return time[index], values[index]
