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
from surae.base.errors import InputError, within
from surae.base.files import PathLike, atomic_file, shown
from surae.base.frozen import freeze
from surae.base.records import from_plain
from surae.base.units import SI, FloatArray, kind
from surae.recording.described import Setting
from surae.recording.recording import ROLES, Channel, Recording, SourceFile
from surae.recording.source import Source
from surae.recording.table import Column, Table, check_samples, instants, sample
from surae.recording.untrusted import brief, untrusted
from surae.recording.writing import column_name

#: Compressed, sparse or never written data may claim any size: what is unpacked is at most this
#: many bytes, and this many times the file's size more.
_ALWAYS_ALLOWED = 64 * 2**20
_MOST_EXPANDED = 300
#: Characters of a text that is read.
_LONGEST_TEXT = 2**20


def member(group: Any, name: str) -> Any:
    """An entry of a group, None where it has none or only a link to somewhere else."""
    import h5py

    return group[name] if isinstance(group.get(name, getlink=True), h5py.HardLink) else None


def is_plain(dataset: Any) -> bool:
    """Whether a dataset is plain numbers stored in this file, not in others."""
    return dataset.dtype.kind in "fiu" and not dataset.external and not dataset.is_virtual


def numbers(dataset: Any, source: Source, where: str) -> FloatArray:
    """A dataset's numbers as float64 in one dimension, a view of the file's bytes where possible.

    It refuses what is no plain numbers stored in this file, or more than its size can explain.
    """
    import h5py

    if not isinstance(dataset, h5py.Dataset) or not is_plain(dataset):
        raise InputError(f"{where}: its values are not plain numbers stored in this file")
    size = 8 * int(dataset.size or 0)
    if size > _ALWAYS_ALLOWED + _MOST_EXPANDED * len(source.data):
        raise InputError(
            f"{where}: it claims {size / 2**20:.0f} MiB, which a file of "
            f"{len(source.data) / 2**20:.2g} MiB doesn't hold; the file is damaged"
        )
    offset = dataset.id.get_offset()
    if (
        offset is not None
        and dataset.dtype == np.dtype("<f8")
        and offset + dataset.nbytes <= len(source.data)
    ):
        return np.frombuffer(source.data, dtype="<f8", count=dataset.size, offset=offset)
    with np.errstate(invalid="ignore"):
        return np.asarray(dataset[()], dtype=np.float64).ravel()


def fixed_text(item: Any, name: str) -> str | None:
    """A text that an item carries; None where there is none of that name and of fixed length.

    Texts of variable length lie in heaps, in which a damaged size sends the HDF5 library round in
    a circle for ever.
    """
    if name not in item.attrs:
        return None
    import h5py

    attribute = item.attrs.get_id(name)
    kind = attribute.get_type()
    if not isinstance(kind, h5py.h5t.TypeStringID) or kind.is_variable_str():
        return None
    if attribute.shape != () or kind.get_size() > _LONGEST_TEXT:
        return None
    value = item.attrs[name]
    return value if isinstance(value, str) else bytes(value).decode(errors="replace")


def text_attribute(item: Any, name: str, where: str) -> str:
    """A text that an item must carry."""
    text = fixed_text(item, name)
    if text is None:
        raise InputError(f"{where}: its attribute {name!r} is missing or no text")
    return text


def write_text(item: Any, name: str, text: str) -> None:
    """Give an item a text of fixed length."""
    import h5py

    raw = text.encode()
    item.attrs.create(name, raw, dtype=h5py.string_dtype("utf-8", max(len(raw), 1)))


_MAGIC = b"surae recording 1, HDF5\n"
_USER_BLOCK = 512  #: Before the HDF5, for our mark: the least of the format [bytes].
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
        files = [{"name": Path(f.path).name, "sha256": f.sha256} for f in recording.files]
        plain = {key: dict(getattr(recording, key)) for key in _JSON[:-1]} | {"files": files}
        for key in _JSON:
            write_text(file, key, json.dumps(plain[key], allow_nan=False))
        channels = file.create_group("channels", track_order=True)
        written: list[tuple[FloatArray, Any]] = []
        for role, channel in recording.channels.items():
            group = channels.create_group(role)
            write_text(group, "source", channel.source)
            values = group.create_dataset("values", data=np.asarray(channel.values, dtype="<f8"))
            write_text(values, "unit", channel.unit)
            if (axis := _uniform(channel.time)) is not None:
                values.attrs["start_s"], values.attrs["rate_hz"] = axis
                continue
            same = (there for time, there in written if _same(time, channel.time))
            if (dataset := next(same, None)) is None:
                time = np.asarray(channel.time, dtype="<f8")
                dataset = group.create_dataset("time", data=time)
                write_text(dataset, "unit", "s")
                written.append((channel.time, dataset))
            else:
                group["time"] = dataset
    buffer.seek(0)
    buffer.write(_MAGIC)
    return buffer


def recognises(source: Source) -> bool:
    """Whether it begins as our recordings do."""
    return source.data.startswith(_MAGIC)


def read_recording(source: Source) -> Recording:
    """The recording in one of our files; its `files` begin with this one."""
    import h5py

    with untrusted(source.shown), h5py.File(io.BytesIO(source.data), "r") as file:
        group = member(file, "channels")
        roles = [role for role in ROLES if group is not None and role in group]
        if "angle" not in roles:
            raise InputError(f"{source.shown}: it has no channel 'angle'; the file is damaged")
        clocks: dict[Any, FloatArray] = {}
        channels = {role: _channel(member(group, role), role, source, clocks) for role in roles}
        head = _head(file, source.shown)
    files = (source.file, *(SourceFile(each.name, each.sha256) for each in head.files))
    return Recording(
        head.name, channels, head.emg, head.fixed, head.prepare, files, head.side, head.device
    )


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
        source.shown,
        "surae HDF5",
        tuple(channels),
        "time",
        load,
        units={name: channel.unit for name, channel in channels.items()},
        notes={"name": recording.name, "emg": recording.emg},
    )


def _uniform(time: FloatArray) -> tuple[float, float] | None:
    """Start [s] and rate [Hz] that give these times to the last bit, None where there are none."""
    start = float(time[0])
    mean = (len(time) - 1) / float(time[-1] - time[0])
    for rate in dict.fromkeys([*(round(mean, decimals) for decimals in _DECIMALS), mean]):
        if rate > 0 and np.isfinite(rate) and _same(instants(start, rate, len(time)), time):
            return start, rate
    return None


def _same(first: FloatArray, other: FloatArray) -> bool:
    """Whether two arrays are the same, bit by bit."""
    return np.array_equal(
        np.ascontiguousarray(first).view(np.uint64), np.ascontiguousarray(other).view(np.uint64)
    )


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
    with within(where):
        return from_plain(_Head, attributes)


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
    key: Any
    if (dataset := member(group, "time")) is not None:
        import h5py

        key = h5py.h5o.get_info(dataset.id).addr
        if key not in clocks:
            clocks[key] = freeze(numbers(dataset, source, f"{where}: time"))
        return clocks[key]
    axis = []
    for name in ("start_s", "rate_hz"):
        if name not in values.attrs:
            raise InputError(f"{where}: it has no times; the file is damaged")
        attribute = values.attrs.get_id(name)
        if attribute.dtype.kind != "f" or attribute.shape != ():
            raise InputError(f"{where}: its attribute {name!r} is no number")
        axis.append(float(values.attrs[name]))
    start, rate = axis
    key = (start, rate, n)
    if key not in clocks:
        if not (np.isfinite(start) and np.isfinite(rate) and rate > 0):
            raise InputError(f"{where}: start {start:g} s, rate {rate:g} Hz: not a time axis")
        clocks[key] = instants(start, rate, n)
    return clocks[key]
