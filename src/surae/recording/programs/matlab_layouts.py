"""How programs lay out their channels in MATLAB files: which matrix, which names, units and rate.

A layout is known by the names of its variables: LabChart and AcqKnowledge (ADInstruments, BIOPAC),
Qualisys, OT BioLab, and objects of the class ``nldat`` (McGill). Each gives columns, or None where
it is another's. `beside` finds names and units of a matrix of any other origin.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.units import FACTORS, FloatArray, spelled
from surae.recording.programs.foreign import Parsed
from surae.recording.roles import heading_unit
from surae.recording.times import time_column

#: Ends of the names of variables that name or measure the channels of a matrix, in small letters.
_NAMES = (
    *("names", "labels", "titles", "channels", "description", "muscles", "header", "headers"),
    "columns",
)
_UNITS = ("units", "unit", "unittext")
_MOST = 512

Variables = Mapping[str, Any]


def texts(value: Any) -> list[str]:
    """Texts in a cell array, a matrix of letters, or a single text."""
    if isinstance(value, str):
        return [cleaned(value)]
    if isinstance(value, np.ndarray) and value.dtype.kind in "USO":
        value = value.ravel().tolist()
    if not isinstance(value, list):
        return []
    flat = [v.ravel()[0] if isinstance(v, np.ndarray) and v.size == 1 else v for v in value]
    return [cleaned(v) for v in flat] if all(isinstance(v, str) for v in flat) else []


def matrix(value: Any) -> FloatArray | None:
    """Numbers of at most two dimensions, also within a cell; None for anything else."""
    while isinstance(value, list) and len(value) == 1:
        value = value[0]
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "fiu":
        return None
    array = np.asarray(value, dtype=np.float64).squeeze()
    return np.atleast_1d(array) if array.ndim <= 2 else None


def number(value: Any, default: float = 0.0) -> float:
    """A single number; `default` where there is none."""
    array = matrix(value)
    return float(array.flat[0]) if array is not None and array.size == 1 else default


def by_channel(array: FloatArray, samples: int | None = None) -> FloatArray | None:
    """A matrix with a row for each channel, whichever way it lies; None for too many of them.

    Its longer side are the samples, unless their number says which it is.
    """
    array = np.atleast_2d(array)
    rows, columns = array.shape
    across = (
        columns == samples if samples in (rows, columns) and rows != columns else rows < columns
    )
    array = array if across else array.T
    return array if len(array) <= _MOST else None


def beside(variables: Variables, name: str, count: int) -> tuple[list[str], list[str]]:
    """Names and units of a matrix's channels that are stored beside it; empty where none fit.

    Those that begin with the matrix's own name are its own, else what fits alone.
    """
    both = []
    for ends in (_NAMES, _UNITS):
        fitting = {
            key: each
            for key, value in variables.items()
            if key.casefold().replace("_", "").endswith(ends) and len(each := texts(value)) == count
        }
        prefixed = [
            each for key, each in fitting.items() if key.casefold().startswith(name.casefold())
        ]
        both.append(next(iter(prefixed or fitting.values()), []))
    return both[0], both[1]


def known(variables: Variables, prefix: str, shown: str) -> list[Parsed] | None:
    """The columns of a structure that one of the programs wrote."""
    keys = {key.casefold(): key for key in variables}
    lowered = {key: variables[name] for key, name in keys.items()}
    for needed, layout in _LAYOUTS:
        if needed <= lowered.keys():
            with np.errstate(all="ignore"):
                columns = list(layout(lowered, prefix, shown))
            if columns:
                return columns
    return None


def _labchart(variables: Variables, prefix: str, shown: str) -> Iterator[Parsed]:
    """LabChart: all blocks of all channels in one row, from ``datastart`` to ``dataend``."""
    data = matrix(variables["data"])
    starts, ends, rates = (_table(variables[key]) for key in ("datastart", "dataend", "samplerate"))
    if data is None or starts is None or ends is None or rates is None:
        return
    data = data.ravel()
    names = texts(variables.get("titles"))
    units = texts(variables.get("unittext"))
    of_unit = _table(variables.get("unittextmap"))
    scale, offset = (_table(variables.get(key)) for key in ("scaleunits", "scaleoffset"))
    counts = variables["data"].dtype.kind in "iu" and scale is not None and offset is not None
    for channel, block in np.ndindex(*starts.shape):
        first = _at(starts, channel, block)
        last = _at(ends, channel, block)
        if not 1 <= first <= last <= len(data):
            continue  # a channel that was off in this block
        values = data[int(first) - 1 : int(last)]
        if counts:
            values = (values + _at(offset, channel, block)) * _at(scale, channel, block)
        unit = int(_at(of_unit, channel, block)) if of_unit is not None else 0
        name = names[channel] if channel < len(names) else f"channel {channel + 1}"
        if starts.shape[1] > 1:
            name = f"block {block + 1}: {name}"
        rate = _at(rates, channel, block)
        yield Parsed(
            prefix + name,
            values,
            _clock(rate, f"{shown}: {name}"),
            units[unit - 1] if 1 <= unit <= len(units) else "",
        )


def _acqknowledge(variables: Variables, prefix: str, shown: str) -> Iterator[Parsed]:
    """AcqKnowledge: a matrix ``data`` and the interval ``isi`` between its samples."""
    data = matrix(variables["data"])
    isi = number(variables["isi"])
    if data is None or (rows := by_channel(data)) is None:
        return
    seconds = FACTORS["time"].get(spelled("".join(texts(variables["isi_units"]))) or "ms", 1e-3)
    names = texts(variables.get("labels"))
    units = texts(variables.get("units"))
    rate = 1.0 / (isi * seconds) if isi > 0 else 0.0
    yield from _rows(rows, names, units, _clock(rate, shown), prefix)


def _otbiolab(variables: Variables, prefix: str, shown: str) -> Iterator[Parsed]:
    """OT BioLab: ``Data``, ``Time``, and in ``Description`` each channel's name and unit."""
    data = matrix(variables["data"])
    names = texts(variables["description"])
    if data is None or (rows := by_channel(data)) is None:
        return
    time = None if variables.get("time") is None else matrix(variables["time"])
    clock: Any = _clock(number(variables.get("samplingfrequency")), shown)
    if time is not None and time.ndim == 1 and len(time) == rows.shape[1]:
        clock = time
    yield from _rows(rows, names, [heading_unit(name) or "" for name in names], clock, prefix)


def _qualisys(variables: Variables, prefix: str, shown: str) -> Iterator[Parsed]:
    """Qualisys Track Manager: boards of analog channels, each with its rate."""
    boards = variables["analog"] if isinstance(variables["analog"], list) else [variables["analog"]]
    for index, board in enumerate(boards, start=1):
        if not isinstance(board, Mapping) or (data := matrix(board.get("Data"))) is None:
            continue
        names = texts(board.get("Labels"))
        rows = by_channel(data, int(number(board.get("NrOfSamples"))))
        if rows is None:
            continue
        clock = _clock(number(board.get("Frequency")), shown)
        before = f"{prefix}board {index}: " if len(boards) > 1 else prefix
        yield from _rows(rows, names, texts(board.get("Unit")), clock, before)


def _nldat(variables: Variables, prefix: str, shown: str) -> Iterator[Parsed]:
    """An object ``nldat``: columns of ``dataSet`` at ``domainStart`` + k ``domainIncr``."""
    data = matrix(variables["dataset"])
    step = number(variables["domainincr"])
    if data is None or (rows := by_channel(data)) is None:
        return
    start, rate = _clock(1.0 / step if step > 0 else 0.0, shown)
    start += number(variables.get("domainstart")) if rate else 0.0
    names = texts(variables.get("channames"))
    units = texts(variables.get("chanunits"))
    yield from _rows(rows, names, units, (start, rate), prefix)


def _simulink(variables: Variables, prefix: str, _: str) -> Iterator[Parsed]:
    """Simulink's structure with time: ``signals``, each with ``values`` and a ``label``."""
    signals = (
        variables["signals"] if isinstance(variables["signals"], list) else [variables["signals"]]
    )
    time = matrix(variables["time"])
    if time is None or time.ndim != 1:
        return
    for index, signal in enumerate(signals, start=1):
        if not isinstance(signal, Mapping) or (data := matrix(signal.get("values"))) is None:
            continue
        label = next(iter(texts(signal.get("label"))), "") or f"signal {index}"
        rows = by_channel(data, len(time))
        for k, values in enumerate([] if rows is None else rows, start=1):
            name = label if rows is not None and len(rows) == 1 else f"{label}(:,{k})"
            if len(values) == len(time):
                yield Parsed(prefix + name, values, time, time_name=f"{prefix}time")


def _importdata(variables: Variables, prefix: str, shown: str) -> Iterator[Parsed]:
    """MATLAB's importdata: a matrix under the heads of its columns, of which one may be time."""
    data = matrix(variables["data"])
    names = texts(variables.get("colheaders"))
    if data is not None and data.ndim == 2 and not names:
        names = texts(variables["textdata"])[-data.shape[1] :]  # the last row of what stood above
    if data is None or data.ndim != 2 or data.shape[1] != len(names):
        return
    clock = time_column(names, shown)
    time: Any = (0.0, 0.0)
    if clock is not None:
        time = data[:, names.index(clock.column)] * clock.in_seconds
    for k, name in enumerate(names):
        if clock is None or name != clock.column:
            unit = heading_unit(name) or ""
            yield Parsed(prefix + (name or f"column {k + 1}"), data[:, k], time, unit)


def _nwb(variables: Variables, prefix: str, shown: str) -> Iterator[Parsed]:
    """A time series of NWB: ``data`` times its conversion, from ``starting_time`` or by stamps."""
    data = matrix(variables["data"])
    if data is None:
        return
    clock: Any = _clock(number(variables.get("rate")), shown)
    if clock[1]:
        clock = (number(variables.get("starting_time")), clock[1])
    stamps = None if variables.get("timestamps") is None else matrix(variables["timestamps"])
    if stamps is not None and stamps.ndim == 1:
        clock = stamps
    samples = len(stamps) if stamps is not None else max(data.shape)
    if (rows := by_channel(data, samples)) is None:
        return
    unit = next(iter(texts(variables.get("data_unit"))), "")
    scale = number(variables["data_conversion"], 1.0)
    offset = number(variables.get("data_offset"))
    title = prefix.rstrip(".")
    for k, values in enumerate(rows, start=1):
        name = title if len(rows) == 1 else f"{title}(:,{k})"
        yield Parsed(name, values * scale + offset, clock, unit)


_LAYOUTS = (
    ({"data", "data_conversion"}, _nwb),
    ({"data", "colheaders"}, _importdata),
    ({"data", "textdata"}, _importdata),
    ({"time", "signals"}, _simulink),
    ({"data", "datastart", "dataend", "samplerate"}, _labchart),
    ({"data", "isi", "isi_units"}, _acqknowledge),
    ({"data", "description", "samplingfrequency"}, _otbiolab),
    ({"analog", "frames", "framerate"}, _qualisys),
    ({"dataset", "domainincr"}, _nldat),
)


def _rows(
    rows: FloatArray, names: list[str], units: list[str], clock: Any, prefix: str
) -> Iterator[Parsed]:
    for index, values in enumerate(rows):
        name = names[index] if len(names) == len(rows) and names[index] else f"channel {index + 1}"
        yield Parsed(prefix + name, values, clock, units[index] if len(units) == len(rows) else "")


def _table(value: Any) -> FloatArray | None:
    """Numbers by channel and block; one for all channels is a row of blocks no more."""
    array = matrix(value)
    return None if array is None else array[:, None] if array.ndim == 1 else array


def _at(table: Any, channel: int, block: int) -> float:
    """A number of a channel in a block, where one may hold for all."""
    return float(table[min(channel, len(table) - 1), min(block, table.shape[1] - 1)])


def _clock(rate: float, where: str) -> tuple[float, float]:
    """Times from 0 at a rate [Hz]; 0 where the file states none."""
    if not (np.isfinite(rate) and rate >= 0.0):
        raise InputError(f"{where}: {rate:g} Hz is not a sampling rate")
    return 0.0, rate
