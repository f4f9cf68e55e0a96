"""The errors of surae: one line each, saying what, where and what to do."""

from collections.abc import Iterator
from contextlib import contextmanager


class SuraeError(Exception):
    """Base of every error that surae raises on purpose."""

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
