"""Curves of millions of samples in windows of a few thousand points, without losing a peak.

Level 0 of a pyramid is the signal; each level above holds the least and greatest of `_FACTOR` cells
below. A window is cut from the coarsest level that still has enough cells, so that its cost depends
on the points that are shown and not on the samples behind them.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae import api
from surae.units import FloatArray

_FACTOR = 16
_SMALLEST = 512


@dataclass(frozen=True, slots=True)
class Window:
    """A part of a signal: `n` samples, shown by times and values in order."""

    n: int
    time: FloatArray
    values: FloatArray

    @property
    def reduced(self) -> bool:
        """Whether there are fewer points than samples."""
        return len(self.time) < self.n


class Pyramid:
    """A signal and its levels.

    Parameters
    ----------
    time, values : ndarray, shape (n,)
        Increasing times, and the signal.
    """

    def __init__(self, time: FloatArray, values: FloatArray) -> None:
        self.time, self.values = time, values
        low = high = values
        self._levels: list[tuple[int, FloatArray, FloatArray]] = []
        width = 1
        while len(low) > _SMALLEST * _FACTOR:
            edges = np.arange(0, len(low), _FACTOR)
            low = np.minimum.reduceat(low, edges)
            high = np.maximum.reduceat(high, edges)
            width *= _FACTOR
            self._levels.append((width, low, high))

    @property
    def bytes(self) -> int:
        """Memory that the levels and the signal take."""
        return self.values.nbytes + sum(a.nbytes + b.nbytes for _, a, b in self._levels)

    def window(self, start: float | None, end: float | None, points: int) -> Window:
        """The part from `start` to `end` [s], by at most about `points` points.

        One sample before and one after the part are included, so that the curve goes on to the
        edges of a plot.
        """
        part = within(self.time, start, end)
        first, last = part.start, part.stop
        count = last - first
        if count <= points:
            return Window(count, self.time[first:last], self.values[first:last])
        cells = max(points // 2, 1)
        fitting = [level for level in self._levels if count // level[0] >= cells]
        width, low, high = fitting[-1] if fitting else (1, self.values, self.values)
        begin, stop = first // width, -(-last // width)
        edges = np.unique(np.linspace(begin, stop, cells + 1).astype(int)[:-1])
        lows = np.minimum.reduceat(low[:stop], edges)
        highs = np.maximum.reduceat(high[:stop], edges)
        starts = np.clip(edges * width, first, last - 1)
        ends = np.append(starts[1:], last)
        # The two extremes of a cell are drawn at a third and two thirds of it, in either order:
        # where in the cell they lie is finer than a pixel.
        middle = starts + (ends - starts) // 2
        time = np.empty(2 * len(edges))
        values = np.empty(2 * len(edges))
        time[0::2], time[1::2] = self.time[starts], self.time[middle]
        rising = self.values[starts] <= self.values[ends - 1]
        values[0::2] = np.where(rising, lows, highs)
        values[1::2] = np.where(rising, highs, lows)
        return Window(count, time, values)


@dataclass(frozen=True, slots=True)
class Curves:
    """A recording's channels, ready to be shown."""

    recording: api.Recording
    pyramids: Mapping[str, Pyramid]

    @property
    def bytes(self) -> float:
        """Memory that they take."""
        times = {id(curve.time): curve.time.nbytes for curve in self.pyramids.values()}
        return float(sum(times.values()) + sum(curve.bytes for curve in self.pyramids.values()))


def within(times: FloatArray, start: float | None, end: float | None) -> slice:
    """The samples from `start` to `end` [s] with one before and one after; all where both are None.

    With these the curve goes on to the edges of a plot.
    """
    first = 0 if start is None else max(int(np.searchsorted(times, start)) - 1, 0)
    last = len(times) if end is None else int(np.searchsorted(times, end, "right")) + 1
    return slice(first, max(min(last, len(times)), first))


def plain(values: FloatArray, digits: int = 7) -> list[float | None]:
    """Numbers for JSON, in single precision, as a screen needs them; None where there is none."""
    return [
        float(f"{value:.{digits}g}") if np.isfinite(value) else None
        for value in values.astype(np.float32).tolist()
    ]
