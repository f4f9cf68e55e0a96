"""Arrays of float64 as text, to the last bit and without anything that could run."""

import base64
import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from surae.frozen import read_only
from surae.units import FloatArray

_ENCODING = "float64 little-endian, zlib, base64"


def encode(array: FloatArray) -> dict[str, Any]:
    """An array as plain JSON data: its shape, how it is packed, and the packed bytes."""
    packed = zlib.compress(np.ascontiguousarray(array, dtype="<f8").tobytes(), 6)
    return {
        "shape": list(array.shape),
        "encoding": _ENCODING,
        "data": base64.b64encode(packed).decode("ascii"),
    }


def decode(packed: dict[str, Any], shape: Sequence[int]) -> FloatArray:
    """The array that `encode` packed, which must have the given shape.

    It raises ValueError where the data is not that, and never uses more memory than the shape asks
    for.
    """
    if packed["encoding"] != _ENCODING or list(packed["shape"]) != list(shape):
        raise ValueError(f"an array is {packed['shape']}, expected {list(shape)}")
    size = 8 * int(np.prod(shape))
    unpacker = zlib.decompressobj()
    try:
        data = unpacker.decompress(base64.b64decode(packed["data"], validate=True), size + 1)
    except zlib.error as error:
        raise ValueError(str(error)) from None
    if len(data) != size:
        raise ValueError(f"an array holds {len(data)} bytes, expected {size}")
    return read_only(np.frombuffer(data, dtype="<f8").reshape(shape))
