"""Frozen plain data that compare, hash, copy and pickle: mappings, arrays, and classes of them."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:  # help reads settings, which need no NumPy
    import numpy as np

    from surae.base.units import FloatArray

__all__ = ["Comparable", "FrozenDict", "freeze", "read_only"]

K = TypeVar("K")
V_co = TypeVar("V_co", covariant=True)


class FrozenDict(Mapping[K, V_co]):
    """A mapping that cannot be changed, and unlike a read-only view can be pickled and hashed."""

    __slots__ = ("_entries",)

    def __init__(self, entries: Mapping[K, V_co] | Iterable[tuple[K, V_co]] = ()) -> None:
        self._entries = dict(entries)

    def __getitem__(self, key: K) -> V_co:
        return self._entries[key]

    def __iter__(self) -> Iterator[K]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __repr__(self) -> str:
        return repr(self._entries)

    def __hash__(self) -> int:
        return hash(_key(self._entries))


class Comparable:
    """Equality, hash and copies by value, for dataclasses that hold arrays.

    Made for ``@dataclass(frozen=True, slots=True, eq=False) class X(Comparable)``. Numbers that are
    not defined (NaN) equal themselves, and arrays that come back from a copy are read-only.
    """

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(
            _same(mine, its) for mine, its in zip(_compared(self), _compared(other), strict=True)
        )

    def __hash__(self) -> int:
        return hash(_key(_compared(self)))

    def __reduce__(self) -> tuple[Any, ...]:
        thing: Any = self
        return _restored, (type(self), tuple(getattr(self, f.name) for f in fields(thing)))


def _compared(thing: Any) -> tuple[Any, ...]:
    """The values of the fields that tell a dataclass from another, by its own declaration."""
    return tuple(getattr(thing, field.name) for field in fields(thing) if field.compare)


def _restored(kind: type, values: tuple[Any, ...]) -> Any:
    """A dataclass from its values, checked before they were copied."""
    made: Any = object.__new__(kind)
    for field, value in zip(fields(kind), values, strict=True):
        _make_read_only(value)
        object.__setattr__(made, field.name, value)
    return made


def _make_read_only(value: Any) -> None:
    import numpy as np

    if isinstance(value, np.ndarray):
        value.setflags(write=False)
    elif isinstance(value, tuple):
        for part in value:
            _make_read_only(part)


def _same(a: Any, b: Any) -> bool:
    """Whether two values are equal, arrays and containers of them included."""
    import numpy as np

    same = a is b
    if not same and (isinstance(a, np.ndarray) or isinstance(b, np.ndarray)):
        real = np.asarray(a).dtype.kind == np.asarray(b).dtype.kind == "f"
        same = np.shape(a) == np.shape(b) and np.array_equal(a, b, equal_nan=real)
    elif not same and isinstance(a, float) and isinstance(b, float):
        same = a == b or (math.isnan(a) and math.isnan(b))
    elif not same and isinstance(a, tuple | list) and isinstance(b, tuple | list):
        same = len(a) == len(b) and all(map(_same, a, b))
    elif not same and isinstance(a, Mapping) and isinstance(b, Mapping):
        same = a.keys() == b.keys() and all(_same(a[key], b[key]) for key in a)
    elif not same and is_dataclass(a) and not isinstance(a, Comparable) and type(a) is type(b):
        same = all(map(_same, _compared(a), _compared(b)))
    elif not same:
        same = bool(a == b)
    return same


def _key(value: Any) -> Any:
    """Something hashable that is the same for values that are equal."""
    import numpy as np

    if isinstance(value, np.ndarray):
        plain = value + 0.0 if value.dtype.kind == "f" else value  # −0 equals 0
        return value.shape, plain.tobytes()
    if is_dataclass(value) and not isinstance(value, Comparable):
        value = _compared(value)  # which may hold what has no hash
    if isinstance(value, tuple | list):
        return tuple(map(_key, value))
    if isinstance(value, Mapping):
        return frozenset((key, _key(entry)) for key, entry in value.items())
    return "NaN" if isinstance(value, float) and math.isnan(value) else value


def read_only(values: Any) -> "FloatArray":
    """A float64 copy of `values` that cannot be written to."""
    import numpy as np

    # A signalling NaN warns where it is cast; the checks of samples find every NaN.
    with np.errstate(invalid="ignore"):
        array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def as_read_only(values: "np.ndarray[Any, Any]") -> "FloatArray":
    """Float64 that cannot be written to: as it is, or a copy where it is not so."""
    return read_only(values) if values.dtype != "float64" or values.flags.writeable else values


def freeze(values: "FloatArray") -> "FloatArray":
    """Make a float64 array read-only that nobody else holds, and return it."""
    values.setflags(write=False)
    return values
