"""HDF5 files as a source of numbers, whatever they claim: bounded, and one error where wrong."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from surae.errors import InputError
from surae.recording.foreign import untrusted
from surae.recording.source import Source
from surae.units import FloatArray

#: Compressed, sparse or never written data may claim any size: what is unpacked is at most this
#: many bytes, and this many times the file's size more.
_ALWAYS_ALLOWED, _MOST_EXPANDED = 64 * 2**20, 300
#: Characters of a text that is read.
_LONGEST_TEXT = 2**20


@contextmanager
def opened(source: Source) -> Iterator[Any]:
    """The HDF5 file in the source's bytes; whatever is wrong with it is one InputError."""
    import h5py

    with untrusted(source.shown), h5py.File(io.BytesIO(source.data), "r") as file:
        yield file


def member(group: Any, name: str) -> Any:
    """An entry of a group, None where it has none or only a link to somewhere else."""
    import h5py

    return group[name] if isinstance(group.get(name, getlink=True), h5py.HardLink) else None


def is_plain(dataset: Any) -> bool:
    """Whether a dataset is plain numbers stored in this file, not in others."""
    return dataset.dtype.kind in "fiu" and not dataset.external and not dataset.is_virtual


def numbers(dataset: Any, source: Source, where: str) -> FloatArray:
    """A dataset's numbers as float64 in one dimension, not checked.

    Those that lie in the file as they are needed are not copied: the array is a view of its bytes.

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
