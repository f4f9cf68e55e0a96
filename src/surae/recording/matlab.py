"""MATLAB 7.3 files of Spike2 channels: HDF5 groups with ``values``, ``interval``, ``start``."""

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from surae.errors import InputError
from surae.recording.recording import read_only
from surae.recording.samples import sample
from surae.recording.source import Source
from surae.recording.table import Column, Table
from surae.units import FloatArray

_HDF5 = b"\x89HDF\r\n\x1a\n"
_OLDER = b"MATLAB 5.0 MAT-file"
#: MATLAB puts its own header of this many bytes before HDF5's.
_USER_BLOCK = 512
#: Samples in a channel; compressed data may claim any number.
_MOST = 2**28
#: What h5py raises on bytes that aren't what they claim to be.
_DAMAGE = (
    ArithmeticError,
    AttributeError,
    LookupError,
    MemoryError,
    OSError,
    RuntimeError,
    TypeError,
    ValueError,
)


def recognises(source: Source) -> bool:
    """Whether it begins as HDF5, a MATLAB 7.3 file or an older MATLAB file does."""
    return (
        source.data.startswith((_HDF5, _OLDER))
        or source.data[_USER_BLOCK : _USER_BLOCK + len(_HDF5)] == _HDF5
    )


def open_table(source: Source) -> Table:
    """List the channels of a Spike2 export.

    Raises
    ------
    InputError
        It is a MATLAB file of an older version, is damaged, or holds no channels.
    """
    if source.data.startswith(_OLDER):
        raise InputError(
            f"{source.shown}: this MATLAB format (version 7 or older) is not read; save it with "
            "MATLAB's -v7.3 option, or as CSV"
        )
    with _opened(source) as file:
        groups = {name: file[name] for name in file if _is_channel(file, name)}
        units = {name: _text(group["units"]) for name, group in groups.items() if "units" in group}
        names = tuple(groups)
    if not names:
        raise InputError(
            f"{source.shown}: no channels: expected structures with values and interval, as "
            "Spike2 exports them"
        )

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        with _opened(source) as file:
            return {name: _column(file[name], name, source) for name in wanted}

    return Table(
        file=source.shown,
        format="MATLAB",
        names=names,
        time_name="time",
        load=load,
        units={name: unit for name, unit in units.items() if unit},
    )


@contextmanager
def _opened(source: Source) -> Iterator[Any]:
    """The HDF5 file in the source's bytes; whatever is wrong with it is one InputError."""
    import h5py

    try:
        with h5py.File(io.BytesIO(source.data), "r") as file:
            yield file
    except InputError:
        raise
    except _DAMAGE as error:
        reason = " ".join(str(error).split())[:120]
        raise InputError(f"{source.shown}: the file is damaged ({reason})") from None


def _is_channel(file: Any, name: str) -> bool:
    """Whether an entry of the file is a channel of its own, not a link to somewhere else."""
    import h5py

    if not isinstance(file.get(name, getlink=True), h5py.HardLink):
        return False
    group = file[name]
    return isinstance(group, h5py.Group) and "values" in group and "interval" in group


def _column(group: Any, name: str, source: Source) -> Column:
    """Times and values of one channel."""
    where = f"{source.shown}: column {name!r}"
    values = group["values"]
    if values.dtype.kind not in "fiu" or values.external or values.is_virtual:
        raise InputError(f"{where}: its values are not plain numbers stored in this file")
    if values.size > _MOST:
        raise InputError(f"{where}: it has {values.size} samples; at most {_MOST} are read")
    raw = np.asarray(values[()], dtype=np.float64).ravel()
    if values.dtype.kind in "iu":
        # Stored as the converter's counts, not yet in units.
        raw = raw * _scalar(group, "scale", 1.0) + _scalar(group, "offset", 0.0)
    start, interval = _scalar(group, "start", 0.0), _scalar(group, "interval", float("nan"))
    if not (np.isfinite(start) and np.isfinite(interval) and interval > 0):
        raise InputError(f"{where}: start {start:g} s, interval {interval:g} s: not a time axis")
    time: FloatArray = start + interval * np.arange(len(raw), dtype=np.float64)
    return Column(name, read_only(time), read_only(raw), "time", sample)


def _scalar(group: Any, name: str, default: float) -> float:
    """A number of a channel, or `default` where it has none of that name."""
    return float(np.ravel(group[name][()])[0]) if name in group else default


def _text(dataset: Any) -> str:
    """MATLAB's characters as a string."""
    if "MATLAB_empty" in dataset.attrs or dataset.size > 100 or dataset.dtype.kind not in "iu":
        return ""
    return "".join(chr(code) for code in np.ravel(dataset[()]))
