"""Parquet and Feather, the tables of pandas, Polars and R, read with pyarrow."""

import io
import os
from typing import Any

import numpy as np

from surae.base.units import FloatArray
from surae.recording.programs.foreign import Parsed, foreign_table, optional, packed
from surae.recording.source import Source
from surae.recording.table import Table
from surae.recording.times import time_column
from surae.recording.untrusted import untrusted

_PARQUET = b"PAR1"
_FEATHER = b"ARROW1"
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}


def recognises(source: Source) -> bool:
    """Whether it begins as one of the two does."""
    return source.data.startswith((_PARQUET, _FEATHER))


def open_table(source: Source) -> Table:
    """The columns of numbers."""
    return foreign_table(source, "Parquet", __name__)


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """The columns of a file; times are a column of that name, of numbers or of instants."""
    # Within limits on memory: its own allocators and threads claim more than they use.
    os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")
    feather = data.startswith(_FEATHER)
    arrow = optional("pyarrow", "Parquet", shown)
    reader = optional("pyarrow.ipc" if feather else "pyarrow.parquet", "Parquet", shown)
    with untrusted(shown):
        arrow.set_cpu_count(1)
        arrow.set_io_thread_count(1)
        buffer = io.BytesIO(data)
        is_ = arrow.types
        table = (
            reader.open_file(buffer).read_all()
            if feather
            else reader.ParquetFile(buffer, pre_buffer=False).read(use_threads=False)
        )
        kinds = {field.name: field.type for field in table.schema}
        numbers = [
            name
            for name, kind in kinds.items()
            if is_.is_integer(kind) or is_.is_floating(kind) or is_.is_decimal(kind)
        ]
        clock = time_column(numbers, shown)
        name = "" if clock is None else clock.column
        time: Any = (0.0, 0.0)
        if clock is not None:
            time = _floats(table, name) * clock.in_seconds
        for other, kind in kinds.items():
            if not name and (is_.is_timestamp(kind) or is_.is_duration(kind)):
                name = other
                time = _floats(table.set_column(0, other, table.column(other).cast("int64")), other)
                time = (time - time[0]) * _SECONDS[kind.unit]
        columns = []
        for column in numbers:
            unit = (table.schema.field(column).metadata or {}).get(b"unit", b"").decode()
            if column != name:
                columns.append(Parsed(column, _floats(table, column), time, unit, time_name=name))
        return packed(columns)


def _floats(table: Any, name: str) -> FloatArray:
    """A column's numbers, NaN where there is none."""
    numbers = table.column(name).cast("float64", safe=False)
    return np.asarray(numbers.to_numpy(), dtype=np.float64)
