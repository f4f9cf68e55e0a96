"""Workbooks of Excel (.xlsx, .xls) and OpenDocument, read with calamine as CSV is.

Formulas count by the values that were saved with them. Where sheets have a column of times, only
these are read; of several sheets the columns are called ``sheet: column``.
"""

import datetime
import io
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from surae.base.errors import InputError
from surae.recording import delimited
from surae.recording.programs.foreign import in_child, optional
from surae.recording.source import Source
from surae.recording.table import Column, Table
from surae.recording.untrusted import untrusted

_MAGIC = b"PK\x03\x04"
_INSIDE = (b"xl/workbook.", b"opendocument.spreadsheet")
#: Workbooks before 2007: an OLE file with a stream of this name.
_OLE = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_STREAM = "Workbook".encode("utf-16-le")
#: Sheets; columns and rows of one, Excel's own limit.
_MOST = 200
_WIDEST = 1024
_LONGEST = 2**20


def recognises(source: Source) -> bool:
    """Whether it is an archive with a workbook in it."""
    if source.data.startswith(_OLE):
        return _STREAM in source.data
    return source.data.startswith(_MAGIC) and any(name in source.data for name in _INSIDE)


def open_table(source: Source) -> Table:
    """Read the sheets that have a column of times, or where none has, all that name columns."""
    tables: dict[str, Table] = {}
    errors = []
    for title, text in in_child(source, "Excel", __name__)["sheets"].items():
        try:
            tables[title] = delimited.open_table(replace(source, data=text.encode()))
        except InputError as error:
            errors.append(error)
    if not tables:
        raise errors[0] if errors else InputError(f"{source.shown}: no sheet has anything in it")
    tables = {title: table for title, table in tables.items() if table.time_name} or tables
    prefix = {title: f"{title}: " if len(tables) > 1 else "" for title in tables}
    places = {
        prefix[t] + name: (table, name) for t, table in tables.items() for name in table.names
    }

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        loaded: dict[str, Column] = {}
        for table in tables.values():
            names = {name: places[name][1] for name in wanted if places[name][0] is table}
            columns = table.load([*names.values()])
            loaded |= {name: replace(columns[its], name=name) for name, its in names.items()}
        return loaded

    units = {name: table.units.get(its, "") for name, (table, its) in places.items()}
    time = "time" if any(table.time_name for table in tables.values()) else ""
    return Table(source.shown, "Excel", tuple(places), time, load, units)


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """The text of every sheet, its cells separated by tabs."""
    calamine = optional("python_calamine", "Excel", shown)
    with untrusted(shown):
        book = calamine.CalamineWorkbook.from_filelike(io.BytesIO(data))
        if len(book.sheet_names) > _MOST:
            raise InputError(
                f"{shown}: {len(book.sheet_names)} sheets, more than the {_MOST} that are read; "
                "keep those of the recording"
            )
        return {
            "sheets": {
                name: _text(book.get_sheet_by_name(name), shown) for name in book.sheet_names
            }
        }


def _text(sheet: Any, shown: str) -> str:
    """A sheet's rows as lines of equally many cells."""
    if sheet.width > _WIDEST or sheet.total_height > _LONGEST:
        raise InputError(
            f"{shown}: {sheet.total_height} rows with {sheet.width} columns are beyond the "
            f"{_LONGEST} rows and {_WIDEST} columns that are read; keep those of the recording"
        )
    lines = ("\t".join(map(_cell, row)) for row in sheet.to_python(skip_empty_area=True))
    return "".join(f"{line}\n" if line.strip() else "\n" for line in lines)


def _cell(cell: object) -> str:
    """A cell's text; times of day and durations as a clock shows them."""
    if isinstance(cell, datetime.timedelta):
        return repr(cell.total_seconds())
    return " ".join(str(cell).split())
