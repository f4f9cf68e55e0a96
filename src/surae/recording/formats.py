"""The formats of data files. A new one is a module like these and one line here."""

from typing import Protocol

from surae.recording import (
    c3d,
    delimited,
    edf,
    hdf5,
    matlab,
    opensim,
    poly5,
    trigno,
    xdf,
)
from surae.recording.source import Source
from surae.recording.table import Table


class Format(Protocol):
    """What a format's module offers."""

    def recognises(self, source: Source) -> bool:
        """Whether the content, not the name, is of this format."""
        ...

    def open_table(self, source: Source) -> Table:
        """Read the header; raise InputError where it is wrong."""
        ...


#: In the order in which they are asked; CSV takes what no other claims.
FORMATS: tuple[Format, ...] = (
    hdf5,
    matlab,
    poly5,
    edf,
    xdf,
    c3d,
    opensim,
    trigno,
    delimited,
)


def open_table(source: Source) -> Table:
    """The columns of a data file in any supported format.

    Raises
    ------
    InputError
        The file is of no supported format or its header is wrong.
    """
    return next(form for form in FORMATS if form.recognises(source)).open_table(source)
