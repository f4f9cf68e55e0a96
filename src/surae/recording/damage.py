"""Files that aren't what they claim to be: what libraries raise on them becomes one InputError."""

import importlib
import struct
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from surae.errors import InputError
from surae.recording.source import Source

#: Compressed, sparse or never written data may claim any size: what is unpacked is at most this
#: many bytes, and this many times the file's size more.
_ALWAYS_ALLOWED, _MOST_EXPANDED = 64 * 2**20, 300

_DAMAGE = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    EOFError,
    LookupError,
    MemoryError,
    NameError,
    OSError,
    RecursionError,
    RuntimeError,
    SyntaxError,
    TypeError,
    ValueError,
    struct.error,
    zlib.error,
)


@contextmanager
def guarded(source: Source) -> Iterator[None]:
    """Turn whatever a library raises on a file into one InputError, and silence its warnings."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except InputError:
        raise
    except _DAMAGE as error:
        raise InputError(f"{source.shown}: the file is damaged ({brief(error)})") from None


def brief(error: BaseException) -> str:
    """What a library says of a damaged file, short and in one printable line."""
    text = " ".join(str(error).split())[:120] or type(error).__name__
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def allowed_bytes(source: Source) -> int:
    """How many bytes may be unpacked from a file of this size."""
    return _ALWAYS_ALLOWED + _MOST_EXPANDED * len(source.data)


def require_plausible(size: int, source: Source, where: str) -> None:
    """Refuse to unpack `size` bytes from a file that is far too small for them."""
    if size > allowed_bytes(source):
        raise InputError(
            f"{where}: it claims {size / 2**20:.0f} MiB, which a file of "
            f"{len(source.data) / 2**20:.2g} MiB doesn't hold; the file is damaged"
        )


def optional(module: str, format_name: str, source: Source) -> Any:
    """A library that only some formats need.

    Raises
    ------
    InputError
        It isn't installed; the message says how to get it.
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        raise InputError(
            f"{source.shown}: reading {format_name} needs the package {module}; install it with: "
            'pip install "surae[formats]"'
        ) from None
