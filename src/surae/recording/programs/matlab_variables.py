"""The variables of MATLAB and HDF5 files: numbers, texts, and structures as mappings of these."""

import io
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from surae.base.units import FACTORS
from surae.recording.hdf5 import fixed_text, is_plain, member

#: Names of a sampling rate [Hz], in small letters without ``_``.
RATES = ("fs", "rate", "ratehz", "samplingrate", "samplerate", "samplingfrequency")
#: Names of the time from one sample to the next.
INTERVALS = {"dt", "deltat", "ts", "interval", "period", "timestep"}
INTERVALS |= {"samplinginterval", "samplingperiod", "sampleinterval", "sampleperiod"}
#: Names of an instant at which a structure's or group's signals begin, likewise.
STARTS = {"start", "begin", "timestamp", "starttimestamp", "recordingstart", "acquisitionstart"}
#: Of these a number is seconds; of the others it may be a count of samples.
STARTS_IN_SECONDS = {"starttime", "startingtime", "t0", "tstart", "startoffset", "timeoffset"}
STARTS |= STARTS_IN_SECONDS
#: These are an instant where a unit of time stands behind them alone.
_STARTS_BY_UNIT = ("offset", "began")
#: Structures within structures.
DEEPEST = 4
#: Variables in a file, attributes of one, texts in one.
_MOST_VARIABLES = 10_000
_MOST_ATTRIBUTES = 50
_MOST_TEXTS = 1000


class MatlabObject(str):
    """The class of a variable that is one of MATLAB's objects."""

    __slots__ = ()


def matlab5(data: bytes) -> Mapping[str, Any]:
    """Variables of version 5 to 7.2: numbers, texts, objects, structures as mappings of these."""
    import scipy.io

    loaded = scipy.io.loadmat(io.BytesIO(data), struct_as_record=False, squeeze_me=True)
    variables = {}
    for name, value in loaded.items():
        if isinstance(value, scipy.io.matlab.MatlabOpaque):
            names, classes = (np.ravel(value)[0][part] for part in ("s0", "s2"))
            variables[name_of(names)] = MatlabObject(name_of(classes))
        elif not name.startswith("__"):
            variables[name] = _plain(value)
    return variables


def objects(data: bytes) -> dict[str, Any]:
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


def name_of(raw: Any) -> str:
    """A name or text, which may be bytes."""
    return raw.decode("latin-1") if isinstance(raw, bytes) else str(raw)


def _plain(value: Any) -> Any:
    """A structure as a mapping; structures side by side as a list of mappings."""
    if (class_name := getattr(value, "classname", None)) is not None:
        return MatlabObject(str(class_name))
    if (fields := getattr(value, "_fieldnames", None)) is not None:
        return {name: _plain(getattr(value, name)) for name in fields}
    if isinstance(value, np.ndarray) and value.dtype == object:
        return [_plain(element) for element in value.ravel()]
    # Squeezed by SciPy to a plain number.
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    return np.atleast_1d(value) if number else value


def matlab73(data: bytes) -> Mapping[str, Any]:
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
        if (is_rate(key) or is_start(key)) and (said := _attribute(group.attrs[key])) is not None
    }
    for name in group:
        remaining[0] -= 1
        if remaining[0] < 0:
            raise ValueError(f"more than {_MOST_VARIABLES} variables")
        item = member(group, name)
        if item is None or (place := h5py.h5o.get_info(item.id).addr) in seen:
            continue
        seen.add(place)
        if isinstance(item, h5py.Group) and depth < DEEPEST and not name.startswith("#"):
            variables[name] = _group(item, remaining, depth + 1, seen)
        elif isinstance(item, h5py.Dataset) and "MATLAB_empty" not in item.attrs:
            variables[name] = _dataset(item)
            for key in list(item.attrs)[:_MOST_ATTRIBUTES]:
                if (said := _attribute(item.attrs[key])) is not None:
                    # what a single number says of time, as NWB's start, is of all beside it
                    of_all = (is_rate(key) or is_start(key)) and item.size == 1
                    variables.setdefault(key if of_all else f"{name}_{key}", said)
    return variables


def is_rate(name: str) -> bool:
    """Whether a variable or an attribute is a sampling rate or interval, by its name."""
    return rate_said(name, 1.0) is not None or interval_said(name) is not None


def rate_said(name: str, number: float) -> float | None:
    """The sampling rate [Hz] that a number is by its name; None where it is none."""
    attribute = bare(name)
    for unit, factor in (("khz", 1e3), ("hz", 1.0), ("", 1.0)):
        if attribute.endswith(unit) and attribute[: len(attribute) - len(unit)] in RATES:
            return number * factor
    return None


def interval_said(name: str) -> float | None:
    """Factor to seconds of the time between samples that a name says; None where it says none."""
    stem, unit = _with_unit(name)
    return FACTORS["time"][unit or "s"] if stem in INTERVALS else None


def is_start(name: str) -> bool:
    """Whether a variable or an attribute is when signals begin, by its name."""
    stem, unit = _with_unit(name)
    return stem in STARTS or bare(name) in STARTS or (bool(unit) and stem in _STARTS_BY_UNIT)


def start_unit(name: str) -> str:
    """The unit of time in the name of a start; empty where it has none."""
    return "" if bare(name) in STARTS else _with_unit(name)[1]


def _with_unit(name: str) -> tuple[str, str]:
    """A name in small letters and the unit of time that it ends with, apart; or no unit."""
    stem, _, last = name.casefold().rpartition("_")
    unit = last if stem and last in FACTORS["time"] else ""
    return bare(stem if unit else name), unit


def bare(name: str) -> str:
    """A name in small letters, without what joins its words."""
    return name.casefold().replace("_", "").replace(" ", "")


def _attribute(value: Any) -> Any:
    """What an attribute says of its dataset: a rate or texts."""
    if isinstance(value, bytes | str):
        return [name_of(value)]
    if isinstance(value, np.ndarray) and value.dtype.kind in "SUO":
        return [name_of(each) for each in value.ravel().tolist() if isinstance(each, bytes | str)]
    return np.atleast_1d(value) if isinstance(value, int | float | np.number) else None


def _dataset(dataset: Any) -> Any:
    """An array as MATLAB shows it, whose dimensions HDF5 lists the other way round, or a text."""
    import h5py

    class_name = fixed_text(dataset, "MATLAB_class")
    if "MATLAB_object_decode" in dataset.attrs and class_name is not None:
        return MatlabObject(class_name)
    if dataset.dtype.kind in "SO" and dataset.size <= _MOST_TEXTS and not dataset.external:
        each = np.ravel(dataset[()]).tolist()
        if h5py.check_ref_dtype(dataset.dtype) is not None:  # a cell array
            inner = (dataset.file[reference] for reference in each if reference)
            return [_dataset(cell) for cell in inner if isinstance(cell, h5py.Dataset)]
        return [name_of(text) for text in each if isinstance(text, bytes | str)]
    if not is_plain(dataset):
        return np.array("")
    array = np.asarray(dataset[()]).T
    if class_name == "char":
        return "".join(chr(code) for code in np.ravel(array) if 0 < code < 0xD800)
    return array
