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

import io
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.units import FACTORS, FloatArray
from surae.recording.hdf5 import fixed_text, is_plain, member
from surae.recording.programs.foreign import Parsed, foreign_table, packed
from surae.recording.programs.matlab_layouts import beside, by_channel, known
from surae.recording.source import Source
from surae.recording.table import Table, some
from surae.recording.untrusted import untrusted

_MATLAB5 = b"MATLAB 5.0 MAT-file"
_HDF5 = b"\x89HDF\r\n\x1a\n"
#: MATLAB puts its own header of this many bytes before HDF5's.
_USER_BLOCK = 512
#: Names of a vector of times and its factor to seconds, in small letters.
_TIMES = dict.fromkeys(("time", "times", "t"), 1.0) | {
    f"{name}_{unit}": factor for name in ("time", "t") for unit, factor in FACTORS["time"].items()
}
#: Names of a sampling rate [Hz], in small letters without ``_``.
_RATES = ("fs", "rate", "ratehz", "samplingrate", "samplerate", "samplingfrequency")
_UNITS = ("units", "unit")
_TITLES = ("title", "comment")
_LONGEST_UNIT = 100
#: Structures within structures.
_DEEPEST = 4
#: Variables in a file, attributes of one, texts in one.
_MOST_VARIABLES = 10_000
_MOST_ATTRIBUTES = 50
_MOST_TEXTS = 1000
#: What has no times is a signal from so many samples on; beside others, from this part of theirs.
_SIGNAL = 100
_SHORTEST = 10
#: How to save an object as what everybody can open, by its class; else as its structure.
_PLAINLY = {
    "table": 's = table2struct({0}, "ToScalar", true)',
    "timetable": 's = table2struct(timetable2table({0}), "ToScalar", true); '
    "s.time = seconds(s.Time - s.Time(1))",
    "timeseries": "s.time = {0}.Time; s.values = {0}.Data",
}
#: Objects that hold no signal.
_TEXTS = ("string", "categorical", "function_handle", "FileWrapper__")


class _Object(str):
    """The class of a variable that is one of MATLAB's objects."""

    __slots__ = ()


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
        variables = _matlab5(data) if data.startswith(_MATLAB5) else _matlab73(data)
        if any(isinstance(each, _Object) for each in variables.values()):
            variables = {**variables, **_objects(data)}
        columns = list(_signals(variables, "", shown, 0))
        timed = [c for c in columns if isinstance(c.time, np.ndarray) or c.time[1] or c.refused]
        longest = max((len(c.values) for c in timed), default=_SIGNAL)
        # Beside signals with times, shorter vectors are settings.
        columns = [c for c in columns if c in timed or len(c.values) >= longest // _SHORTEST]
        if any(not column.refused for column in columns):
            return packed(columns)
        if not columns:
            raise InputError(
                f"{shown}: no channels: expected structures with values and interval, as Spike2 "
                "exports them, or vectors beside a vector 'time' or a sampling rate 'fs'"
            )
        first, *more = columns
        others = f" ({some([c.name for c in more], 3)} likewise)" if more else ""
        raise InputError(f"{shown}: {first.name!r}: {first.refused}{others}")


def _matlab5(data: bytes) -> Mapping[str, Any]:
    """Variables of version 5 to 7.2: numbers, texts, objects, structures as mappings of these."""
    import scipy.io

    loaded = scipy.io.loadmat(io.BytesIO(data), struct_as_record=False, squeeze_me=True)
    variables = {}
    for name, value in loaded.items():
        if isinstance(value, scipy.io.matlab.MatlabOpaque):
            names, classes = (np.ravel(value)[0][part] for part in ("s0", "s2"))
            variables[_name(names)] = _Object(_name(classes))
        elif not name.startswith("__"):
            variables[name] = _plain(value)
    return variables


def _objects(data: bytes) -> dict[str, Any]:
    """MATLAB's objects as structures, those that mat-io opens."""
    try:
        from matio import load_from_mat
    except ImportError:
        return {}
    with tempfile.TemporaryDirectory(prefix="surae-") as folder:
        path = Path(folder) / "objects.mat"
        path.write_bytes(data)
        try:
            loaded = load_from_mat(str(path))
        except Exception:  # its parser raises anything, and what it can't open is named
            return {}
    opened = {name: _opened(value) for name, value in loaded.items() if not name.startswith("__")}
    return {name: value for name, value in opened.items() if isinstance(value, dict)}


def _opened(value: Any) -> Any:
    """An object's properties, or a table's columns with its times, as a structure."""
    if isinstance(fields := getattr(value, "properties", None), Mapping):
        return {str(name): _opened(field) for name, field in fields.items()}
    if hasattr(value, "columns") and hasattr(value, "index"):  # a pandas DataFrame
        columns = {str(name): np.asarray(value[name]) for name in value.columns}
        if (index := np.asarray(value.index)).dtype.kind in "mM" and len(index):
            columns["time"] = (index - index[0]) / np.timedelta64(1, "s")
        return {name: np.atleast_1d(each.squeeze()) for name, each in columns.items()}
    if isinstance(value, np.ndarray) and value.dtype == object:
        return [_opened(element) for element in value.ravel()]
    return (
        value[0]
        if isinstance(value, np.ndarray) and value.dtype.kind == "U" and value.size == 1
        else value
    )


def _name(raw: Any) -> str:
    return raw.decode("latin-1") if isinstance(raw, bytes) else str(raw)


def _plain(value: Any) -> Any:
    """A structure as a mapping; structures side by side as a list of mappings."""
    if (class_name := getattr(value, "classname", None)) is not None:
        return _Object(str(class_name))
    if (fields := getattr(value, "_fieldnames", None)) is not None:
        return {name: _plain(getattr(value, name)) for name in fields}
    if isinstance(value, np.ndarray) and value.dtype == object:
        return [_plain(element) for element in value.ravel()]
    # Squeezed by SciPy to a plain number.
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    return np.atleast_1d(value) if number else value


def _matlab73(data: bytes) -> Mapping[str, Any]:
    """Variables of version 7.3, which is HDF5."""
    import h5py

    with h5py.File(io.BytesIO(data), "r") as file:
        return _group(file, [_MOST_VARIABLES], 0, set())


def _group(group: Any, remaining: list[int], depth: int, seen: set[int]) -> dict[str, Any]:
    """Variables of a file or structure, each once, not those that are links to somewhere else."""
    import h5py

    variables: dict[str, Any] = {
        key: said
        for key in list(group.attrs)[:_MOST_ATTRIBUTES]
        if _is_rate(key) and (said := _attribute(group.attrs[key])) is not None
    }
    for name in group:
        remaining[0] -= 1
        if remaining[0] < 0:
            raise ValueError(f"more than {_MOST_VARIABLES} variables")
        item = member(group, name)
        if item is None or (place := h5py.h5o.get_info(item.id).addr) in seen:
            continue
        seen.add(place)
        if isinstance(item, h5py.Group) and depth < _DEEPEST and not name.startswith("#"):
            variables[name] = _group(item, remaining, depth + 1, seen)
        elif isinstance(item, h5py.Dataset) and "MATLAB_empty" not in item.attrs:
            variables[name] = _dataset(item)
            for key in list(item.attrs)[:_MOST_ATTRIBUTES]:
                if (said := _attribute(item.attrs[key])) is not None:
                    variables.setdefault(key if _is_rate(key) else f"{name}_{key}", said)
    return variables


def _is_rate(name: str) -> bool:
    """Whether a variable or an attribute is a sampling rate, by its name."""
    return name.casefold().replace("_", "").replace(" ", "") in _RATES


def _attribute(value: Any) -> Any:
    """What an attribute says of its dataset: a rate or texts."""
    if isinstance(value, bytes | str):
        return [_name(value)]
    if isinstance(value, np.ndarray) and value.dtype.kind in "SUO":
        return [_name(each) for each in value.ravel().tolist() if isinstance(each, bytes | str)]
    return np.atleast_1d(value) if isinstance(value, int | float | np.number) else None


def _dataset(dataset: Any) -> Any:
    """An array as MATLAB shows it, whose dimensions HDF5 lists the other way round, or a text."""
    import h5py

    class_name = fixed_text(dataset, "MATLAB_class")
    if "MATLAB_object_decode" in dataset.attrs and class_name is not None:
        return _Object(class_name)
    if dataset.dtype.kind in "SO" and dataset.size <= _MOST_TEXTS and not dataset.external:
        each = np.ravel(dataset[()]).tolist()
        if h5py.check_ref_dtype(dataset.dtype) is not None:  # a cell array
            inner = (dataset.file[reference] for reference in each if reference)
            return [_dataset(cell) for cell in inner if isinstance(cell, h5py.Dataset)]
        return [_name(text) for text in each if isinstance(text, bytes | str)]
    if not is_plain(dataset):
        return np.array("")
    array = np.asarray(dataset[()]).T
    if class_name == "char":
        return "".join(chr(code) for code in np.ravel(array) if 0 < code < 0xD800)
    return array


def _signals(
    variables: Mapping[str, Any], prefix: str, shown: str, depth: int, above: float | None = None
) -> Iterator[Parsed]:
    """The signals among some variables; a rate `above` holds where these have none."""
    if (columns := known(variables, prefix, shown)) is not None:
        yield from columns
        return
    times = {
        name: _floats(value)
        for name, value in variables.items()
        if name.casefold() in _TIMES and len(shape := _shape(value)) == 1 and shape[0] > 1
    }
    seconds = {name: time * _TIMES[name.casefold()] for name, time in times.items()}
    rate = None if times else _rate(variables, f"{shown}: {prefix}") or above
    for name, value in variables.items():
        full = prefix + name
        if isinstance(value, _Object):
            if value not in _TEXTS:
                yield _refused(full, value)
        elif isinstance(value, Mapping):
            if "values" in value and "interval" in value:
                yield _spike2(full, value)
            elif depth < _DEEPEST:
                yield from _signals(value, f"{full}.", shown, depth + 1, rate)
        elif isinstance(value, list):
            each = [element for element in value if isinstance(element, Mapping)]
            for index, element in enumerate(each if depth < _DEEPEST else [], start=1):
                yield from _signals({f"({index})": element}, full, shown, depth + 1, rate)
        elif name not in times and _shape(value):
            for label, vector, unit in _vectors(variables, name, prefix, seconds):
                yield from _placed(label, vector, unit, prefix, seconds, rate)


def _placed(
    label: str,
    vector: Any,
    unit: str,
    prefix: str,
    seconds: Mapping[str, FloatArray],
    rate: float | None,
) -> Iterator[Parsed]:
    """A vector with the times that are as many, or at the rate; nothing where it is no signal."""
    at = next((key for key, time in seconds.items() if len(time) == len(vector)), None)
    if at is not None:
        remark = "" if "_" in at else f"{prefix}{at} is taken as seconds"
        yield Parsed(label, vector, seconds[at], unit, remark, time_name=prefix + at)
    elif len(vector) > 1 and (rate is not None or len(vector) >= _SIGNAL):
        yield Parsed(label, vector, (0.0, rate or 0.0), unit)


def _refused(name: str, value: _Object) -> Parsed:
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
        return [(full, array, "")]
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
    """The sampling rate among some variables [Hz]."""
    rates = {
        name: _floats(value).item()
        for name, value in variables.items()
        if name.casefold().replace("_", "") in _RATES and _shape(value) == (1,)
    }
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
    text = value if isinstance(value, str) and not isinstance(value, _Object) else ""
    shape = _shape(value)
    if len(shape) == 1 and shape[0] <= _LONGEST_UNIT and value.dtype.kind in "iu":
        text = "".join(chr(int(code)) for code in _floats(value) if 0 < code < 0xD800)
    return cleaned(text)
