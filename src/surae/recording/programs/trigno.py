"""Delsys Trigno, as EMGworks exports it to CSV: every signal has a column of times of its own.

Lines ``Label: name Sampling frequency: … Number of points: … Unit: …`` come first, then the names
(``X[s]`` for times), then the numbers. Slower signals have fewer rows: their cells end blank.
"""

import csv
import re
from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import freeze
from surae.recording.rows import as_number, split
from surae.recording.source import Source
from surae.recording.table import Column, Table, in_row

_TIME = re.compile(r'"?X ?\[s\]"?')
_LABEL = re.compile(
    r"Label: (?P<name>.+?) Sampling frequency: \S+ Number of points: (?P<points>\d{1,12}) "
    r"start: \S+ Unit: (?P<unit>.*?) Domain Unit: (?P<domain>.*)"
)


@dataclass(frozen=True, slots=True)
class Signal:
    """One signal: its column, behind that of its times."""

    name: str
    column: int
    unit: str
    points: int | None


def recognises(source: Source) -> bool:
    """Whether it has Trigno's header, or begins with names of which the first is ``X[s]``."""
    head = source.head()
    if head and _LABEL.fullmatch(head[0].strip()):
        return True
    first = next((line for line in head if line.strip()), "")
    return bool(_TIME.match(first))


def open_table(source: Source) -> Table:
    """Read the header: columns must be pairs of times and samples."""
    source.require_text()
    labels: dict[str, re.Match[str]] = {}
    header = 0
    cells = [""]
    for row, line in enumerate(source.lines(), start=1):
        if label := _LABEL.fullmatch(line.strip()):
            labels.setdefault(label["name"].strip(), label)
        elif _TIME.match(line.strip()):
            header = row
            try:
                cells = split(line, ",")
            except csv.Error as error:
                raise InputError(f"{source.shown}: row {row}: {error}") from None
            break
    if not header:
        raise InputError(f"{source.shown}: no row with the names of columns (X[s], ...)")
    signals = _signals(cells, labels, f"{source.shown}: row {header}")
    by_name = {signal.name: signal for signal in reversed(signals)}
    rows = source.data.count(b"\n") - header
    remarks = {
        signal.name: f"cut short: the header states {signal.points} samples, the file has {rows} "
        "rows"
        for signal in signals
        if signal.points is not None and signal.points > rows
    }

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        return columns_of(source, header, [by_name[name] for name in wanted])

    names = tuple(signal.name for signal in signals)
    units = {signal.name: signal.unit for signal in signals if signal.unit}
    return Table(source.shown, "Trigno", names, cells[0], load, units, remarks=remarks)


def _signals(cells: Sequence[str], labels: Mapping[str, re.Match[str]], where: str) -> list[Signal]:
    """The signals that a row of names lists."""
    while cells and not cells[-1]:
        cells = cells[:-1]
    signals = []
    for column, name in enumerate(cells):
        if _TIME.fullmatch(name) and column % 2 == 0:
            continue
        if column % 2 == 0 or not name or _TIME.fullmatch(name):
            raise InputError(
                f"{where}: column {column + 1} is {name!r}; expected a column X[s] of times "
                "before every signal"
            )
        label = labels.get(name)
        if label is not None and label["domain"].strip() != "s":
            raise InputError(f"{where}: {name!r} is a function of {label['domain']!r}, not of time")
        unit, points = (label["unit"].strip(), int(label["points"])) if label else ("", None)
        signals.append(Signal(name, column, unit, points))
    if not signals or len(cells) % 2:
        raise InputError(f"{where}: expected pairs of columns, X[s] and a signal")
    return signals


def columns_of(source: Source, header: int, wanted: Sequence[Signal]) -> dict[str, Column]:
    """Times and samples of the wanted signals."""
    pairs = {signal: (array("d"), array("d")) for signal in wanted}
    spans: dict[Signal, tuple[int, int]] = {}  # first and last row
    for row, cells in _rows(source, header):
        for signal, pair in pairs.items():
            pair_cells = cells[signal.column - 1 : signal.column + 1]
            if not any(pair_cells):
                continue
            where = f"{source.shown}: column {signal.name!r}, row {row}"
            if len(pair_cells) < 2:
                raise InputError(f"{where}: the sample is missing")
            first, last = spans.get(signal, (row, row - 1))
            if last != row - 1:
                raise InputError(f"{where}: samples follow after blank cells")
            try:
                for values, cell in zip(pair, pair_cells, strict=True):
                    values.append(as_number(cell))
            except ValueError as error:
                raise InputError(f"{where}: {error}") from None
            spans[signal] = first, row
    columns = {}
    for signal, pair in pairs.items():
        times, samples = (freeze(np.array(values, dtype=np.float64)) for values in pair)
        first = spans.get(signal, (header + 1, 0))[0]
        at = in_row(range(first, first + len(samples)))
        columns[signal.name] = Column(signal.name, times, samples, "X[s]", at)
    return columns


def _rows(source: Source, header: int) -> Iterator[tuple[int, list[str]]]:
    """Row numbers and cells below the names; a last row that was cut off is left out."""
    for row, line in enumerate(source.lines(), start=1):
        if row <= header or not line.strip() or not line.endswith("\n"):
            continue
        try:
            yield row, split(line, ",")
        except csv.Error as error:
            raise InputError(f"{source.shown}: row {row}: {error}") from None
