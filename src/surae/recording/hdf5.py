"""Our own recordings in HDF5: every digit, unit and setting, and where they came from.

A file begins with a line of text (a user block of 512 bytes, which HDF5 tools skip), so that what
it is shows without a library. Behind it::

    /                     attributes surae, name, emg, side, fixed, prepare, device, files
    /channels/<role>      attribute source
    /channels/<role>/values   float64 in SI units, attribute unit; attributes start_s and rate_hz
                              where sample i lies at start_s + i / rate_hz to the last bit, else
    /channels/<role>/time     float64 [s], shared by the channels that have the same times

Texts are UTF-8 of fixed length; ``fixed``, ``prepare``, ``device`` and ``files`` are JSON. Of the
files that a recording came from, names and SHA-256 are kept, not the folders, which may name a
person.
"""

import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from surae._version import __version__
from surae.errors import InputError
from surae.files import PathLike, atomic_file, shown
from surae.frozen import freeze
from surae.recording.described import Setting
from surae.recording.foreign import brief
from surae.recording.hdf5file import member, numbers, opened, text_attribute, write_text
from surae.recording.recording import ROLES, Channel, Recording, SourceFile
from surae.recording.samples import check_samples, instants, sample
from surae.recording.source import Source
from surae.recording.table import Column, Table
from surae.recording.writing import column_name
from surae.records import from_plain
from surae.units import SI, FloatArray, kind

_MAGIC = b"surae recording 1, HDF5\n"
_USER_BLOCK = 512
#: Attributes of the file that are JSON; the others are texts.
_JSON = ("fixed", "prepare", "device", "files")
#: Rates are tried with so many decimals to find the one that gives the times to the last bit.
_DECIMALS = (0, 1, 2, 3, 4, 6)


def write_hdf5(path: PathLike, recording: Recording) -> None:
    """Write a recording so that `surae.recording.read` gives the same recording back.

    The same recording always gives the same bytes; the file holds all of it or what it held before.

    Parameters
    ----------
    path : str or path
        The file; what it held before is replaced.
    recording : Recording
        What to write.

    Raises
    ------
    InputError
        The file cannot be written, or a text or setting cannot be kept in it.
    """
    try:
        buffer = _packed(recording)
    except (OSError, RuntimeError, TypeError, ValueError) as error:
        raise InputError(f"cannot write {shown(path)}: {brief(error)}") from None
    with atomic_file(path) as handle:
        handle.write(buffer.getbuffer())


def _packed(recording: Recording) -> io.BytesIO:
    """The bytes of the file."""
    import h5py

    buffer = io.BytesIO()
    # The newer layout has checksums in its structure, so that damage shows.
    with h5py.File(buffer, "w", userblock_size=_USER_BLOCK, libver=("v110", "v110")) as file:
        write_text(file, "surae", __version__)
        write_text(file, "name", recording.name)
        write_text(file, "emg", recording.emg)
        write_text(file, "side", recording.side or "")
        for key in ("fixed", "prepare", "device"):
            plain = dict(getattr(recording, key))
            write_text(file, key, json.dumps(plain, allow_nan=False))
        files = [{"name": Path(f.path).name, "sha256": f.sha256} for f in recording.files]
        write_text(file, "files", json.dumps(files))
        group = file.create_group("channels", track_order=True)
        written: list[tuple[FloatArray, Any]] = []
        for role, channel in recording.channels.items():
            _write_channel(group.create_group(role), channel, written)
    buffer.seek(0)
    buffer.write(_MAGIC)
    return buffer


def recognises(source: Source) -> bool:
    """Whether it begins as our recordings do."""
    return source.data.startswith(_MAGIC)


def read_recording(source: Source) -> Recording:
    """The recording in one of our files; its `files` begin with this one."""
    with opened(source) as file:
        return _recording(file, source)


def open_table(source: Source) -> Table:
    """Give a file's channels as columns with our CSV names, for mappings that pick some of them."""
    recording = read_recording(source)
    channels = {column_name(role, c.unit): c for role, c in recording.channels.items()}

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        return {
            name: Column(name, channels[name].time, channels[name].values, "time", sample)
            for name in wanted
        }

    return Table(
        file=source.shown,
        format="surae HDF5",
        names=tuple(channels),
        time_name="time",
        load=load,
        units={name: channel.unit for name, channel in channels.items()},
        notes={"name": recording.name, "emg": recording.emg},
    )


def _write_channel(group: Any, channel: Channel, written: list[tuple[FloatArray, Any]]) -> None:
    """One channel; `written` are the times that the file holds already."""
    write_text(group, "source", channel.source)
    values = group.create_dataset("values", data=np.asarray(channel.values, dtype="<f8"))
    write_text(values, "unit", channel.unit)
    if (axis := _uniform(channel.time)) is not None:
        values.attrs["start_s"], values.attrs["rate_hz"] = axis
        return
    for time, dataset in written:
        if time is channel.time or _same(time, channel.time):
            group["time"] = dataset
            return
    dataset = group.create_dataset("time", data=np.asarray(channel.time, dtype="<f8"))
    write_text(dataset, "unit", "s")
    written.append((channel.time, dataset))


def _uniform(time: FloatArray) -> tuple[float, float] | None:
    """Start [s] and rate [Hz] that give these times to the last bit, None where there are none."""
    start, mean = float(time[0]), (len(time) - 1) / float(time[-1] - time[0])
    for rate in dict.fromkeys([*(round(mean, decimals) for decimals in _DECIMALS), mean]):
        if rate > 0 and np.isfinite(rate) and _same(instants(start, rate, len(time)), time):
            return start, rate
    return None


def _same(first: FloatArray, other: FloatArray) -> bool:
    """Whether two arrays are the same, bit by bit."""
    return len(first) == len(other) and np.array_equal(
        np.ascontiguousarray(first).view(np.uint64), np.ascontiguousarray(other).view(np.uint64)
    )


def _recording(file: Any, source: Source) -> Recording:
    """What an open file holds, checked."""
    where = source.shown
    group = member(file, "channels")
    roles = [role for role in ROLES if group is not None and role in group]
    if "angle" not in roles:
        raise InputError(f"{where}: it has no channel 'angle'; the file is damaged")
    clocks: dict[Any, FloatArray] = {}
    channels = {role: _channel(member(group, role), role, source, clocks) for role in roles}
    head = _head(file, where)
    files = (SourceFile(each.name, each.sha256) for each in head.files)
    return Recording(
        head.name, channels, head.emg, head.fixed, head.prepare, (source.file, *files), head.side,
        head.device,
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class _File:
    """A file that the recording was read from before it was written here."""

    name: str
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class _Head:
    """What the file's attributes say of the recording."""

    name: str
    emg: Literal["raw", "envelope"]
    side: Literal["left", "right"] | None
    fixed: Mapping[str, float]
    prepare: Mapping[str, Setting]
    device: Mapping[str, Setting]
    files: tuple[_File, ...]


def _head(file: Any, where: str) -> _Head:
    attributes: dict[str, Any] = {
        name: text_attribute(file, name, where) for name in ("name", "emg", "side", *_JSON)
    }
    attributes["side"] = attributes["side"] or None
    for name in _JSON:
        try:
            attributes[name] = json.loads(attributes[name])
        except (ValueError, RecursionError):
            raise InputError(f"{where}: its attribute {name!r} is no JSON") from None
    try:
        return from_plain(_Head, attributes)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _channel(group: Any, role: str, source: Source, clocks: dict[Any, FloatArray]) -> Channel:
    """One channel; `clocks` are the times that have been read already."""
    where = f"{source.shown}: channel {role!r}"
    dataset = member(group, "values") if group is not None else None
    if dataset is None:
        raise InputError(f"{where}: it has no values; the file is damaged")
    unit = text_attribute(dataset, "unit", where)
    if unit != SI[kind(role)] and not (unit == "1" and kind(role) == "emg"):
        raise InputError(f"{where}: unit {unit!r} is not the SI unit; the file is damaged")
    values = freeze(numbers(dataset, source, where))
    time = _time(group, dataset, len(values), source, where, clocks)
    check_samples(time, values, where=source.shown, names=("time", f"channel {role!r}"))
    return Channel(role, time, values, unit, text_attribute(group, "source", where))


def _time(
    group: Any, values: Any, n: int, source: Source, where: str, clocks: dict[Any, FloatArray]
) -> FloatArray:
    """Times of a channel's `n` samples, the same array for the same times."""
    dataset = member(group, "time")
    key: Any
    if dataset is not None:
        import h5py

        key = h5py.h5o.get_info(dataset.id).addr
        if key not in clocks:
            clocks[key] = freeze(numbers(dataset, source, f"{where}: time"))
        return clocks[key]
    if "start_s" not in values.attrs or "rate_hz" not in values.attrs:
        raise InputError(f"{where}: it has no times; the file is damaged")
    start, rate = (_number(values, name, where) for name in ("start_s", "rate_hz"))
    key = (start, rate, n)
    if key not in clocks:
        if not (np.isfinite(start) and np.isfinite(rate) and rate > 0):
            raise InputError(f"{where}: start {start:g} s, rate {rate:g} Hz: not a time axis")
        clocks[key] = instants(start, rate, n)
    return clocks[key]


def _number(item: Any, name: str, where: str) -> float:
    """A number that an item carries."""
    attribute = item.attrs.get_id(name)
    if attribute.dtype.kind != "f" or attribute.shape != ():
        raise InputError(f"{where}: its attribute {name!r} is no number")
    return float(item.attrs[name])
