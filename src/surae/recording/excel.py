"""Excel workbooks (.xlsx), read with openpyxl: each sheet that has a column of times is a table.

A sheet's names stand in the first row that has one of the time, behind any lines about the
recording; a row of units may follow. Formulas count by the values that were saved with them. Of
several such sheets the columns are called ``sheet: column``.
"""

import io
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from surae.errors import InputError
from surae.recording.delimited import is_time, time_column
from surae.recording.foreign import Parsed, foreign_table, optional, packed, printable, untrusted
from surae.recording.roles import NAMES
from surae.recording.source import Source
from surae.recording.table import Table
from surae.units import FACTORS, FloatArray, plain, spelled

_MAGIC, _INSIDE = b"PK\x03\x04", b"xl/workbook.xml"
#: Rows before the names of the columns; columns and rows of a sheet, Excel's own limit.
_LONGEST_PREFACE, _WIDEST, _LONGEST = 100, 1024, 2**20

_Row = tuple[Any, ...]


def recognises(source: Source) -> bool:
    """Whether it is a zip archive with a workbook in it."""
    return source.data.startswith(_MAGIC) and _INSIDE in source.data


def open_table(source: Source) -> Table:
    """Read the sheets that have a column of times."""
    return foreign_table(source, "Excel", "excel")


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """The columns of all such sheets."""
    openpyxl = optional("openpyxl", "Excel", shown)
    with untrusted(shown):
        book = openpyxl.load_workbook(io.BytesIO(data), read_only=True, data_only=True)
        tables = {}
        for sheet in book.worksheets:
            rows = list(_rows(sheet, shown))
            if (head := _header(rows)) is not None:
                tables[str(sheet.title)] = (head, rows)
        if not tables:
            raise InputError(
                f"{shown}: no sheet has a column of the time, such as time_s or Time (ms)"
            )
        several = len(tables) > 1
        return packed(
            [
                column
                for title, (head, rows) in tables.items()
                for column in _columns(
                    rows, head, f"{printable(title)}: " if several else "", shown
                )
            ]
        )


def _rows(sheet: Any, shown: str) -> Iterator[_Row]:
    """A sheet's rows, whatever size it states."""
    sheet.reset_dimensions()
    for number, row in enumerate(sheet.iter_rows(values_only=True), start=1):
        if len(row) > _WIDEST or number > _LONGEST:
            raise InputError(
                f"{shown}: row {number} with {len(row)} columns is beyond the {_LONGEST} rows and "
                f"{_WIDEST} columns that are read; keep those of the recording"
            )
        yield row


def _header(rows: Sequence[_Row]) -> int | None:
    """The row of the names: the first with one of the time and another."""
    for number, row in enumerate(rows[:_LONGEST_PREFACE]):
        names = [_text(cell) for cell in row]
        if any(map(is_time, names)) and sum(map(bool, names)) > 1:
            return number
    return None


def _columns(rows: Sequence[_Row], head: int, prefix: str, shown: str) -> Iterator[Parsed]:
    """The columns of one sheet, with the times beside them."""
    names = [_text(cell) for cell in rows[head]]
    body = list(rows[head + 1 :])
    units = [_text(cell).strip("[]()") for cell in body[0]] if body else []
    known = [spelled(unit) is not None for unit in units]
    first = head + 2
    if any(known) and not any(isinstance(cell, int | float) for cell in body[0]):
        body, first = body[1:], first + 1
    else:
        units = []
    while body and all(cell is None for cell in body[-1]):
        body.pop()
    name, factor = time_column([each for each in names if each], f"{shown}: row {head + 1}")
    place = names.index(name)
    if place < len(units):
        factor = FACTORS["time"].get(spelled(units[place]) or "", factor)
    time, wrong = _numbers(body, place, first)
    if wrong:
        raise InputError(f"{shown}: {prefix}column {name!r}, {wrong}")
    seconds = time * factor
    for index, column in enumerate(names):
        if not column or index == place:
            continue
        values, wrong = _numbers(body, index, first)
        unit = units[index] if index < len(units) else ""
        stated = NAMES.get(plain(column), ("", ""))[1]
        yield Parsed(
            name=prefix + printable(column),
            values=values,
            time=seconds,
            unit=unit or stated,
            refused=wrong,
            time_name=prefix + printable(name),
        )


def _numbers(body: Sequence[_Row], index: int, first: int) -> tuple[FloatArray, str]:
    """A column's cells, and what is wrong with the first that is no number."""
    values = np.full(len(body), np.nan)
    for number, row in enumerate(body):
        cell = row[index] if index < len(row) else None
        if isinstance(cell, bool) or not isinstance(cell, int | float):
            fault = "the cell is blank" if cell is None else f"{_text(cell)!r:.40} is not a number"
            return values, f"row {first + number}: {fault}"
        values[number] = cell
    return values, ""


def _text(cell: Any) -> str:
    return cell.strip() if isinstance(cell, str) else "" if cell is None else str(cell)
