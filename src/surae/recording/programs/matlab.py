"""MATLAB files of any version from 5 on: which variables are signals, and when they were sampled.

Three ways in which a file says it, tried for every structure and for the file as a whole:

- a structure with ``values`` and ``interval``, as Spike2 exports a channel (``start``, ``units``;
  where its values are whole numbers, they are the converter's counts and ``scale`` and ``offset``
  apply);
- vectors beside a vector ``time``, ``times`` or ``t``, in seconds or with ``_ms`` in milliseconds;
- vectors beside a number ``fs``, ``rate``, ``rate_hz``, ``sampling_rate`` or ``sample_rate`` [Hz].

Before these, what programs write (`matlab_layouts.py`). A matrix gives its channels whichever
way it lies, under the names stored beside it. Vectors as long as a signal that have no
times are given without. Tables and other objects of MATLAB's classes are opened by mat-io, where it
can; the others are named.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np
import numpy.typing as npt

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.units import FACTORS, FloatArray, clock_seconds
from surae.recording.programs.foreign import Parsed, foreign_table, packed
from surae.recording.programs.matlab_layouts import beside, by_channel, known, texts
from surae.recording.programs.matlab_variables import (
    DEEPEST,
    STARTS_IN_SECONDS,
    MatlabObject,
    bare,
    interval_said,
    is_start,
    matlab5,
    matlab73,
    objects,
    rate_said,
    start_unit,
)
from surae.recording.source import Source
from surae.recording.table import Table, some
from surae.recording.times import unit_since_epoch
from surae.recording.untrusted import untrusted

_MATLAB5 = b"MATLAB 5.0 MAT-file"
_HDF5 = b"\x89HDF\r\n\x1a\n"
#: MATLAB puts its own header of this many bytes before HDF5's.
_USER_BLOCK = 512
#: Names of a vector of times and its factor to seconds, in small letters.
_TIMES = dict.fromkeys(("time", "times", "t"), 1.0) | {
    f"{name}_{unit}": factor for name in ("time", "t") for unit, factor in FACTORS["time"].items()
}
_UNITS = ("units", "unit")
_TITLES = ("title", "comment")
_LONGEST_UNIT = 100
#: A start [s] beyond is an instant of a calendar.
_CALENDAR = 1e6
#: What has no times is a signal from so many samples on; beside others, from this part of theirs.
_SIGNAL = 100
_SHORTEST = 10
#: A channel so many times shorter than others at one rate may have another.
_FAR_SHORTER = 1.5
#: How to save an object as what everybody can open, by its class; else as its structure.
_PLAINLY = {
    "table": 's = table2struct({0}, "ToScalar", true)',
    "timetable": 's = table2struct(timetable2table({0}), "ToScalar", true); '
    "s.time = seconds(s.Time - s.Time(1))",
    "timeseries": "s.time = {0}.Time; s.values = {0}.Data",
}
#: Objects that hold no signal.
_TEXTS = ("string", "categorical", "function_handle", "FileWrapper__")


def recognises(source: Source) -> bool:
    """Whether it begins as a MATLAB 5 file does, or as HDF5 with or without MATLAB's header."""
    data = source.data
    return (
        data.startswith((_MATLAB5, _HDF5)) or data[_USER_BLOCK : _USER_BLOCK + len(_HDF5)] == _HDF5
    )


def open_table(source: Source) -> Table:
    """The signals; a file without vectors that have times or a rate is refused."""
    plain = not source.data.startswith((_MATLAB5, b"MATLAB"))
    return foreign_table(source, "HDF5" if plain else "MATLAB", __name__)


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """The signals of a file."""
    with untrusted(shown):
        variables = matlab5(data) if data.startswith(_MATLAB5) else matlab73(data)
        if any(isinstance(each, MatlabObject) for each in variables.values()):
            variables = {**variables, **objects(data)}
        columns = _from_the_earliest(list(_signals(variables, "", shown, 0)))
        timed = [c for c in columns if isinstance(c.time, np.ndarray) or c.time[1] or c.refused]
        longest = max((len(c.values) for c in timed), default=_SIGNAL)
        # Beside signals with times, shorter vectors are settings.
        columns = [c for c in columns if c in timed or len(c.values) >= longest // _SHORTEST]
        if any(not column.refused for column in columns):
            return packed(_with_shorter(columns))
        if not columns:
            raise InputError(
                f"{shown}: no channels: expected structures with values and interval, as Spike2 "
                "exports them, or vectors beside a vector 'time' or a sampling rate 'fs'"
            )
        first, *more = columns
        others = f" ({some([c.name for c in more], 3)} likewise)" if more else ""
        raise InputError(f"{shown}: {first.name!r}: {first.refused}{others}")


def _with_shorter(columns: Sequence[Parsed]) -> list[Parsed]:
    """Columns, those that end far before others of the same clock with a word on that."""
    longest: dict[tuple[float, float], int] = {}
    for column in columns:
        if isinstance(column.time, tuple) and column.time[1]:
            longest[column.time] = max(longest.get(column.time, 0), len(column.values))

    def remark(column: Parsed) -> str:
        if not isinstance(column.time, tuple):
            return column.remark
        n, most = len(column.values), longest.get(column.time, 0)
        if _FAR_SHORTER * n >= most:
            return column.remark
        said = (
            f"it has {n} samples where others of {column.time[1]:g} Hz have {most}: if it was "
            "sampled slower, give its start_s and rate_hz"
        )
        return "; ".join(filter(None, (column.remark, said)))

    return [replace(column, remark=remark(column)) for column in columns]


def _start(variables: Mapping[str, Any]) -> float:
    """When signals begin [s], of a number or a date and time; 0 where nothing says it."""
    for name, value in variables.items():
        if not is_start(name):
            continue
        if _shape(value) == (1,):
            number = float(_floats(value)[0])
            since = start_unit(name) or unit_since_epoch(np.array([number]))
            # A count of samples is whole.
            seconds = bare(name) in STARTS_IN_SECONDS or number != round(number)
            if np.isfinite(number) and (since or seconds):
                return number * (clock_seconds(since or "s") or 1.0)
        for text in texts(value):
            try:
                return datetime.fromisoformat(text).replace(tzinfo=UTC).timestamp()
            except (ValueError, OverflowError):
                continue
    return 0.0


def _from_the_earliest(columns: Sequence[Parsed]) -> list[Parsed]:
    """Columns whose starts are instants of a calendar, from the earliest of them."""
    starts = [c.time[0] for c in columns if isinstance(c.time, tuple) and c.time[0] > _CALENDAR]
    if not starts:
        return list(columns)
    first = min(starts)
    return [
        replace(c, time=(c.time[0] - first, c.time[1]))
        if isinstance(c.time, tuple) and c.time[0] > _CALENDAR
        else c
        for c in columns
    ]


def _signals(
    variables: Mapping[str, Any],
    prefix: str,
    shown: str,
    depth: int,
    above: float | None = None,
    began: float = 0.0,
) -> Iterator[Parsed]:
    """The signals among some variables; a rate `above`, and when it `began`, hold below it."""
    if (columns := known(variables, prefix, shown)) is not None:
        yield from columns
        return
    times = {
        name: _floats(value)
        for name, value in variables.items()
        if name.casefold() in _TIMES and len(shape := _shape(value)) == 1 and shape[0] > 1
    }
    seconds = {name: time * _TIMES[name.casefold()] for name, time in times.items()}
    clocks = _own_clocks(variables, shown)
    alike = {len(_floats(variables[name])): clock for name, clock in clocks.items()}
    rate = None if times else _rate(variables, f"{shown}: {prefix}") or above
    start = _start(variables) or began
    for name, value in variables.items():
        full = prefix + name
        if isinstance(value, MatlabObject):
            if value not in _TEXTS:
                yield _refused(full, value)
        elif isinstance(value, Mapping):
            if "values" in value and "interval" in value:
                yield _spike2(full, value)
            elif depth < DEEPEST:
                yield from _signals(value, f"{full}.", shown, depth + 1, rate, start)
        elif isinstance(value, list):
            each = [element for element in value if isinstance(element, Mapping)]
            for index, element in enumerate(each if depth < DEEPEST else [], start=1):
                yield from _signals({f"({index})": element}, full, shown, depth + 1, rate, start)
        elif name not in times and _shape(value):
            of_all = _unit_of_all(variables)
            for label, vector, unit in _vectors(variables, name, prefix, seconds):
                clock = clocks.get(name) or ((start, rate) if rate else alike.get(len(vector)))
                timing = clock or (start, rate)
                yield from _placed(label, vector, unit or of_all, prefix, seconds, timing)


def _own_clocks(variables: Mapping[str, Any], shown: str) -> dict[str, tuple[float, float]]:
    """Start [s] and rate [Hz] of the variables that state one of their own, as attributes do."""
    clocks = {}
    for name, value in variables.items():
        if not _shape(value):
            continue
        attributes = {
            key[len(name) + 1 :]: said
            for key, said in variables.items()
            if key.startswith(f"{name}_") and key != name
        }
        if rate := _rate(attributes, f"{shown}: {name}: "):
            clocks[name] = (_start(attributes), rate)
    return clocks


def _unit_of_all(variables: Mapping[str, Any]) -> str:
    """The one unit that a structure states; empty where it states none or several."""
    said = [texts(value) for name, value in variables.items() if name.casefold() in _UNITS]
    return said[0][0] if len(said) == 1 and len(said[0]) == 1 else ""


def _placed(
    label: str,
    vector: Any,
    unit: str,
    prefix: str,
    seconds: Mapping[str, FloatArray],
    clock: tuple[float, float | None],
) -> Iterator[Parsed]:
    """A vector with the times that are as many, or at the rate; nothing where it is no signal."""
    at = next((key for key, time in seconds.items() if len(time) == len(vector)), None)
    if at is not None:
        remark = "" if "_" in at else f"{prefix}{at} is taken as seconds"
        yield Parsed(label, vector, seconds[at], unit, remark, time_name=prefix + at)
    elif len(vector) > 1 and (clock[1] is not None or len(vector) >= _SIGNAL):
        start, rate = clock
        yield Parsed(label, vector, (start if rate else 0.0, rate or 0.0), unit)


def _refused(name: str, value: MatlabObject) -> Parsed:
    """An object that only MATLAB can open, and how to save it plainly."""
    plainly = _PLAINLY.get(value, "s = struct({0})").format(name)
    refused = (
        f"a MATLAB {value}, which only MATLAB can open; save it plainly there: "
        f'{plainly}; save("plain.mat", "-struct", "s")'
    )
    return Parsed(name, np.empty(0), (0.0, 1.0), refused=refused)


def _vectors(
    variables: Mapping[str, Any], name: str, prefix: str, seconds: Mapping[str, FloatArray]
) -> list[tuple[str, Any, str]]:
    """Label, values and unit of a vector, or of each channel of a matrix."""
    full = prefix + name
    array = variables[name].squeeze()
    if array.ndim == 1 and len(array) > 1:
        said = [texts(variables.get(f"{name}_{key}")) for key in _UNITS]
        return [(full, array, next((each[0] for each in said if len(each) == 1), ""))]
    if array.ndim != 2:
        return []
    fits = next((len(t) for t in seconds.values() if len(t) in array.shape), None)
    if (rows := by_channel(array, fits)) is None:
        return []
    names, units = beside(variables, name, len(rows))
    across = "{},:" if rows.shape == array.shape else ":,{}"
    return [
        (
            f"{full}: {names[i]}" if names else f"{full}({across.format(i + 1)})",
            row,
            units[i] if units else "",
        )
        for i, row in enumerate(rows)
    ]


def _spike2(name: str, channel: Mapping[str, Any]) -> Parsed:
    """A channel as Spike2 exports it."""
    values = channel["values"]
    start = _number(channel, "start", 0.0)
    interval = _number(channel, "interval", float("nan"))
    refused = remark = ""
    if len(_shape(values)) != 1:
        refused = "its values are not plain numbers stored in this file"
    elif not (np.isfinite(start) and np.isfinite(interval) and interval > 0):
        refused = f"start {start:g} s, interval {interval:g} s: not a time axis"
    if refused:
        return Parsed(name, np.empty(0), (0.0, 1.0), refused=refused)
    signal = _floats(values)
    if values.dtype.kind in "iu":  # the converter's counts, not yet in units
        scale = _number(channel, "scale", 1.0)
        offset = _number(channel, "offset", 0.0)
        signal = signal * scale + offset
        remark = f"counts, scale {scale:g} and offset {offset:g} applied"
    unit = next((text for key in _UNITS if (text := _text(channel.get(key)))), "")
    time = start + interval * np.arange(len(signal), dtype=np.float64)
    said = (text for key in _TITLES if (text := _text(channel.get(key))))
    return Parsed(name, signal, time, unit=unit, remark=remark, description=next(said, ""))


def _rate(variables: Mapping[str, Any], where: str) -> float | None:
    """The sampling rate among some variables [Hz], or one over the interval where none is."""
    numbers = {n: _floats(v).item() for n, v in variables.items() if _shape(v) == (1,)}
    rates = {n: rate for n, x in numbers.items() if (rate := rate_said(n, x)) is not None}
    for name, number in () if rates else numbers.items():
        factor = interval_said(name)
        if factor is not None and number > 0.0:
            rates[name] = 1.0 / (number * factor)
    if not rates:
        return None
    rate, *others = set(rates.values())
    if others or not (np.isfinite(rate) and rate > 0):
        raise InputError(f"{where}{' and '.join(rates)}: not a sampling rate")
    return rate


def _shape(value: Any) -> tuple[int, ...]:
    """Shape of an array of numbers, a row or column of a matrix as a vector; empty for no array."""
    if getattr(getattr(value, "dtype", None), "kind", "") not in ("f", "i", "u"):
        return ()
    return tuple(int(size) for size in value.shape if size != 1) or (1,)


def _floats(value: npt.NDArray[Any]) -> FloatArray:
    """An array of numbers, its dimensions of one left out."""
    with np.errstate(invalid="ignore"):
        return np.atleast_1d(np.asarray(value, dtype=np.float64).squeeze())


def _number(channel: Mapping[str, Any], name: str, default: float) -> float:
    """A number of a channel, or `default` where it has none of that name."""
    value = channel.get(name)
    return default if value is None or _shape(value) != (1,) else float(_floats(value)[0])


def _text(value: Any) -> str:
    """A text of a channel, or the letters' numbers as MATLAB stores them; empty for neither."""
    text = value if isinstance(value, str) and not isinstance(value, MatlabObject) else ""
    shape = _shape(value)
    if len(shape) == 1 and shape[0] <= _LONGEST_UNIT and value.dtype.kind in "iu":
        text = "".join(chr(int(code)) for code in _floats(value) if 0 < code < 0xD800)
    return cleaned(text)
