"""What every file format is turned into: named raw columns, each with its own times."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from surae.base.errors import InputError
from surae.base.units import FloatArray, clock_seconds

IndexArray = npt.NDArray[np.intp]

#: Whether samples without a number are left out while a file is read: most of what is computed of a
#: recording needs every sample, and refuses them.
GAPS: ContextVar[bool] = ContextVar("gaps", default=False)


@contextmanager
def leaving_gaps() -> Iterator[None]:
    """Files are read with gaps in time where a channel has no number."""
    token = GAPS.set(True)
    try:
        yield
    finally:
        GAPS.reset(token)


#: Says where sample `index` is, in the terms of its source: "row 12", "sample 12".
Position = Callable[[int], str]


def sample(index: int) -> str:
    """Position of a sample in an array or a binary file; the first is sample 1."""
    return f"sample {index + 1}"


def in_row(rows: Sequence[int] | IndexArray) -> Position:
    """Position of samples that stand in these rows."""
    return lambda index: f"row {rows[index]}"


def instants(start_s: float, rate_hz: float, n: int) -> FloatArray:
    """Read-only times [s] of `n` samples at `rate_hz`, the first at `start_s`."""
    time = start_s + np.arange(n, dtype=np.float64) / rate_hz
    time.setflags(write=False)
    return time


#: More trials than these in a file are none; one has so many samples at least.
MOST_TRIALS = 500
FEWEST_SAMPLES = 8
#: A time falls back where it goes back by more than so many steps.
_BACK = 5.0


def fallbacks(time: FloatArray) -> IndexArray:
    """First samples of all trials but the first, where times fall back; empty where they do not.

    They do where each piece between rises and lasts: rows out of order are no trials.
    """
    steps = np.diff(time)
    rising = steps[steps > 0.0]
    if not len(rising) or not np.isfinite(time).all():
        return np.empty(0, dtype=np.intp)
    backs = np.flatnonzero(steps < -_BACK * np.median(rising)) + 1
    lengths = np.diff([0, *backs, len(time)])
    whole = len(backs) < MOST_TRIALS and lengths.min() >= FEWEST_SAMPLES
    others = np.delete(steps, backs - 1)
    return backs if whole and (others >= 0.0).all() else np.empty(0, dtype=np.intp)


def check_samples(
    time: FloatArray,
    values: FloatArray,
    *,
    where: str,
    names: tuple[str, str],
    position: Position = sample,
    reason: "Callable[[int], str] | None" = None,
) -> None:
    """Check that a signal has two finite samples or more, at times that increase.

    `where` begins the message; `names` are those of the time and of the signal there.
    """
    for name, array in zip(names, (time, values), strict=True):
        if array.ndim != 1:
            raise InputError(f"{where}: {name} has {array.ndim} dimensions; it must have one")
    if len(time) != len(values):
        raise InputError(
            f"{where}: {names[1]} has {len(values)} samples but {names[0]} has {len(time)}"
        )
    if len(time) < 2:
        count = "one sample" if len(time) else "no samples"
        raise InputError(f"{where}: {names[1]} has {count}; at least two are needed")
    check_finite(time, where=where, name=names[0], position=position)
    check_finite(values, where=where, name=names[1], position=position, reason=reason)
    stuck = np.flatnonzero(time[1:] <= time[:-1])
    if stuck.size:
        index = int(stuck[0]) + 1
        if n := len(fallbacks(time)):
            raise InputError(
                f"{where}: {names[0]}, {position(index)}: the time falls back "
                f"{'once' if n == 1 else f'{n} times'} ({time[index]:.12g} s after "
                f"{time[index - 1]:.12g} s): {n + 1} trials in one file, which are never joined; a "
                'mapping reads each: trial = { column = "NAME" } where a column tells them '
                'apart, else trial = { index = "*" }'
            )
        raise InputError(
            f"{where}: {names[0]}, {position(index)}: time doesn't increase "
            f"({time[index]:.12g} s after {time[index - 1]:.12g} s); sort the rows, or where times "
            "are only rounded, give start_s and rate_hz in a mapping"
        )


def check_finite(
    values: FloatArray,
    *,
    where: str,
    name: str,
    position: Position = sample,
    reason: "Callable[[int], str] | None" = None,
) -> None:
    """Check that all of `values` are finite numbers; the message names the first that isn't."""
    wrong = np.flatnonzero(~np.isfinite(values))
    if wrong.size:
        index = int(wrong[0])
        why = (reason(index) if reason else "") or f"{values[index]} is not a finite number"
        more = f"; {len(wrong) - 1} more like it" if len(wrong) > 1 else ""
        raise InputError(f"{where}: {name}, {position(index)}: {why}{more}")


#: So many samples are looked at together, so that a long recording takes no copies.
_PIECE = 1 << 20


def rounding(time: FloatArray, coarsest: float) -> float | None:
    """The decimal step [s], at most `coarsest`, of which all times are multiples, or None.

    Stamps finer than a ten-thousandth of `coarsest` are not rounded in any way that matters.
    """
    digits = int(np.ceil(-np.log10(coarsest)))
    pieces = [time[first : first + _PIECE] for first in range(0, len(time), _PIECE)]

    def apart(scaled: FloatArray) -> float:
        return float(np.max(np.abs(scaled - np.round(scaled))))

    for decimals in range(digits, digits + 4):
        if all(apart(piece * 10.0**decimals) < 1e-4 for piece in pieces):
            return float(10.0**-decimals)
    return None


#: Stamps rounded to less than this part of a step are as good as exact; no coarser ones than so [s]
#: are taken for rounded.
_ROUNDED = 0.02
_COARSEST_S = 0.01
#: A rate is as good as that of the stamps if it moves the last of them by this part of a rounding.
_AS_GOOD = 0.2


#: Digits that programs keep of a time (MATLAB's dlmwrite: 5), and so many stamps show how many.
_DIGITS = range(4, 8)
_SHOW = 5000


def regular(time: FloatArray) -> tuple[FloatArray, str]:
    """Times whose stamps were rounded, at the uniform rate that they were rounded from.

    A program that writes 1500 Hz with three decimals gives every third stamp twice, one that keeps
    five digits so from 10 s on. Stamps are rounded where all are multiples of a decimal step, each
    of its own where digits were kept, and a uniform axis explains each to that step. What was done
    comes with them; nothing, and the stamps themselves, where they are not rounded.
    """
    n = len(time)
    span = float(time[-1] - time[0]) if len(time) else 0.0
    if n < 10 or not span > 0 or not np.isfinite(time).all():
        return time, ""
    mean = span / (n - 1)
    step = rounding(time, _COARSEST_S) if mean < 100 * _COARSEST_S else None
    kept: dict[str, float | FloatArray] = {}
    if step is not None:
        kept[f"{1e3 * step:g} ms" if step < 1 else f"{step:g} s"] = step
    few = time[:: n // _SHOW + 1]
    for digits in _DIGITS:
        in_steps = few / _last_digit(few, digits)
        if np.abs(in_steps - np.round(in_steps)).max() < 1e-3:
            kept[f"{digits} digits"] = _last_digit(time, digits)
            break
    for shown, steps in kept.items():
        if _ROUNDED * mean <= np.max(steps) <= 4 * mean and (even := _uniform(time, steps)):
            return even[0], f"times rounded to {shown}: read as uniform, {even[1]:.6g} Hz"
    return time, ""


def _last_digit(time: FloatArray, digits: int) -> FloatArray:
    """What the last of so many digits of each time counts."""
    return np.asarray(10.0 ** (np.floor(np.log10(np.maximum(np.abs(time), 1e-9))) + 1 - digits))


def _uniform(time: FloatArray, steps: float | FloatArray) -> tuple[FloatArray, float] | None:
    """Even times that were rounded to `steps`, and their rate; None where they were not even."""
    n = len(time)
    step = float(np.max(steps))
    counted = np.arange(n) - (n - 1) / 2.0
    mean = float(counted @ time / (counted @ counted))  # all stamps know it better than two
    del counted  # an hour's takes much
    if not mean > step / 8.0:
        return None
    # A whole rate, or else a period of few digits, where either is what the stamps show.
    rates = (round(1 / mean), *(1 / float(f"{mean:.{digits}g}") for digits in range(1, 5)))
    rate = next(
        (r for r in rates if r and abs(1 / r - mean) * (n - 1) <= _AS_GOOD * step), 1 / mean
    )
    uniform = instants(float(time[0]), rate, n)
    off = time - uniform
    if max(-off.min(), off.max()) < 1e-3 * mean:
        return None  # as good as exact
    off /= steps
    return (uniform, rate) if off.max() - off.min() <= 1.02 else None


@dataclass(frozen=True, slots=True)
class Column:
    """One signal as the file holds it."""

    name: str  #: Its name in the file.
    time: FloatArray  #: Times of the samples [s], shape (n,).
    values: FloatArray  #: The signal, neither converted nor checked, shape (n,).
    time_name: str  #: What the file calls its times.
    position: Position  #: Where a sample is in the file, for messages.
    #: Why a sample of `values` is not a number, where the file holds something else in its place;
    #: empty where it says so itself.
    reason: Callable[[int], str] | None = None
    remark: str = ""  #: What reading it has shown that a user should know.
    #: The time of day at its first sample [s], where its times are a clock's; else None.
    clock_s: float | None = None


@dataclass(frozen=True, slots=True)
class Clock:
    """A column of times."""

    column: str  #: Its name.
    unit: str  #: One of the units of time; empty where nothing says it.
    rule: str  #: Why it is taken for the time.

    @property
    def in_seconds(self) -> float:
        """What its numbers are multiplied by to be seconds."""
        return clock_seconds(self.unit or "s") or 1.0


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
    #: Units that the file states for a kind of signal (`surae.base.units.FACTORS`), such as angles
    #: in degrees, without saying which of its columns are angles.
    units_of_kind: Mapping[str, str] = field(default_factory=dict)
    #: Settings of the recording that the file states: ``"name"``, ``"emg"``.
    notes: Mapping[str, str] = field(default_factory=dict)
    #: Row of the column names in a format whose names are meant to be ours (CSV), None in one with
    #: names of its own.
    header: int | None = None
    #: What a user should know of a column, in half a sentence: that the file was cut short, that a
    #: scale was applied.
    remarks: Mapping[str, str] = field(default_factory=dict)
    #: What the file says of a column beside its name, by which its role may show.
    descriptions: Mapping[str, str] = field(default_factory=dict)
    #: The column that seems to be the time by its shape where none is by its name; nothing is read
    #: by it before a mapping says so.
    offered: Clock | None = None
    began: str = ""  #: The date and time of its 0 s, where the file states it to a second or finer.
    #: ``retimed(column, unit)``: the same table with its times in that column, where the format
    #: can say it better than by the column's numbers.
    retimed: "Callable[[str, str], Table] | None" = None
    #: ``cells(column)``: what a text holds in a column, sample by sample.
    cells: Callable[[str], Sequence[str]] | None = None


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
    start = float(time[0])
    span = float(time[-1] - time[0])
    if n == 1 or not np.isfinite(span) or span <= 0:
        return Sampling(n, None, start if np.isfinite(start) else None)
    mean = span / (n - 1)
    off = float(np.max(np.abs(time - (start + mean * np.arange(n)))))
    return Sampling(n, 1.0 / mean if off <= _UNIFORM_STEPS * mean else None, start)


def load_each(table: Table, names: Sequence[str]) -> Mapping[str, Column | InputError]:
    """The columns, all at once where that works, else each on its own."""
    each: dict[str, Column | InputError] = {}
    try:
        return dict(table.load(list(dict.fromkeys(names))))
    except InputError:
        for name in names:
            try:
                each[name] = table.load([name])[name]
            except InputError as error:
                each[name] = error
    return each
