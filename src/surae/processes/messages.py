"""Messages between a program and its child: JSON, in which bytes and arrays of numbers may stand.

Nothing is pickled: what comes back can run nothing.
"""

import errno
import json
import traceback
from collections.abc import Mapping
from math import prod
from pathlib import Path
from typing import IO, Any

#: The longest line, and the longest array, that is taken [bytes].
_LINE = 2**28
_MOST = 2**34
#: Marks where in a message a piece of bytes stands; what bytes are called; kinds of numbers.
_MARK = "\0piece"
_BYTES = "bytes"
_NUMBERS = "biuf"


def send(stream: IO[bytes], message: Mapping[str, Any]) -> None:
    """Write a message in one go: a line of JSON, then the pieces that stand in it."""
    kinds: list[tuple[str, list[int]]] = []
    blobs: list[bytes] = []

    def piece(value: Any) -> dict[str, int]:
        if isinstance(value, bytes | bytearray | memoryview):
            blobs.append(bytes(value))
            kinds.append((_BYTES, [len(blobs[-1])]))
        elif hasattr(value, "dtype") and value.dtype.kind in _NUMBERS:
            blobs.append(value.tobytes())
            kinds.append((value.dtype.str, list(value.shape)))
        else:
            raise TypeError(f"{type(value).__name__} is no plain data")
        return {_MARK: len(kinds) - 1}

    text = json.dumps(message, allow_nan=False, default=piece)
    stream.write(b"".join([json.dumps([text, kinds]).encode(), b"\n", *blobs]))
    stream.flush()


def received(stream: IO[bytes]) -> dict[str, Any]:
    """Read the next message; EOFError where there is none, or none that is whole."""
    try:
        line = stream.readline(_LINE)
        if not line.endswith(b"\n"):
            raise EOFError
        text, kinds = json.loads(line)
        blobs = [_blob(stream, kind, shape) for kind, shape in kinds]
        message = json.loads(
            text, object_hook=lambda part: blobs[part[_MARK]] if _MARK in part else part
        )
        if not isinstance(message, dict):
            raise EOFError
    except (ValueError, TypeError, LookupError, RecursionError):
        raise EOFError from None
    return message


def _blob(stream: IO[bytes], kind: str, shape: list[int]) -> Any:
    import numpy as np

    number = np.dtype("u1" if kind == _BYTES else kind)
    size = prod(shape) * number.itemsize
    if number.kind not in _NUMBERS or not 0 <= size <= _MOST:
        raise EOFError
    data = stream.read(size)
    if len(data) < size:
        raise EOFError
    return data if kind == _BYTES else np.frombuffer(data, number).reshape(shape)


#: What a system says when there is no room, and what we say.
FULL = (errno.ENOSPC, errno.EDQUOT)
NO_ROOM = "the disk is full; make room and try again, what is finished is kept"


def where(error: BaseException) -> str:
    """An error for a log: its kind and lines of code, not its text, which may name patients."""
    frames = traceback.extract_tb(error.__traceback__)
    places = [f"{'/'.join(Path(frame.filename).parts[-2:])}:{frame.lineno}" for frame in frames]
    return f"{type(error).__name__} at {' < '.join(reversed(places[-8:]))}"


def one_line(text: object) -> str:
    """A message on one line."""
    return " ".join(str(text).split())
