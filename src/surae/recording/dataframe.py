"""A DataFrame as a recording: its columns have the names of our CSV, or a unit beside them."""

from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np

from surae.errors import InputError
from surae.frozen import freeze, read_only
from surae.recording.naming import NAMES, TIMES
from surae.recording.reading import recording_of_table
from surae.recording.recording import Recording
from surae.recording.table import Column, Table
from surae.units import plain, spelled


@runtime_checkable
class DataFrame(Protocol):
    """What of a pandas DataFrame is used: it need not be installed for the rest."""

    attrs: Any
    columns: Any
    index: Any

    def __getitem__(self, key: Any, /) -> Any:
        """One column."""


def of_frame(table: DataFrame) -> Recording:
    """The recording in a DataFrame whose columns are named as in our CSV.

    A column may also be named by its role alone (``angle``), its unit then standing in
    ``attrs["units"]``; the time is a column or the index.

    Raises
    ------
    InputError
        As of a CSV with such columns.
    """
    where = "DataFrame"
    units = dict(table.attrs.get("units", {}))
    data = {str(name): table[name] for name in table.columns}
    if table.index.name is not None and str(table.index.name) not in data:
        data[str(table.index.name)] = table.index
    renamed: dict[str, str] = {}
    for name in data:
        unit = units.get(name)
        ours = name if plain(name) in NAMES or name in TIMES else None
        if ours is None and unit is not None and (known := spelled(str(unit))) is not None:
            ours = f"{name}_{known.replace('/', '_')}"
        if ours is not None:
            renamed[ours] = name
    times = [name for name in renamed if name in TIMES]
    if len(times) != 1:
        raise InputError(
            f"{where}: {'no column' if not times else 'more than one column'} is the time; name "
            "one time_s (or time_ms), or the index"
        )
    time = freeze(_numbers(data[renamed[times[0]]], where, times[0]) * TIMES[times[0]])

    def load(wanted: Sequence[str]) -> dict[str, Column]:
        return {
            name: Column(
                name, time, _numbers(data[renamed[name]], where, name), times[0],
                lambda index: f"row {index}",
            )
            for name in wanted
        }  # fmt: skip

    notes = {key: str(table.attrs[key]) for key in ("name", "emg") if key in table.attrs}
    names = tuple(name for name in renamed if name != times[0])
    made = Table(where, "DataFrame", names, times[0], load, notes=notes)
    return recording_of_table(made, notes.get("name", where))


def _numbers(values: Any, where: str, name: str) -> Any:
    try:
        return read_only(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        raise InputError(f"{where}: column {name!r} holds no numbers") from None
