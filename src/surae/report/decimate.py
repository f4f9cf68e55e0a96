"""Fewer points than samples, without losing a peak."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from surae.units import FloatArray

IndexArray = npt.NDArray[np.intp]

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
    if len(values) <= points:
        return time, values
    index = extremes([values], points)
    return time[index], values[index]


def extremes(signals: Sequence[FloatArray], points: int = POINTS) -> IndexArray:
    """Which samples to show of signals with common instants, so that none loses a peak.

    Parameters
    ----------
    signals : sequence of ndarray, shape (n,)
        The signals whose peaks must stay; others can be shown at the same samples.
    points : int
        Of signals of no more samples all are shown.

    Returns
    -------
    ndarray of int
        Where any signal is smallest or largest within each of equal stretches, and both ends; in
        order, at most `points` + 2.
    """
    n = len(signals[0])
    if n <= points:
        return np.arange(n)
    edges = np.linspace(0, n, max(points // (2 * len(signals)), 1) + 1).astype(int)
    kept = [0, n - 1]
    for begin, end in pairwise(edges.tolist()):
        for values in signals:
            stretch = values[begin:end]
            kept += [begin + int(stretch.argmin()), begin + int(stretch.argmax())]
    return np.unique(kept)
