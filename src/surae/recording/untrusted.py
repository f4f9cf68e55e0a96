"""Files that aren't what they claim to be: what libraries raise on them becomes one InputError."""

import importlib
import struct
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from surae.errors import InputError

_DAMAGE = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    EOFError,
    LookupError,
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
def untrusted(shown: str) -> Iterator[None]:
    """Turn whatever a library raises on a file into one InputError, and silence its warnings."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except InputError:
        raise
    except MemoryError:
        raise InputError(f"{shown}: the file is damaged, or needs too much memory") from None
    except _DAMAGE as error:
        raise InputError(f"{shown}: the file is damaged ({brief(error)})") from None


def brief(error: BaseException) -> str:
    """What a library says of a damaged file, short and in one printable line."""
    return printable(" ".join(str(error).split())[:120]) or type(error).__name__


def printable(text: str) -> str:
    """A text of a file in one printable line."""
    return "".join(letter if letter.isprintable() else "?" for letter in text.strip())


def optional(module: str, format_name: str, shown: str) -> Any:
    """A library that only some formats need."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise InputError(
            f"{shown}: {format_name} needs the package {module}; install it with: "
            'pip install "surae[formats]"'
        ) from None
