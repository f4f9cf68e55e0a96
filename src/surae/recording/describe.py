"""Columns of a data file, all that can be read, and how they are sampled."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.errors import InputError
from surae.recording.table import Column, Table
from surae.units import FloatArray

#: Samples no further than this many steps from a uniform axis have a rate.
_UNIFORM_STEPS = 1.0


@dataclass(frozen=True, slots=True)
class Sampling:
    """How a column is sampled.

    Attributes
    ----------
    n : int
        Number of its samples.
    rate_hz : float or None
        Its sampling rate [Hz]; None where the samples lie irregularly in time.
    start_s : float or None
        Time of its first sample [s]; None where it has none.
    """

    n: int
    rate_hz: float | None = None
    start_s: float | None = None


def sampling_of(time: FloatArray) -> Sampling:
    """Number, rate and first instant of samples at these times [s]."""
    n = len(time)
    if n == 0:
        return Sampling(0)
    start, span = float(time[0]), float(time[-1] - time[0])
    if n == 1 or not np.isfinite(span) or span <= 0:
        return Sampling(n, None, start if np.isfinite(start) else None)
    mean = span / (n - 1)
    off = float(np.max(np.abs(time - (start + mean * np.arange(n)))))
    return Sampling(n, 1.0 / mean if off <= _UNIFORM_STEPS * mean else None, start)


def load_each(table: Table, names: Sequence[str]) -> Mapping[str, Column | InputError]:
    """The columns, all at once where that works, else each on its own."""
    unique = list(dict.fromkeys(names))
    if not unique:
        return {}
    try:
        return dict(table.load(unique))
    except InputError:
        pass
    each: dict[str, Column | InputError] = {}
    for name in unique:
        try:
            each[name] = table.load([name])[name]
        except InputError as error:
            each[name] = error
    return each
