"""A DataFrame as a recording: its columns have the names of our CSV, or a unit beside them."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import freeze
from surae.base.numbers import real_numbers
from surae.base.units import SI, FloatArray, kind, plain, spelled, to_si
from surae.recording.reading import recording_of_table
from surae.recording.recording import ROLES, Recording
from surae.recording.roles import NAMES, TIMES
from surae.recording.table import Column, Table, in_row

_WHERE = "DataFrame"


@runtime_checkable
class DataFrame(Protocol):
    """What of a pandas DataFrame is used: it need not be installed for the rest."""

    attrs: Any
    columns: Any
    index: Any

    def __getitem__(self, key: Any, /) -> Any:
        """Give one column."""


def of_frame(table: DataFrame) -> Recording:
    """The recording in a DataFrame whose columns are named as in our CSV.

    A column may also be named by its role alone (``angle``), its unit then standing in
    ``attrs["units"]``; the time is a column or the index, in numbers or as time stamps. Where
    ``attrs["times"]`` is ``"own"``, a row without a number of a column is no sample of it.
    """
    stated = table.attrs.get("units")
    units: Mapping[Any, Any] = {} if stated is None else stated
    if not isinstance(units, Mapping):
        raise InputError(f'{_WHERE}: attrs["units"] is no table of units by column')
    data: dict[str, Any] = {}  # by the names of our CSV
    named: dict[str, str] = {}
    columns = [str(column) for column in table.columns]
    for name, column in zip(columns, table.columns, strict=True):
        if columns.count(name) > 1:
            raise InputError(f"{_WHERE}: column {name!r} is there twice; keep one")
        ours = _our_name(name, units.get(name))
        if ours in named:
            raise InputError(
                f"{_WHERE}: columns {named[ours]!r} and {name!r} are the same signal; keep one"
            )
        if ours is not None:
            named[ours] = name
            data[ours] = table[column]
    time_name, time = _time(table, {name: data[name] for name in data if name in TIMES})
    gaps = table.attrs.get("times") == "own"

    def load(wanted: Sequence[str]) -> dict[str, Column]:
        columns = {}
        for name in wanted:
            values = _numbers(data[name], name)
            rows = np.flatnonzero(~np.isnan(values)) if gaps else np.arange(len(values))
            columns[name] = Column(
                name, freeze(time[rows]), freeze(values[rows]), time_name, in_row(rows)
            )
        return columns

    notes = {key: str(table.attrs[key]) for key in ("name", "emg") if table.attrs.get(key)}
    names = tuple(name for name in data if name not in TIMES)
    columns_table = Table(_WHERE, "DataFrame", names, time_name, load, notes=notes)
    return recording_of_table(columns_table, notes.get("name", _WHERE))


def _our_name(name: str, unit: Any) -> str | None:
    """The name that a column would have in our CSV; None where it is none of ours."""
    where = f"{_WHERE}: column {name!r}"
    role, by_name = NAMES.get(plain(name), (plain(name).casefold(), None))
    if name in TIMES:
        return name
    if role not in ROLES:
        return None
    if unit is None and by_name is None:
        raise InputError(
            f"{where}: its unit is missing; name it {role}_{SI[kind(role)].replace('/', '_')}, or "
            'say it in attrs["units"]'
        )
    if unit is not None:
        known = spelled(str(unit)) or str(unit)
        to_si(role, known, where)
        if by_name not in (None, known):
            raise InputError(
                f'{where}: it is in {by_name} by its name, in {unit} by attrs["units"]'
            )
        by_name = known
    return f"{role}_{str(by_name).replace('/', '_')}"


def _time(table: DataFrame, times: dict[str, Any]) -> tuple[str, FloatArray]:
    """The time's name and values [s], of a column or of the index."""
    index = table.index
    called = str(table.index.name)
    if called in TIMES and called not in times:
        times[called] = index
    elif not times and (np.asarray(index).dtype.kind in "mM" or hasattr(index, "tz")):
        times["time_s"] = index
    if len(times) != 1:
        raise InputError(
            f"{_WHERE}: {'no column' if not times else 'more than one column'} is the time; name "
            "one time_s (or time_ms), or the index"
        )
    ((name, values),) = times.items()
    zoned = getattr(getattr(values, "dtype", None), "tz", None) is not None
    stamps = np.asarray(values, dtype="datetime64[ns]" if zoned else None)
    if stamps.dtype.kind == "M":
        stamps = stamps - stamps[:1]
    if stamps.dtype.kind == "m":
        return name, freeze(stamps / np.timedelta64(1, "ns") * 1e-9)
    return name, freeze(_numbers(values, name) * TIMES[name])


def _numbers(values: Any, name: str) -> FloatArray:
    try:
        return real_numbers(values)
    except ValueError as error:
        said = str(error).removeprefix("it ")
        raise InputError(f"{_WHERE}: column {name!r} {said}") from None
