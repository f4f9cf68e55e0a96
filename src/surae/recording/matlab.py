"""MATLAB files of any version from 5 on: which variables are signals, and when they were sampled.

Three ways in which a file says it, tried for every structure and for the file as a whole:

- a structure with ``values`` and ``interval``, as Spike2 exports a channel (``start``, ``units``;
  where its values are whole numbers, they are the converter's counts and ``scale`` and ``offset``
  apply);
- vectors beside a vector ``time``, ``times``, ``t``, ``time_s`` or ``time_ms`` of the same length;
- vectors beside a number ``fs``, ``rate``, ``rate_hz``, ``sampling_rate`` or ``sample_rate`` [Hz].
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.errors import InputError
from surae.recording import matlab5, matlab73
from surae.recording.recording import freeze, read_only
from surae.recording.samples import sample
from surae.recording.source import Source
from surae.recording.table import Column, Table
from surae.recording.timing import instants
from surae.units import FloatArray

#: Names of a vector of times and its factor to seconds, in small letters.
_TIMES = {"time": 1.0, "times": 1.0, "t": 1.0, "time_s": 1.0, "time_ms": 1e-3}
#: Names of a sampling rate [Hz], in small letters.
_RATES = (
    "fs",
    "rate",
    "rate_hz",
    "sampling_rate",
    "sample_rate",
    "samplerate",
    "samplingrate",
    "samplingfrequency",
)
_UNITS = ("units", "unit")
_LONGEST_UNIT = 100
#: Structures within structures.
_DEEPEST = 4
#: Columns of a matrix that are taken as signals of their own.
_MOST_COLUMNS = 512


@dataclass(frozen=True, slots=True)
class _Signal:
    """A vector of the file and its time axis."""

    values: Callable[[], FloatArray]
    time: Callable[[], FloatArray]
    time_name: str = "time"
    unit: str = ""
    remark: str = ""


def recognises(source: Source) -> bool:
    """Whether it begins as a MATLAB 5 file does, or as HDF5 with or without MATLAB's header."""
    return source.data.startswith(matlab5.MAGIC) or matlab73.recognises(source)


def open_table(source: Source) -> Table:
    """List the signals.

    Raises
    ------
    InputError
        The file is damaged, or holds no vectors with times or a rate.
    """
    older = source.data.startswith(matlab5.MAGIC)
    variables = matlab5.read_variables(source) if older else matlab73.read_variables(source)
    signals = dict(_signals(variables, "", source, 0))
    if not signals:
        raise InputError(
            f"{source.shown}: no channels: expected structures with values and interval, as "
            "Spike2 exports them, or vectors beside a vector 'time' or a sampling rate 'fs'"
        )

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        return {
            name: Column(
                name,
                signals[name].time(),
                signals[name].values(),
                signals[name].time_name,
                sample,
            )
            for name in wanted
        }

    return Table(
        file=source.shown,
        format="MATLAB",
        names=tuple(signals),
        time_name="time",
        load=load,
        units={name: one.unit for name, one in signals.items() if one.unit},
        remarks={name: one.remark for name, one in signals.items() if one.remark},
    )


def _signals(
    variables: Mapping[str, Any], prefix: str, source: Source, depth: int
) -> Iterator[tuple[str, _Signal]]:
    """The signals among some variables, with their names."""
    times = {
        name: value
        for name, value in variables.items()
        if name.casefold() in _TIMES and len(shape := _shape(value)) == 1 and shape[0] > 1
    }
    rate = _rate(variables, f"{source.shown}: {prefix}", needed=not times)
    for name, value in variables.items():
        full = prefix + name
        if isinstance(value, Mapping):
            if "values" in value and "interval" in value:
                yield full, _spike2(value, f"{source.shown}: column {full!r}")
            elif depth < _DEEPEST:
                yield from _signals(value, f"{full}.", source, depth + 1)
        elif isinstance(value, list):
            each = [one for one in value if isinstance(one, Mapping)]
            for index, one in enumerate(each if depth < _DEEPEST else [], start=1):
                yield from _signals({f"({index})": one}, full, source, depth + 1)
        elif name not in times and (shape := _shape(value)):
            for label, part, n in _vectors(full, value, shape):
                matching = [one for one in times if _shape(times[one]) == (n,)]
                if matching:
                    yield label, _timed(part, matching[0], times[matching[0]], prefix)
                elif rate is not None and n > 1:
                    yield label, _rated(part, rate, n)


def _vectors(
    name: str, value: Any, shape: tuple[int, ...]
) -> Iterator[tuple[str, Callable[[], FloatArray], int]]:
    """The vectors of an array: itself, or the columns of a matrix."""
    if len(shape) == 1:
        if shape[0] > 1:
            yield name, lambda: _floats(value), shape[0]
    elif len(shape) == 2 and shape[1] <= _MOST_COLUMNS:
        for index in range(shape[1]):
            yield f"{name}(:,{index + 1})", lambda i=index: _column(value, i), shape[0]  # type: ignore[misc]


def _timed(values: Callable[[], FloatArray], name: str, time: Any, prefix: str) -> _Signal:
    """A vector beside its times."""
    factor = _TIMES[name.casefold()]
    return _Signal(
        values=lambda: freeze(values()),
        time=lambda: read_only(_floats(time) * factor),
        time_name=prefix + name,
        remark="" if "_" in name else f"{prefix}{name} is taken as seconds",
    )


def _rated(values: Callable[[], FloatArray], rate_hz: float, n: int) -> _Signal:
    """A vector sampled at a rate."""
    return _Signal(
        values=lambda: freeze(values()),
        time=lambda: instants(0.0, rate_hz, n),
    )


def _spike2(channel: Mapping[str, Any], where: str) -> _Signal:
    """A channel as Spike2 exports it."""
    values = channel["values"]
    shape = _shape(values)
    if len(shape) != 1:
        raise InputError(f"{where}: its values are not plain numbers stored in this file")
    start, interval = _number(channel, "start", 0.0), _number(channel, "interval", float("nan"))
    if not (np.isfinite(start) and np.isfinite(interval) and interval > 0):
        raise InputError(f"{where}: start {start:g} s, interval {interval:g} s: not a time axis")
    n = shape[0]
    counts = values.dtype.kind in "iu"
    scale, offset = _number(channel, "scale", 1.0), _number(channel, "offset", 0.0)

    def scaled() -> FloatArray:
        raw = _floats(values)
        # Stored as the converter's counts, not yet in units.
        return freeze(raw * scale + offset if counts else raw)

    return _Signal(
        values=scaled,
        time=lambda: freeze(start + interval * np.arange(n, dtype=np.float64)),
        unit=next((text for key in _UNITS if (text := _text(channel.get(key)))), ""),
        remark=f"counts, scale {scale:g} and offset {offset:g} applied" if counts else "",
    )


def _rate(variables: Mapping[str, Any], where: str, *, needed: bool) -> float | None:
    """The sampling rate among some variables [Hz]."""
    found = {
        name: _floats(value).item()
        for name, value in variables.items()
        if name.casefold() in _RATES and _shape(value) == (1,)
    }
    if not found or not needed:
        return None
    rates = set(found.values())
    rate = rates.pop()
    if rates or not (np.isfinite(rate) and rate > 0):
        raise InputError(f"{where}{' and '.join(found)}: not a sampling rate")
    return rate


def _shape(value: Any) -> tuple[int, ...]:
    """Shape of an array of numbers, a row or column of a matrix as a vector; empty for no array."""
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    if kind not in ("f", "i", "u"):
        return ()
    shape = tuple(int(size) for size in value.shape if size != 1)
    return shape or (1,)


def _floats(value: Any) -> FloatArray:
    """An array of numbers, its dimensions of one left out."""
    array = value() if callable(value) else value
    with np.errstate(invalid="ignore"):
        plain = np.asarray(array, dtype=np.float64).squeeze()
    return plain.reshape(1) if plain.ndim == 0 else plain


def _column(value: Any, index: int) -> FloatArray:
    """A column of a matrix, converted without the others, which it does not keep in memory."""
    stored = isinstance(value, matlab73.Stored)
    return np.array(_floats(value.column(index) if stored else value.squeeze()[:, index]))


def _number(channel: Mapping[str, Any], name: str, default: float) -> float:
    """A number of a channel, or `default` where it has none of that name."""
    value = channel.get(name)
    return default if value is None or _shape(value) != (1,) else _floats(value).item()


def _text(value: Any) -> str:
    """A text of a channel, or the letters' numbers as MATLAB stores them; empty for neither."""
    text = value if isinstance(value, str) else ""
    shape = _shape(value)
    if len(shape) == 1 and shape[0] <= _LONGEST_UNIT and value.dtype.kind in "iu":
        text = "".join(chr(int(code)) for code in _floats(value) if 0 < code < 0xD800)
    return "".join(letter for letter in text if letter.isprintable()).strip()
