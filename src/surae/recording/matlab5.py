"""MATLAB files of version 5 to 7.2: what they claim is checked before SciPy unpacks any of it.

SciPy allocates what a variable's header claims before it looks whether the file holds that much,
unpacks compressed variables of any size, and crashes on types that don't exist. The tags are
therefore walked first (MAT-File Format, MathWorks, version 5: an 8-byte tag of type and size before
every element).
"""

import io
import struct
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from surae.errors import InputError
from surae.recording.damage import allowed_bytes, guarded, require_plausible
from surae.recording.source import Source

MAGIC = b"MATLAB 5.0 MAT-file"
_HEADER = 128
_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCT, _CHAR = 1, 2, 4
#: Types of elements: names, shapes, flags; numbers; letters in UTF-8, -16 and -32. SciPy looks
#: a type up in a table without asking whether the table reaches so far, and crashes.
_INT8, _INT32, _UINT32 = (1,), (5,), (6,)
_VALUES, _LETTERS = (1, 2, 3, 4, 5, 6, 7, 9, 12, 13), (16, 17, 18)
#: Classes of arrays of numbers: double, single, integers of 8 to 64 bits.
_NUMBERS = range(6, 16)
_COMPLEX = 0x0800
#: Cells and structures within each other, and elements of all of them.
_DEEPEST, _MOST_ELEMENTS = 8, 100_000


@dataclass(slots=True)
class _Walk:
    """The walk through one variable: byte order, and elements still allowed."""

    order: str
    left: int = _MOST_ELEMENTS


def read_variables(source: Source) -> Mapping[str, Any]:
    """The file's variables: numbers, texts, and structures as mappings of these.

    Raises
    ------
    InputError
        The file is damaged or claims more than it can hold.
    """
    import scipy.io

    with guarded(source):
        names = _sound_names(source)
        if not names:
            return {}
        loaded = scipy.io.loadmat(
            io.BytesIO(source.data), variable_names=names, struct_as_record=False, squeeze_me=True
        )
        return {name: _plain(loaded[name]) for name in names if name in loaded}


def _sound_names(source: Source) -> list[str]:
    """Names of the variables whose tags have been found to be right and that can be signals."""
    data = source.data
    order = {b"IM": "<", b"MI": ">"}.get(data[126:128], "")
    if not order or len(data) < _HEADER:
        raise InputError(f"{source.shown}: the file is damaged (its MATLAB header is)")
    names: list[str] = []
    at, unpacked = _HEADER, 0
    while at + 8 <= len(data):
        kind, size = struct.unpack_from(f"{order}II", data, at)
        if at + 8 + size > len(data):
            raise InputError(f"{source.shown}: the file is cut short: byte {at} claims {size} more")
        element = memoryview(data)[at + 8 : at + 8 + size]
        if kind == _COMPRESSED:
            element = _unpacked(element, source, unpacked)
            unpacked += len(element)
            kind, inner = struct.unpack_from(f"{order}II", element, 0)
            if 8 + inner > len(element):
                raise InputError(f"{source.shown}: the file is damaged (a compressed variable)")
            element = element[8 : 8 + inner]
        if kind == _MATRIX and (name := _matrix(element, _Walk(order), 0)):
            if name in names:
                raise InputError(f"{source.shown}: two variables are called {name!r}")
            names.append(name)
        at += 8 + size
    return names


def _unpacked(element: memoryview, source: Source, before: int) -> memoryview:
    """A compressed variable, at most as large as the file's size can explain."""
    allowed = allowed_bytes(source) - before
    unpacker = zlib.decompressobj()
    data = unpacker.decompress(element, max(allowed, 1))
    if unpacker.unconsumed_tail:
        require_plausible(before + len(data) + 1, source, source.shown)
    return memoryview(data)


def _matrix(element: memoryview, walk: _Walk, depth: int) -> str:
    """Check a variable; its name, empty where it can be no signal.

    Raises
    ------
    ValueError
        It claims what it doesn't hold.
    """
    walk.left -= 1
    if walk.left < 0 or depth > _DEEPEST:
        raise ValueError("too many elements within each other")
    if not len(element):
        return ""
    parts = _Parts(element, walk.order)
    flags = parts.take(_UINT32)
    (first,) = struct.unpack_from(f"{walk.order}I", flags, 0)
    kind, complex_ = first & 0xFF, bool(first & _COMPLEX)
    if kind not in (*_NUMBERS, _CELL, _STRUCT, _CHAR):
        return ""
    raw = parts.take(_INT32)
    shape = struct.unpack(f"{walk.order}{len(raw) // 4}i", raw)
    if not 2 <= len(shape) <= 8 or min(shape) < 0:
        raise ValueError("the shape of a variable")
    name = bytes(parts.take(_INT8)).decode("latin-1")
    count = prod(shape)
    if kind in _NUMBERS or kind == _CHAR:
        kinds = _VALUES if kind in _NUMBERS else (*_VALUES, *_LETTERS)
        held = len(parts.take(kinds)) if len(parts) else 0
        if count > held or (complex_ and count > len(parts.take(kinds))):
            raise ValueError(f"a variable of {count} values holds {held} bytes")
        return name
    each = 1
    if kind == _STRUCT:
        (width,) = struct.unpack_from(f"{walk.order}i", parts.take(_INT32), 0)
        fields = parts.take(_INT8)
        if width < 1:
            raise ValueError("the fields of a structure")
        each = len(fields) // width
    if count * each > walk.left:
        raise ValueError(f"a variable of {count} elements")
    for _ in range(count * each):
        _matrix(parts.take((_MATRIX,)), walk, depth + 1)
    return name


class _Parts:
    """The elements within an element, one after the other."""

    def __init__(self, data: memoryview, order: str) -> None:
        self.data, self.order, self.at = data, order, 0

    def __len__(self) -> int:
        return max(len(self.data) - self.at, 0)

    def take(self, kinds: Sequence[int]) -> memoryview:
        """The next element's bytes, which must be of one of these types."""
        kind, size = struct.unpack_from(f"{self.order}II", self.data, self.at)
        begin, end = self.at + 8, self.at + 8 + (size + 7) // 8 * 8
        if kind >> 16:
            # Of at most four bytes, which share the tag's eight.
            kind, size, begin, end = kind & 0xFFFF, kind >> 16, self.at + 4, self.at + 8
        if kind not in kinds:
            raise ValueError(f"an element of type {kind}")
        if begin + size > len(self.data) or begin + size > end:
            raise ValueError("an element leads outside its variable")
        self.at = end
        return self.data[begin : begin + size]


def _plain(value: Any) -> Any:
    """A structure as a mapping; structures side by side as a list of mappings."""
    fields: Sequence[str] | None = getattr(value, "_fieldnames", None)
    if fields is not None:
        return {name: _plain(getattr(value, name)) for name in fields}
    if isinstance(value, np.ndarray) and value.dtype == object:
        return [_plain(one) for one in value.ravel()]
    # Squeezed by SciPy to a plain number.
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    return np.atleast_1d(value) if number else value
