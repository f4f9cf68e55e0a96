"""What every file format is turned into: named raw columns, each with its own times."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from surae.errors import InputError
from surae.recording.samples import Position
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class Column:
    """One signal as the file holds it."""

    name: str  #: Its name in the file.
    time: FloatArray  #: Times of the samples [s], shape (n,).
    values: FloatArray  #: The signal, neither converted nor checked, shape (n,).
    time_name: str  #: What the file calls its times.
    position: Position  #: Where a sample is in the file, for messages.


@dataclass(frozen=True, slots=True)
class Table:
    """A data file of which the header has been read.

    Columns may differ in rate, first instant and number of samples: each is loaded with its own
    times.
    """

    file: str  #: The file as it appears in messages.
    format: str  #: Name of its format.
    names: tuple[str, ...]  #: Its columns in the file's order, the time left out.
    time_name: str  #: What it calls its time.
    #: ``load(names)`` reads the named columns, which are in `names` once, as a `Column` each.
    load: Callable[[Sequence[str]], Mapping[str, Column]]
    #: Units that the file states, by column, in its own spelling.
    units: Mapping[str, str] = field(default_factory=dict)
    #: Units that the file states for a kind of signal (`surae.units.FACTORS`), such as angles in
    #: degrees, without saying which of its columns are angles.
    units_of_kind: Mapping[str, str] = field(default_factory=dict)
    #: Settings of the recording that the file states: ``"name"``, ``"emg"``.
    notes: Mapping[str, str] = field(default_factory=dict)
    #: Row of the column names in a format whose names are meant to be ours (CSV), None in one with
    #: names of its own.
    header: int | None = None
    #: What a user should know of a column, in half a sentence: that the file was cut short, that a
    #: scale was applied.
    remarks: Mapping[str, str] = field(default_factory=dict)


def some(names: Iterable[str], most: int = 8) -> str:
    """The first few of `names` for a message, shortened where they are long."""
    every = [name for name in names if name]
    few = ", ".join(repr(name if len(name) <= 40 else name[:37] + "...") for name in every[:most])
    rest = len(every) - most
    return f"{few} and {rest} more" if rest > 0 else few or "none"


#: Samples no further than this many steps from a uniform axis have a rate.
_UNIFORM_STEPS = 1.0


@dataclass(frozen=True, slots=True)
class Sampling:
    """How a column is sampled."""

    n: int  #: Number of its samples.
    #: Its sampling rate [Hz]; None where the samples lie irregularly in time.
    rate_hz: float | None = None
    start_s: float | None = None  #: Time of its first sample [s]; None where it has none.


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
