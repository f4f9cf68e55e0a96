"""The errors of surae: one line each, saying what, where and what to do."""

import re
from collections.abc import Iterator
from contextlib import contextmanager

#: Letters without a space that a message repeats of what was given, and its letters in all: names
#: of files have up to 255, and what is listed there to choose from is a few hundred.
_WORD = re.compile(r"(\S{280})\S{20,}")
_MOST = 2000


def in_short(message: str) -> str:
    """A message that repeats no more of what was given than shows which it is."""
    text = _WORD.sub(r"\1…", message[: 100 * _MOST])
    return text if len(text) <= _MOST else f"{text[: _MOST - 1]}…"


class SuraeError(Exception):
    """Base of every error that surae raises on purpose; what it repeats is cut to what shows it."""

    def __init__(self, *given: object) -> None:
        super().__init__(*(in_short(e) if type(e) is str else e for e in given))

    def _render_traceback_(self) -> list[str]:
        """What a notebook shows: the line, without the calls within surae that led to it."""
        return [f"{type(self).__name__}: {self}"]


class InputError(SuraeError, ValueError):
    """A file, setting or argument is wrong; the message says which and how to mend it."""


class UnknownNameError(InputError, KeyError):
    """A name that a mapping has not; the message says which it has, and the nearest."""

    __str__ = Exception.__str__


class ComputationError(SuraeError, RuntimeError):
    """A computation could not be carried out on valid input."""


@contextmanager
def within(where: str, then: str = "") -> Iterator[None]:
    """Have an InputError of what is within say where it is, and what to do `then`."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{where}: {error}{then}") from None
