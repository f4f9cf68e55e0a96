"""JSON files that surae wrote, and the arrays in them; refused where a newer surae wrote them."""

import base64
import json
import math
import zlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surae._version import __version__
from surae.errors import InputError
from surae.files import PathLike, read_bytes, shown
from surae.frozen import read_only
from surae.units import FloatArray

#: Of the file's layout; raised when an older surae could not read it.
FORMAT = 2


def read_json(path: PathLike) -> dict[str, Any]:
    """A JSON object from a file."""
    content = read_bytes(path)
    try:
        data = json.loads(content.decode("utf-8"))
    except UnicodeDecodeError:
        raise InputError(f"{shown(path)}: not a text file, expected JSON") from None
    except RecursionError:
        raise InputError(f"{shown(path)}: nested too deeply, expected JSON of a fit") from None
    except json.JSONDecodeError as error:
        raise InputError(
            f"{shown(path)}: not JSON (line {error.lineno}, column {error.colno}: {error.msg})"
        ) from None
    except ValueError:
        raise InputError(f"{shown(path)}: a number in it has thousands of digits") from None
    if not isinstance(data, dict):
        raise InputError(
            f'{shown(path)}: expected a JSON object {{"…": …}}, found a {type(data).__name__}'
        )
    return data


def check_format(data: Mapping[str, Any], path: PathLike) -> None:
    """Refuse a file whose layout a newer surae made: it may mean what this one does not know."""
    layout = data.get("format", FORMAT)
    if isinstance(layout, bool) or not isinstance(layout, int):
        raise InputError(f"{shown(path)}: a damaged FIT.json (format); fit again")
    if layout > FORMAT:
        raise InputError(
            f"{shown(path)}: written by surae {data.get('surae', '?')} in format {layout}, newer "
            f"than this one reads ({__version__}, format {FORMAT}); upgrade surae"
        )


def real(value: object) -> float:
    """A finite number; text, true and false are none."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{value!r:.40} is not a finite number")
    return float(value)


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
