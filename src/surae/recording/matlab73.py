"""MATLAB 7.3 files, which are HDF5, as variables: read when their values are asked for."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.errors import InputError
from surae.recording.hdf5file import fixed_text, member, numbers, opened
from surae.recording.source import Source
from surae.units import FloatArray

_HDF5 = b"\x89HDF\r\n\x1a\n"
#: MATLAB puts its own header of this many bytes before HDF5's.
_USER_BLOCK = 512
#: Structures within structures; variables in all of them; letters of a text.
_DEEPEST, _MOST_VARIABLES, _LONGEST_TEXT = 4, 10_000, 1000


@dataclass(frozen=True, slots=True)
class Stored:
    """An array in the file; called, it is read.

    Its shape is as MATLAB shows it: HDF5 lists its dimensions the other way round.
    """

    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    read: Callable[[int | None], FloatArray]

    def __call__(self) -> FloatArray:
        """All its numbers."""
        return self.read(None).reshape(self.shape, order="F")

    def column(self, index: int) -> FloatArray:
        """One column of a matrix, read without the others."""
        return self.read(index) if len(self.shape) == 2 else self().squeeze()[:, index]


def recognises(source: Source) -> bool:
    """Whether it is HDF5, with MATLAB's header or without."""
    return (
        source.data.startswith(_HDF5)
        or source.data[_USER_BLOCK : _USER_BLOCK + len(_HDF5)] == _HDF5
    )


def read_variables(source: Source) -> Mapping[str, Any]:
    """The file's variables: arrays, texts, and structures as mappings of these.

    Raises
    ------
    InputError
        The file is damaged.
    """
    with opened(source) as file:
        return _group(file, "", source, [_MOST_VARIABLES], 0)


def _group(group: Any, path: str, source: Source, left: list[int], depth: int) -> dict[str, Any]:
    """Variables of a file or structure, not those that are links to somewhere else."""
    import h5py

    found: dict[str, Any] = {}
    for name in group:
        left[0] -= 1
        if left[0] < 0:
            raise InputError(f"{source.shown}: more than {_MOST_VARIABLES} variables")
        item = member(group, name)
        if isinstance(item, h5py.Group) and depth < _DEEPEST and not name.startswith("#"):
            found[name] = _group(item, f"{path}/{name}", source, left, depth + 1)
        elif isinstance(item, h5py.Dataset):
            value = _dataset(item, f"{path}/{name}", source)
            if value is not None:
                found[name] = value
    return found


def _dataset(dataset: Any, path: str, source: Source) -> Any:
    """An array to read later, a single number, or a text; None for what can be no signal."""
    if fixed_text(dataset, "MATLAB_class") == "char":
        plain = dataset.dtype.kind in "iu" and dataset.size <= _LONGEST_TEXT
        if "MATLAB_empty" in dataset.attrs or not plain:
            return ""
        return "".join(chr(code) for code in np.ravel(dataset[()]) if 0 < code < 0xD800)
    if dataset.dtype.kind not in "fiu" or "MATLAB_empty" in dataset.attrs:
        return np.array("") if dataset.dtype.kind not in "fiu" else None
    shape = tuple(int(size) for size in reversed(dataset.shape))

    def read(column: int | None) -> FloatArray:
        where = f"{source.shown}: column {path[1:].replace('/', '.')!r}"
        with opened(source) as file:
            return numbers(file[path], source, where, column)

    if dataset.size == 1:
        return np.ravel(dataset[()])
    return Stored(shape, dataset.dtype, read)
