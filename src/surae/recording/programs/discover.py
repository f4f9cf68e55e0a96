"""Delsys Trigno Discover's CSV: sensors, names, rates, periods, then pairs of times and samples.

Each sensor has its own row of names; of each signal the column before it holds the times. Slower
signals have fewer rows: their cells end blank.
"""

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from surae.base.errors import InputError
from surae.recording.programs.trigno import Signal, columns_of
from surae.recording.roles import heading_unit
from surae.recording.rows import split
from surae.recording.source import Source
from surae.recording.table import Column, Table

_TIME = re.compile(r".*Time Series \(s\)")
_PROGRAM = re.compile(r'"?Application:"?,.*Trigno Discover', re.IGNORECASE)
#: The row of names stands among the first.
_LATEST = 60


def recognises(source: Source) -> bool:
    """Whether it names the program, or has columns ``… Time Series (s)``."""
    head = source.head()[:_LATEST]
    named = any(_PROGRAM.match(line) for line in head[:5])
    return any("Time Series (s)" in line and "," in line for line in head) and (
        named or any(_TIME.fullmatch(cell.strip(' "')) for line in head for cell in line.split(","))
    )


def open_table(source: Source) -> Table:
    """Read the rows above the numbers: columns must be pairs of times and samples."""
    source.require_text()
    rows = []
    for number, line in enumerate(source.lines(), start=1):
        try:
            rows.append(split(line, ","))
        except csv.Error as error:
            raise InputError(f"{source.shown}: row {number}: {error}") from None
        if number == _LATEST:
            break
    at = next((k for k, row in enumerate(rows) if any(map(_TIME.fullmatch, row))), None)
    if at is None:
        raise InputError(f"{source.shown}: no row with the names of columns (… Time Series (s), …)")
    header = next((k for k in range(at + 1, len(rows)) if _is_number(rows[k][0])), len(rows))
    sensors = next((row for row in reversed(rows[:at]) if not _modes(row)), [])
    signals = _signals(rows[at], sensors, f"{source.shown}: row {at + 1}")
    by_name = {signal.name: signal for signal in reversed(signals)}

    seconds = _length(rows[:at])

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        loaded = columns_of(source, header, [by_name[name] for name in wanted])
        return {name: _whole(column, seconds) for name, column in loaded.items()}

    names = tuple(signal.name for signal in signals)
    units = {signal.name: signal.unit for signal in signals if signal.unit}
    return Table(source.shown, "Trigno Discover", names, "time", load, units)


def _length(rows: Sequence[Sequence[str]]) -> float:
    """How long the recording is, as the lines above say [s]; 0 where they do not."""
    for row in rows:
        if len(row) > 1 and row[0].startswith("Collection Length") and _is_number(row[1]):
            return float(row[1])
    return 0.0


def _whole(column: Column, seconds: float) -> Column:
    """A column that says where it ends before the recording did."""
    time = column.time
    if len(time) < 2 or not time[-1] + 3.0 * (time[-1] - time[-2]) < seconds:
        return column
    said = f"the header states {seconds:g} s, the file holds {time[-1]:.4g} s: it was cut short"
    return replace(column, remark=said)


def _signals(names: Sequence[str], sensors: Sequence[str], where: str) -> list[Signal]:
    """The signals that a row of names lists, under the names of their sensors."""
    signals = []
    sensor = ""
    for column, name in enumerate(names):
        if column < len(sensors) and sensors[column]:
            sensor = sensors[column]
        if not name or _TIME.fullmatch(name):
            continue
        if column == 0 or not _TIME.fullmatch(names[column - 1]):
            raise InputError(f"{where}: column {column + 1}, {name!r}, has no times before it")
        full = f"{sensor}: {name}" if sensor else name
        signals.append(Signal(full, column, heading_unit(name) or "", None))
    if not signals:
        raise InputError(f"{where}: no signal is there beside times")
    return signals


def _modes(row: Sequence[str]) -> bool:
    """Whether a row says the modes of sensors, or nothing."""
    said = [cell for cell in row if cell]
    return not said or all("mode" in cell.casefold() for cell in said)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
