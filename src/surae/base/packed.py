"""Numbers and arrays as files have them: finite or none, and packed."""

import base64
import math
import zlib
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.units import FloatArray


def real(value: object) -> float:
    """A finite number; text, true and false are none."""
    with suppress(OverflowError, ValueError, TypeError):
        if isinstance(value, int | float) and math.isfinite(value) and not isinstance(value, bool):
            return float(value)
    raise ValueError(f"{brief(value)} is not a finite number")


def brief(value: object) -> str:
    """A value as it appears in a message."""
    try:
        text = repr(value)
    except ValueError:
        return "a number of thousands of digits"
    return text if len(text) <= 60 else f"{text[:57]}..."


def finite(value: float) -> float | None:
    """A number as JSON has it: None where it is not finite."""
    value = value.item() if isinstance(value, np.generic) else value
    return value if math.isfinite(value) else None


_ENCODING = "float64 little-endian, zlib, base64"
#: A file's arrays hold so many times the bytes that they are packed in at most.
_PACKS = 100


def encode(array: FloatArray) -> dict[str, Any]:
    """An array as plain JSON data: its shape, how it is packed, and the packed bytes."""
    packed = zlib.compress(np.ascontiguousarray(array, dtype="<f8").tobytes(), 6)
    return {
        "shape": list(array.shape),
        "encoding": _ENCODING,
        "data": base64.b64encode(packed).decode("ascii"),
    }


def bound_arrays(data: Any) -> None:
    """Refuse packed arrays that claim far more numbers than what was measured packs into.

    Noise, which each measured signal and each residual is, packs to three quarters; a file of
    traces of which most are zero to a twelfth.
    """
    claimed = 0
    packed = 0
    open_ = [data]
    while open_:
        part = open_.pop()
        if isinstance(part, Mapping) and {"shape", "encoding", "data"} <= part.keys():
            sizes = part["shape"] if isinstance(part["shape"], list) else []
            if all(type(n) is int and n >= 0 for n in sizes):
                claimed += 8 * math.prod(sizes)
            packed += len(part["data"]) if isinstance(part["data"], str) else 0
        elif isinstance(part, Mapping | list):
            open_ += part.values() if isinstance(part, Mapping) else part
    if claimed > _PACKS * packed + 2**20:
        raise InputError(f"its arrays claim {claimed / 2**20:.3g} MiB in {packed / 2**20:.2g} MiB")


def decode(packed: Mapping[str, Any]) -> FloatArray:
    """The array that `encode` packed, else ValueError; in no more memory than its shape takes."""
    shape = packed["shape"]
    if packed["encoding"] != _ENCODING or not all(type(n) is int and n >= 0 for n in shape):
        raise ValueError(f"an array is packed as {brief(packed['encoding'])}, {brief(shape)}")
    size = 8 * math.prod(shape)
    unpacker = zlib.decompressobj()
    try:
        data = unpacker.decompress(base64.b64decode(packed["data"], validate=True), size + 1)
    except (zlib.error, OverflowError) as error:
        raise ValueError(str(error)) from None
    if len(data) != size:
        raise ValueError(f"an array holds {len(data)} bytes, expected {size}")
    return read_only(np.frombuffer(data, dtype="<f8").reshape(shape))
