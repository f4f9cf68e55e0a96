"""The parameters of a C3D file: groups of named numbers and texts, every size checked."""

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from math import prod

import numpy as np

from surae.errors import InputError
from surae.recording.source import Source

_BLOCK = 512
#: Bytes of one value by its type: text, 8-bit, 16-bit, 32-bit float.
_SIZES = {-1: 1, 1: 1, 2: 2, 4: 4}
#: The section has at most 255 blocks; more bytes of values than that are a loop.
_MOST_BYTES = 255 * _BLOCK
#: Parameters continue in others where there are more values than one holds: LABELS2, LABELS3, ...
_PARTS = 99


@dataclass(frozen=True, slots=True)
class Parameters:
    """What the parameters say.

    Attributes
    ----------
    processor : int
        How numbers are stored: 84 Intel, 85 DEC, 86 MIPS.
    values : mapping
        Texts or numbers by group and name.
    """

    processor: int
    values: Mapping[tuple[str, str], list[str] | list[float]]

    def texts(self, group: str, name: str) -> list[str]:
        """A parameter's texts, empty where it has none."""
        return [one for part in self._parts(group, name) for one in part if isinstance(one, str)]

    def numbers(self, group: str, name: str) -> list[float]:
        """A parameter's numbers, empty where it has none."""
        return [
            one for part in self._parts(group, name) for one in part if not isinstance(one, str)
        ]

    def _parts(self, group: str, name: str) -> list[list[str] | list[float]]:
        """A parameter and its continuations."""
        found = []
        for part in range(1, _PARTS):
            values = self.values.get((group, name if part == 1 else f"{name}{part}"))
            if values is None:
                break
            found.append(values)
        return found


def read_parameters(source: Source) -> Parameters:
    """Read the parameter section.

    Raises
    ------
    InputError
        It leads outside the file or isn't one.
    """
    data = source.data
    at = (data[0] - 1) * _BLOCK
    processor = data[at + 3]
    order = ">" if processor == 86 else "<"
    at += 4
    groups: dict[int, str] = {}
    found: list[tuple[int, str, list[str] | list[float]]] = []
    read = 0
    try:
        while data[at] != 0 or data[at + 1] != 0:
            length, number = abs(_signed(data[at])), _signed(data[at + 1])
            name = data[at + 2 : at + 2 + length].decode("latin-1").strip().upper()
            link = at + 2 + length
            (step,) = struct.unpack_from(f"{order}h", data, link)
            if number < 0:
                groups[-number] = name
            elif number > 0:
                values, size = _values(data, link + 2, processor)
                found.append((number, name, values))
                read += size
            if step <= 0:
                break
            at = link + step
            read += 2 + length
            if read > _MOST_BYTES:
                raise ValueError
    except (IndexError, ValueError, struct.error):
        raise InputError(
            f"{source.shown}: the file is damaged (its parameters lead nowhere)"
        ) from None
    return Parameters(processor, {(groups.get(g, ""), name): v for g, name, v in found})


def to_float(raw: bytes, processor: int) -> float:
    """A 32-bit float as this processor stores it."""
    if processor == 85:
        raw = raw[2:] + raw[:2]
    number: float = struct.unpack(">f" if processor == 86 else "<f", raw)[0]
    return number / 4 if processor == 85 else number


def _values(data: bytes, at: int, processor: int) -> tuple[list[str] | list[float], int]:
    """A parameter's values, and their size in bytes: type, dimensions, data."""
    kind, dimensions = _signed(data[at]), data[at + 1]
    shape = list(data[at + 2 : at + 2 + dimensions])
    size = _SIZES.get(kind, 0)
    begin, count = at + 2 + dimensions, prod(shape)
    if not size or dimensions > 7 or len(shape) != dimensions or begin + count * size > len(data):
        raise ValueError
    raw = data[begin : begin + count * size]
    if kind == -1:
        width = shape[0] if shape else 1
        starts = range(0, len(raw), width) if width else range(0)
        return [_text(raw[i : i + width]) for i in starts], len(raw)
    if kind == 4:
        return [to_float(raw[i : i + 4], processor) for i in range(0, len(raw), 4)], len(raw)
    order = ">" if processor == 86 else "<"
    return [float(number) for number in np.frombuffer(raw, f"{order}i{size}")], len(raw)


def _signed(byte: int) -> int:
    """A byte as a number with a sign."""
    return byte - 256 if byte > 127 else byte


def _text(raw: bytes) -> str:
    """A text in one printable line."""
    plain = raw.split(b"\0")[0].decode("latin-1").strip()
    return "".join(letter if letter.isprintable() else "?" for letter in plain)
