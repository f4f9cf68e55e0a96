"""What a data file holds, column by column: unit, rate, first instant, number of samples."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.errors import InputError
from surae.recording.table import Column, Sampling, Table
from surae.units import FloatArray

#: Samples no further than this many steps from a uniform axis have a rate.
_UNIFORM_STEPS = 1.0


@dataclass(frozen=True, slots=True)
class Described:
    """One column of a data file.

    Attributes
    ----------
    name : str
        Its name in the file.
    unit : str or None
        The unit that the file states, in its own spelling; None where it states none.
    sampling : Sampling or None
        Number of samples, rate and first instant; the rate is None where the samples lie
        irregularly in time. None where the column cannot be read.
    remark : str
        What a user should know of it; why it cannot be read.
    """

    name: str
    unit: str | None
    sampling: Sampling | None
    remark: str = ""


def described(table: Table) -> tuple[Described, ...]:
    """Describe every column of a data file, in the file's order.

    What the header doesn't state is found from the samples. A column that cannot be read, as one of
    words in a CSV, says why instead of failing all others.
    """
    unstated = [
        name
        for name in table.names
        if (stated := table.sampling.get(name)) is None or stated.start_s is None
    ]
    loaded = load_each(table, unstated)
    found = []
    for name in table.names:
        remark = table.remarks.get(name, "")
        sampling = table.sampling.get(name)
        if name in loaded:
            column = loaded[name]
            if isinstance(column, InputError):
                sampling, remark = None, str(column)
            else:
                sampling = sampling_of(column.time)
        found.append(Described(name, table.units.get(name), sampling, remark))
    return tuple(found)


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
