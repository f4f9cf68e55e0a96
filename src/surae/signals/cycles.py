"""Movement that repeats itself: where its cycles begin, and signals over the cycle."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from surae.base.units import FloatArray

#: Movement of less than this [rad] is rest, whose noise may look like anything.
_MOVES = 0.02
#: How alike (correlation) the angle is a cycle later, and each cycle to the first.
_ALIKE = 0.75
#: Fewer cycles, or cycles in less than this part of the recording, are no cyclic movement.
_FEWEST = 4
_COVERED = 0.6
#: How far the duration of a cycle may be from the usual one.
_UNEVEN = 0.25
#: Points over a cycle.
_POINTS = 101


@dataclass(frozen=True, slots=True)
class Cycles:
    """Begin and end of a recording's cycles; each begins at the largest dorsiflexion."""

    spans: tuple[tuple[int, int], ...]  #: First sample of each cycle, and of what follows it.
    seconds: float  #: Their median duration [s].

    def over(self, signal: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Per cent of the cycle, the signal's mean over the cycles and its standard deviation."""
        share = np.linspace(0.0, 1.0, _POINTS)
        index = np.arange(len(signal))
        rows = [
            np.interp(first + share * (past - first), index, signal) for first, past in self.spans
        ]
        return 100.0 * share, np.mean(rows, axis=0), np.std(rows, axis=0, ddof=1)


def find_cycles(
    angle: FloatArray, rate_hz: float, counted: npt.NDArray[np.bool_] | None = None
) -> Cycles | None:
    """The cycles, without those of samples that do not count; None for any other movement."""
    from scipy.signal import find_peaks

    movement = angle - angle.mean()
    if not np.isfinite(movement).all() or float(movement.std()) < _MOVES:
        return None
    period = _period(movement)
    if period is None:
        return None
    first = int(np.argmax(movement[period // 2 : period // 2 + period])) + period // 2
    likeness = _likeness(movement, movement[first : first + period])
    starts, _ = find_peaks(np.r_[-1.0, likeness, -1.0], height=_ALIKE, distance=round(0.7 * period))
    spans = [
        (begin, end)
        for begin, end in pairwise((starts - 1).tolist())
        if abs(end - begin - period) <= _UNEVEN * period
    ]
    covered = sum(end - begin for begin, end in spans) / len(angle)
    if counted is not None:
        spans = [(begin, end) for begin, end in spans if counted[begin:end].all()]
    if len(spans) < _FEWEST or covered < _COVERED:
        return None
    return Cycles(tuple(spans), float(np.median([e - b for b, e in spans])) / rate_hz)


def _period(movement: FloatArray) -> int | None:
    """Samples after which the movement is most like itself again."""
    from scipy.fft import irfft, next_fast_len, rfft
    from scipy.signal import find_peaks

    n = len(movement)
    size = next_fast_len(2 * n)
    products = irfft(np.abs(rfft(movement, size)) ** 2, size)[:n]
    energy = np.cumsum(movement**2)
    ahead = energy[::-1]
    behind = energy[-1] - np.r_[0.0, energy[:-1]]
    lags = n // _FEWEST
    alike = products[:lags] / np.sqrt(np.maximum(ahead * behind, 1e-30))[:lags]
    fallen = np.flatnonzero(alike < 0.5 * _ALIKE)
    if not fallen.size:
        return None
    tops, _ = find_peaks(alike[fallen[0] :], height=_ALIKE)
    if not tops.size:
        return None
    tops = tops + fallen[0]
    # Multiples of the period are as alike: the shortest of those that are nearly the best.
    return int(tops[alike[tops] >= alike[tops].max() - 0.1][0])


def _likeness(movement: FloatArray, template: FloatArray) -> FloatArray:
    """Correlation of the template with each stretch of its length."""
    from scipy.signal import correlate

    length = len(template)
    shape = (template - template.mean()) / (template.std() * length)
    sums = correlate(movement, shape, mode="valid", method="fft")
    total, squares = (np.r_[0.0, np.cumsum(movement**power)] for power in (1, 2))
    mean = (total[length:] - total[:-length]) / length
    spread = np.sqrt(np.maximum((squares[length:] - squares[:-length]) / length - mean**2, 1e-12))
    return np.asarray(sums / spread)
