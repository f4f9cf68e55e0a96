"""Formats that a library reads: in a child process, which a broken file may crash or hang.

Such a format's module has, beside `recognises` and `open_table`, a function ``parse(data, shown)``
that is called in the child and returns what `packed` makes of its columns.
"""

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from surae.base.errors import ComputationError, InputError
from surae.base.frozen import as_read_only
from surae.base.units import FloatArray
from surae.processes import guarded
from surae.recording.source import Source
from surae.recording.table import Column, Table, instants, sample

#: What a reader may take at most [s, bytes], and the more for every byte of the file: pyxdf reads
#: about 3 MB/s, SciPy and edfio hold a file several times.
_MEMORY = 2 * 2**30
_MEMORY_PER_BYTE = 20


@dataclass(frozen=True, slots=True)
class Patience:
    """How long a library may take over a file, of processor time [s]."""

    seconds: float = 10.0
    per_byte: float = 2e-6


_PATIENCE = Patience()


@dataclass(frozen=True, slots=True, eq=False)
class Parsed:
    """A column as its library read it."""

    name: str  #: Its name in the file.
    values: npt.NDArray[Any]  #: Its samples, shape (n,).
    #: First instant [s] and rate [Hz], or the time of every sample [s], shape (n,); with the rate
    #: 0 there are none, and its samples are counted.
    time: tuple[float, float] | FloatArray
    unit: str = ""  #: As the file spells it, empty where it states none.
    remark: str = ""  #: What a user should know of it.
    refused: str = ""  #: Why it must not be used; empty where it may be.
    time_name: str = "time"  #: What the file calls its times.
    description: str = ""  #: What the file says of it beside its name.


def cut_short(announced: float, present: int) -> str:
    """What to say where a file announces more samples than it holds; empty where it does not."""
    if not announced > present:
        return ""
    return f"the header states {announced:g} samples, the file holds {present}: it was cut short"


def packed(columns: Sequence[Parsed], began: str = "") -> dict[str, Any]:
    """Columns as plain data, arrays of times that several share once; and when the file began."""
    times = {id(c.time): c.time for c in columns if isinstance(c.time, np.ndarray)}
    places = {key: index for index, key in enumerate(times)}
    plain = [
        {name: getattr(column, name) for name in Parsed.__dataclass_fields__}
        | {"time": places.get(id(column.time), column.time)}
        for column in columns
    ]
    return {"columns": plain, "times": list(times.values()), "began": began}


def in_child(source: Source, format_name: str, module: str, patience: Patience = _PATIENCE) -> Any:
    """What ``<module>:parse`` makes of a file, in a child process.

    A reader that crashes, or takes too long or too much memory, is an InputError too.
    """
    size = len(source.data)
    try:
        return guarded(
            f"{module}:parse",
            {"data": source.data, "shown": source.shown},
            seconds=patience.seconds + patience.per_byte * size,
            memory=_MEMORY + _MEMORY_PER_BYTE * size,
        )
    except ComputationError as error:
        raise InputError(
            f"{source.shown}: {format_name} that cannot be read: damaged, or too large "
            f"({str(error).partition(';')[0]})"
        ) from None


def foreign_table(
    source: Source, format_name: str, module: str, patience: Patience = _PATIENCE
) -> Table:
    """The table that ``<module>:parse`` makes of a file's packed columns."""
    plain = in_child(source, format_name, module, patience)
    times = [as_read_only(time) for time in plain["times"]]
    columns = [Parsed(**fields) for fields in plain["columns"]]
    by_name = {column.name: column for column in reversed(columns)}

    def loaded(name: str) -> Column:
        column = by_name[name]
        if column.refused:
            raise InputError(f"{source.shown}: column {name!r}: {column.refused}")
        at: Any = column.time
        if not isinstance(at, int) and at[1] == 0.0:
            counted = instants(0.0, 1.0, len(column.values))
            return Column(name, counted, as_read_only(column.values), "", sample)
        time = (
            times[at]
            if isinstance(at, int)
            else instants(float(at[0]), float(at[1]), len(column.values))
        )
        return Column(name, time, as_read_only(column.values), column.time_name, sample)

    return Table(
        source.shown,
        format_name,
        tuple(column.name for column in columns),
        "time" if any(isinstance(c.time, int) or c.time[1] for c in columns) else "",
        lambda wanted: {name: loaded(name) for name in wanted},
        units={name: column.unit for name, column in by_name.items() if column.unit},
        remarks={name: column.remark for name, column in by_name.items() if column.remark},
        descriptions={name: c.description for name, c in by_name.items() if c.description},
        began=plain["began"],
    )


def optional(module: str, format_name: str, shown: str) -> Any:
    """A library that only some formats need."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise InputError(
            f"{shown}: {format_name} needs the package {module}; install it with: "
            'pip install "surae[formats]"'
        ) from None
