"""Which minimum a point on thinned data leads to: starts that share one need not all descend."""

import numpy as np

from surae.estimation.least_squares import Minimum
from surae.units import FloatArray

#: A point is at a minimum when its sum differs by less than so many noise variances, and its
#: parameters by less than so many as the minimum's Jacobian measures it...
_SAME_SUM, _SAME = 2.0, 9.0
#: ...and leads there from a sum this much higher, if the Jacobian says the same to this factor.
_NEAR, _ALIKE = 100.0, 3.0


class Valleys:
    """Minima on thinned data, each with the one that it leads to on all of them."""

    def __init__(self) -> None:
        self._seen: list[tuple[Minimum, Minimum]] = []

    @property
    def empty(self) -> bool:
        """Whether no minimum is known yet."""
        return not self._seen

    def add(self, thinned: Minimum, end: Minimum) -> None:
        """Remember that the minimum on thinned data leads to `end`."""
        self._seen.append((thinned, end))

    def minimum(self, thinned: Minimum) -> Minimum | None:
        """The minimum on all data that a point on thinned data leads to; None if it is new."""
        ends = (end for seen, end in self._seen if _leads_to(thinned.x, thinned.sse, seen))
        return next(ends, None)

    def leads_to_one(self, x: FloatArray, sse: float) -> bool:
        """Whether a point with this sum of squares leads to a known minimum."""
        return any(_leads_to(x, sse, seen) for seen, _ in self._seen)


def _leads_to(x: FloatArray, sse: float, end: Minimum) -> bool:
    """Whether a point is at a minimum, or so near that the Jacobian there predicts its sum."""
    variance = max(end.sse, 1e-300) / len(end.residual)
    with np.errstate(over="ignore", invalid="ignore"):  # an end may be where the model overflows
        apart = end.R @ (x - end.x)
        predicted, excess = float(apart @ apart) / variance, (sse - end.sse) / variance
    if abs(excess) <= _SAME_SUM and predicted <= _SAME:
        return True
    return excess <= _NEAR and predicted / _ALIKE <= excess <= predicted * _ALIKE
