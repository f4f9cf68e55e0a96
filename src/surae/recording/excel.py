"""Excel workbooks (.xlsx), read with openpyxl: a sheet with a column of times is read as CSV is.

Formulas count by the values that were saved with them. Of several such sheets the columns are
called ``sheet: column``.
"""

import io
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.recording import delimited
from surae.recording.foreign import in_child, optional, untrusted
from surae.recording.source import Source
from surae.recording.table import Column, Table

_MAGIC, _INSIDE = b"PK\x03\x04", b"xl/workbook.xml"
#: Columns and rows of a sheet, Excel's own limit.
_WIDEST, _LONGEST = 1024, 2**20


def recognises(source: Source) -> bool:
    """Whether it is a zip archive with a workbook in it."""
    return source.data.startswith(_MAGIC) and _INSIDE in source.data


def open_table(source: Source) -> Table:
    """Read the sheets that have a column of times."""
    tables: dict[str, Table] = {}
    errors = []
    for title, text in in_child(source, "Excel", "excel")["sheets"].items():
        try:
            tables[title] = delimited.open_table(replace(source, data=text.encode()))
        except InputError as error:
            errors.append(error)
    if not tables:
        raise errors[0]
    prefix = {title: f"{title}: " if len(tables) > 1 else "" for title in tables}
    places = {
        prefix[t] + name: (table, name) for t, table in tables.items() for name in table.names
    }

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        loaded: dict[str, Column] = {}
        for table in tables.values():
            own = {name: places[name][1] for name in wanted if places[name][0] is table}
            columns = table.load([*own.values()])
            loaded |= {name: replace(columns[its], name=name) for name, its in own.items()}
        return loaded

    units = {name: table.units.get(its, "") for name, (table, its) in places.items()}
    return Table(source.shown, "Excel", tuple(places), "time", load, units)


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """The text of every sheet, its cells separated by tabs."""
    openpyxl = optional("openpyxl", "Excel", shown)
    with untrusted(shown):
        book = openpyxl.load_workbook(io.BytesIO(data), read_only=True, data_only=True)
        sheets = {cleaned(str(sheet.title)): _text(sheet, shown) for sheet in book.worksheets}
        return {"sheets": sheets}


def _text(sheet: Any, shown: str) -> str:
    """A sheet's rows, whatever size it states, as lines of equally many cells."""
    sheet.reset_dimensions()
    lines = []
    for number, row in enumerate(sheet.iter_rows(values_only=True), start=1):
        if len(row) > _WIDEST or number > _LONGEST:
            raise InputError(
                f"{shown}: row {number} with {len(row)} columns is beyond the {_LONGEST} rows and "
                f"{_WIDEST} columns that are read; keep those of the recording"
            )
        cells = ("" if cell is None else " ".join(str(cell).split()) for cell in row)
        lines.append("\t".join(cells).rstrip("\t"))
    width = max((line.count("\t") for line in lines), default=0)
    whole = (line and line + "\t" * (width - line.count("\t")) for line in lines)
    return "".join(f"{line}\n" for line in whole)
