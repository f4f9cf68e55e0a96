"""Curves for a screen: a window of a few thousand points, without losing a peak."""

import numpy as np

from surae import api
from surae.base.units import FloatArray


def window(
    time: FloatArray, values: FloatArray, start: float | None, end: float | None, points: int
) -> tuple[FloatArray, FloatArray]:
    """Some `points` of the samples from `start` to `end` [s] that show all.

    One sample before and one after the part are included, so that the curve goes on to the edges
    of a plot.
    """
    first = 0 if start is None else max(int(np.searchsorted(time, start)) - 1, 0)
    last = len(time) if end is None else int(np.searchsorted(time, end, "right")) + 1
    part = slice(first, last)
    return api.min_max(time[part], values[part], points)


def plain(values: FloatArray, digits: int = 7) -> list[float | None]:
    """Numbers for JSON, in single precision, as a screen needs them; None where there is none."""
    return [
        float(f"{value:.{digits}g}") if np.isfinite(value) else None
        for value in values.astype(np.float32).tolist()
    ]
