"""The names of a text table's columns: which rows hold them, and what stands above the numbers."""

import csv
import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from surae.base.errors import InputError
from surae.base.formatting import check_known
from surae.base.units import FACTORS, spelled
from surae.recording.recording import EMG_KINDS
from surae.recording.rows import is_clock, split
from surae.recording.source import Source
from surae.recording.times import is_time

#: Separators, by preference where several could be it.
DELIMITERS = ("\t", ";", ",")
_NOTE = re.compile(r"#\s*(name|emg)\s*[:=]\s*(.*?)\s*")
#: What Excel writes first, or is told the separator by.
_SEPARATOR = re.compile(r"sep=.", re.IGNORECASE)
#: Lines before the names of the columns that a program may write about the recording.
_LONGEST_PREFACE = 100
#: Rows of numbers that show where the numbers begin; rows of names above them at most.
_SHOW = 3
_MOST_ROWS = 4
#: A sampling rate in a line above the names.
_RATE = re.compile(
    r"(?:(?P<word>sampl\w*[\s_-]*(?:rate|freq\w*|per second)|abtast(?:rate|freq\w*)"
    r"|bemonsteringsfreq\w*)"
    r"|sampl\w*|abtast\w*|\brate|frequen\w*|fr[eé]quen\w*|frecuencia|freq|cz[eę]stotliwo\w*)"
    r"(?:[^\d\n]{0,20}?[(\[](?P<before>k?hz)[)\]])?"
    r"[^\d\n]{0,40}?(?P<rate>\d+(?:[.,]\d+)?)\s*(?P<unit>k?hz|samples/s(?:ec)?|)\b",
    re.IGNORECASE,
)
#: Or the time from one sample to the next.
_INTERVAL = re.compile(
    r"(?:interval\w*|period\w*|abtastzeit|sampling time|\bdt\b|time step)"
    r"(?:[^\d\n]{0,20}?[(\[](?P<before>[^()\[\]\d]{1,12})[)\]])?"
    r"[^\d\n]{0,40}?(?P<step>\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)\s*(?P<unit>[^\W\d]{1,12}|)",
    re.IGNORECASE,
)


#: When a recording began, in a line above the names, to a second or finer.
_BEGAN = re.compile(
    r"(?:start|begin|began|begonnen|recorded|recording|acquisition|aufnahme|opname|enregistr"
    r"|d[eé]but|date|datum)[^\d\n]{0,30}"
    r"(?P<date>\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[.]\d{1,2}[.]\d{4})[ T,]{1,3}"
    r"(?P<time>\d{1,2}:\d{2}:\d{2}(?:[.,]\d{1,9})?)(?![\d:]| ?[AaPp][Mm])",
    re.IGNORECASE,
)
#: A unit of all columns in such a line, as BTS writes it.
_UNIT = re.compile(r"measure unit:\s*(\S{1,12})", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class TableHeading:
    """The names of the columns: last row before the numbers, and what stood before it."""

    row: int
    names: tuple[str, ...]
    delimiter: str | None  #: None for white space of any length.
    notes: Mapping[str, str]
    units: Mapping[str, str] = field(default_factory=dict)
    remark: str = ""  #: What a user should know of how the names were read.
    rate_hz: float = 0.0  #: What a line above the names says; 0 where none does.
    unit: str = ""  #: The unit of all columns, as a line above the names says.
    began: str = ""  #: The date and time of its first sample, as such a line says.


def heading_of(source: Source) -> TableHeading:
    """The heading of a text.

    It is the first line that is no comment, behind a preface the one with the time, or the one
    above the numbers. Text without any is refused.
    """
    notes: dict[str, str] = {}
    first: TableHeading | None = None
    for number, raw in enumerate(source.lines(), start=1):
        line = raw.strip(" \n")
        if line.lstrip().startswith("#"):
            if note := _NOTE.fullmatch(line.strip()):
                notes[note[1]] = _note(note[1], note[2], f"{source.shown}: row {number}")
            continue
        if not line.strip() or _SEPARATOR.fullmatch(line.strip()):
            continue
        delimiter = _delimiter(line, next(itertools.islice(source.lines(), number, None), ""))
        try:
            names = tuple(split(line, delimiter))
        except csv.Error as error:
            if first is not None:
                continue
            raise InputError(f"{source.shown}: row {number}: {error}") from None
        header = TableHeading(number, names, delimiter, notes)
        preface = any(numeric(name) or is_clock(name) for name in names)  # Time, 09:51:39
        if len(names) > 1 and any(map(is_time, names)) and not preface:
            return _whole(source, header)
        first = first or header
        if number > first.row + _LONGEST_PREFACE or all(numeric(name) for name in names):
            break
    if first is None:
        above = _above_numbers(source, notes)
        if above is None:
            raise InputError(f"{source.shown}: no header: every line is a comment")
        return above
    below = itertools.islice(source.lines(), first.row, first.row + _MOST_ROWS)
    rows = [_cells(line, first.delimiter) for line in below]
    numbers = [len(r) == len(first.names) and _is_numbers(r, first.delimiter) for r in rows]
    if len(first.names) > 1 and not all(map(numeric, first.names)) and any(numbers):
        return _whole(source, first)
    return _above_numbers(source, notes) or first


def numeric(cell: str) -> bool:
    """Whether a cell holds a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _delimiter(line: str, below: str) -> str | None:
    """What separates cells: what the row below has as often, else what is there most often."""
    alike = (d for d in DELIMITERS if d in line and line.count(d) == below.count(d))
    delimiter: str = next(alike, max(reversed(DELIMITERS), key=line.count))
    words = below.split()
    if delimiter not in line and len(line.split()) == len(words) > 1 and numeric(words[-1]):
        return None  # white space of any length
    return delimiter


def _cells(line: str, delimiter: str | None) -> list[str]:
    try:
        return split(line, delimiter)
    except csv.Error:
        return []


def _is_numbers(cells: Sequence[str], delimiter: str | None) -> bool:
    """Whether cells are a row of numbers, of which some may be blank or a clock's."""
    if len(cells) < 2:
        return False
    pointed = cells if delimiter == "," else [cell.replace(",", ".") for cell in cells]
    numbers = [numeric(cell) for cell in pointed]
    others = (c for c, is_number in zip(cells, numbers, strict=True) if not is_number)
    return any(numbers) and all(not c or is_clock(c) for c in others)


def _above_numbers(source: Source, notes: Mapping[str, str]) -> TableHeading | None:
    """The heading right above the first rows of numbers, which a comment may hold; or None."""
    lines = [line.rstrip("\n") for line in itertools.islice(source.lines(), _LONGEST_PREFACE * 4)]
    for delimiter in (*DELIMITERS, None):
        rows = [_cells(line, delimiter) for line in lines]
        for at in range(len(rows) - _SHOW + 1):
            block = rows[at : at + _SHOW]
            if len({len(row) for row in block}) > 1 or lines[at].lstrip().startswith("#"):
                continue
            if all(_is_numbers(row, delimiter) for row in block):
                heading = _names_above(lines, at, len(block[0]), delimiter, notes)
                return None if heading is None else _whole(source, heading)
    return None


def _names_above(
    lines: Sequence[str], at: int, count: int, delimiter: str | None, notes: Mapping[str, str]
) -> TableHeading | None:
    """The row of names above the numbers in line `at`, counted from 0."""
    for row in range(at - 1, max(at - 1 - _MOST_ROWS, -1), -1):
        line = lines[row].strip()
        bare = line.lstrip("#% ") if line.startswith(("#", "%")) else lines[row]
        if not bare.strip():
            continue
        for cut in (delimiter, *((r"\s{2,}",) if delimiter is None else ())):
            cells = re.split(cut, bare.strip()) if cut == r"\s{2,}" else _cells(bare, cut)
            if len(cells) == count and not any(map(numeric, cells)):
                known = [spelled(cell.strip("[]() ")) is not None for cell in cells if cell]
                if sum(known) > len(known) / 2 and row > 0:  # of units: names are above
                    above = _names_above(lines, row, count, delimiter, notes)
                    if above is not None:
                        units = {n: c for n, c in zip(above.names, cells, strict=True) if c}
                        return replace(above, row=at, units=units)
                return TableHeading(at, tuple(cells), delimiter, notes)
        return None
    return None


def _whole(source: Source, header: TableHeading) -> TableHeading:
    """The heading with further rows of names and of units below it, and a rate above it."""
    header = _with_rate(source, header)
    if header.units:
        return header
    for _ in range(_MOST_ROWS):
        lines = list(itertools.islice(source.lines(), header.row, header.row + 1))
        cells = _cells(lines[0] if lines else "", header.delimiter)
        same = len(cells) == len(header.names)
        pointed = cells if header.delimiter == "," else [c.replace(",", ".") for c in cells]
        if not same or any(map(numeric, pointed)) or any(map(is_clock, cells)) or not any(cells):
            break
        bare = [cell.strip("[]() ") for cell in cells]
        if any(spelled(cell) is not None for cell in bare):
            units = dict(zip(header.names, bare, strict=True))
            header = replace(header, row=header.row + 1, units=units)
            break
        if not _is_names(source, header.row + 1, header.delimiter):
            break
        header = replace(
            header,
            row=header.row + 1,
            names=_joined(header.names, cells),
            remark="two rows of names, read as one",
        )
    return _above_blank(source, header)


def _is_names(source: Source, row: int, delimiter: str | None) -> bool:
    """Whether below row `row`, after at most two more of text, numbers follow."""
    for line in itertools.islice(source.lines(), row, row + 3):
        if _is_numbers(_cells(line, delimiter), delimiter):
            return True
    return False


def _joined(above: Sequence[str], below: Sequence[str]) -> tuple[str, ...]:
    """Names of two rows as one; a row with its first cell alone names the first column."""
    if below[0] and not any(below[1:]):
        return (below[0], *above[1:])
    return tuple(
        " ".join(dict.fromkeys(filter(None, pair))) for pair in zip(above, below, strict=True)
    )


def _above_blank(source: Source, header: TableHeading) -> TableHeading:
    """Where a row names its first column alone, the rows above name the others."""
    if len(header.names) < 2 or any(header.names[1:]):
        return header
    lines = list(itertools.islice(source.lines(), header.row - 1))
    names = header.names
    for line in reversed(lines[-_MOST_ROWS + 1 :]):
        cells = _cells(line, header.delimiter)
        if len(cells) != len(names) or any(map(numeric, cells)):
            break
        names = (names[0], *_joined(cells[1:], names[1:]))
    return replace(header, names=names, remark="several rows of names, read as one")


def _with_rate(source: Source, header: TableHeading) -> TableHeading:
    """The heading with the sampling rate, and the unit of all, that lines above it state."""
    for line in itertools.islice(source.lines(), header.row - 1):
        if unit := _UNIT.match(line.strip()):
            header = replace(header, unit=unit[1])
        if 0.0 < (rate := rate_in(line)) < 1e7:
            header = replace(header, rate_hz=header.rate_hz or rate)
        header = replace(header, began=header.began or _began_in(line))
    return header


def _began_in(line: str) -> str:
    """The instant at which a line says that a recording began; empty where it says none."""
    if (match := _BEGAN.search(line)) is None:
        return ""
    parts = re.split(r"[-/.]", match["date"])
    year, month, day = parts if len(parts[0]) == 4 else reversed(parts)
    hour, _, behind = match["time"].replace(",", ".").partition(":")
    text = f"{year}-{month:0>2}-{day:0>2}T{hour:0>2}:{behind}"
    try:
        np.datetime64(text)
    except ValueError:
        return ""
    return text


def rate_in(line: str) -> float:
    """The sampling rate that a line states, itself or by its interval [Hz]; 0 where it does not."""
    if (match := _INTERVAL.search(line)) is not None:
        factor = FACTORS["time"].get(spelled(match["unit"] or match["before"] or "") or "", 0.0)
        step = float(match["step"].replace(",", ".")) * factor
        return 1.0 / step if step > 0.0 else 0.0
    match = _RATE.search(line)
    if match is None or not (match["word"] or match["unit"] or match["before"]):
        return 0.0
    kilo = (match["unit"] or match["before"] or "").lower() == "khz"
    return float(match["rate"].replace(",", ".")) * (1e3 if kilo else 1.0)


def _note(key: str, text: str, where: str) -> str:
    """The value that a comment sets."""
    text = text.strip("\"'")
    if key == "name":
        return text
    word = text.split()[0].casefold() if text.split() else ""
    check_known(f"{where}: emg", EMG_KINDS, word)
    return word
