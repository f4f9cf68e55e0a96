"""CSV: a header row that names the columns, then numbers; ``#`` lines are comments.

Columns are separated by commas, semicolons or tabs; where it is no comma, numbers may have a
decimal one. A block of lines about the recording may come before the names, and a row of units
after them, as programs such as Noraxon's export them.
"""

import csv
import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from surae.base.errors import InputError
from surae.base.formatting import check_known
from surae.base.units import FACTORS, plain, spelled
from surae.recording.recording import EMG_KINDS
from surae.recording.roles import NAMES, TIMES
from surae.recording.rows import Rows, is_clock, split
from surae.recording.source import Source
from surae.recording.table import Column, Table, some

#: Separators, by preference where several could be it.
DELIMITERS = ("\t", ";", ",")

_NOTE = re.compile(r"#\s*(name|emg)\s*[:=]\s*(.*?)\s*")

#: Names of the time in files that are described by a mapping, beside our own.
_TIME = (
    r"(?:time ?stamps?|(?:elapsed |unix |relative )?time|times|zeit|uhrzeit|tijd|temps|tiempo|tempo"
    r"|clock|time of day|date ?[/&]?(?:and )? ?time)"
)
_OTHER_TIME = re.compile(rf"(?:{_TIME}|t)[^\w%]*_*(%|\w*)[\W_]*", re.IGNORECASE)
_TIME_IN = re.compile(rf"{_TIME}\s*[(\[]\s*([^()\[\]]{{1,20}}?)\s*[)\]]", re.IGNORECASE)
#: What a movement was stretched to, in place of a time.
_PART = r"(?:cycle|gait|stance|swing|stride|step|movement|phase|normali[sz]ed|time)"
_PERCENT = re.compile(
    rf"%|normali[sz]ed[ _]time|.*(?:%|percent).*{_PART}.*|.*{_PART}.*(?:%|percent).*", re.IGNORECASE
)
#: What Excel writes first, or is told the separator by.
_SEPARATOR = re.compile(r"sep=.", re.IGNORECASE)
#: Lines before the names of the columns that a program may write about the recording.
_LONGEST_PREFACE = 100
#: Where numbers begin, so many bytes show how they are written.
_LOOKED_AT = 2**20
_CELL = rb"(?:^|[;\t])[ \"]*[+-]?\d*%s\d+(?:[eE][+-]?\d+)?[ \"]*(?=[;\t\r\n]|$)"
_WITH_COMMA = re.compile(_CELL % rb",", re.MULTILINE)
_WITH_POINT = re.compile(_CELL % rb"\.", re.MULTILINE)


def open_table(source: Source) -> Table:
    """Read the header of a CSV file.

    Text with no header, or a comment that sets what isn't known, is refused.
    """
    source.require_text()
    head = _header(source)
    where = f"{source.shown}: row {head.row}"
    if all(_numeric(name) for name in head.names):
        raise InputError(
            f"{where}: numbers where the names of the columns belong; the first line that is no "
            "comment must name them (time_s, angle_rad, ...)"
        )
    time, factor = time_column(head.names, where)
    if unit := head.units.get(time):
        factor = _seconds(unit, time, where)
    decimal = "."
    if head.delimiter != ",":
        body = "".join(itertools.islice(source.lines(), head.row, head.row + 1000)).encode()
        body = body[:_LOOKED_AT]
        if _WITH_COMMA.search(body) and not _WITH_POINT.search(body):
            decimal = ","
    first = next(itertools.islice(source.lines(), head.row, None), "")
    clock = None
    names = head.names
    cells = split(first, head.delimiter)
    if len(cells) == len(names) + 1 and not cells[-1]:  # every row ends with a separator
        names = (*names, "")
    if time and len(cells) == len(names):
        at = names.index(time)
        clock = at if is_clock(cells[at]) else None
    rows = Rows(source, head.row, names, head.delimiter, decimal, clock)

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        return rows.columns(wanted, time, factor)

    others = tuple(name for name in head.names if name and name != time)
    ours = {name: NAMES[plain(name)][1] for name in others if plain(name) in NAMES}
    units = {name: head.units[name] for name in others if head.units.get(name)} | ours
    return Table(source.shown, "CSV", others, time, load, units, notes=head.notes, header=head.row)


@dataclass(frozen=True, slots=True)
class _Header:
    """The names of the columns: last row before the numbers, and what stood before it."""

    row: int
    names: tuple[str, ...]
    delimiter: str | None  #: None for white space of any length.
    notes: Mapping[str, str]
    units: Mapping[str, str] = field(default_factory=dict)


def _header(source: Source) -> _Header:
    """The header: the first line that is no comment, or behind a preface the one with the time."""
    notes: dict[str, str] = {}
    first: _Header | None = None
    for number, raw in enumerate(source.lines(), start=1):
        line = raw.strip(" \n")
        if line.lstrip().startswith("#"):
            if note := _NOTE.fullmatch(line.strip()):
                notes[note[1]] = _note(note[1], note[2], f"{source.shown}: row {number}")
            continue
        if not line.strip() or _SEPARATOR.fullmatch(line.strip()):
            continue
        # What the row below has as often separates the cells, else what is there most often.
        below = next(itertools.islice(source.lines(), number, None), "")
        alike = (d for d in DELIMITERS if d in line and line.count(d) == below.count(d))
        delimiter: str | None = next(alike, max(reversed(DELIMITERS), key=line.count))
        words = below.split()
        if (
            str(delimiter) not in line
            and len(line.split()) == len(words) > 1
            and _numeric(words[-1])
        ):
            delimiter = None  # white space of any length
        try:
            names = tuple(split(line, delimiter))
        except csv.Error as error:
            if first is not None:
                continue
            raise InputError(f"{source.shown}: row {number}: {error}") from None
        header = _Header(number, names, delimiter, notes)
        preface = any(_numeric(name) or is_clock(name) for name in names)  # Time, 09:51:39
        if len(names) > 1 and any(map(is_time, names)) and not preface:
            return _with_units(source, header)
        first = first or header
        if number > first.row + _LONGEST_PREFACE or all(_numeric(name) for name in names):
            break
    if first is None:
        raise InputError(f"{source.shown}: no header: every line is a comment")
    return first


def _with_units(source: Source, header: _Header) -> _Header:
    """The header with a row of units below it, where there is one."""
    below = next(itertools.islice(source.lines(), header.row, None), "")
    try:
        cells = [cell.strip("[]() ") for cell in split(below, header.delimiter)]
    except csv.Error:
        return header
    known = [spelled(cell) is not None for cell in cells]
    if len(cells) != len(header.names) or not any(known) or any(map(_numeric, cells)):
        return header
    return replace(header, row=header.row + 1, units=dict(zip(header.names, cells, strict=True)))


def _note(key: str, text: str, where: str) -> str:
    """The value that a comment sets."""
    text = text.strip("\"'")
    if key == "name":
        return text
    word = text.split()[0].casefold() if text.split() else ""
    check_known(f"{where}: emg", EMG_KINDS, word)
    return word


def is_time(name: str) -> bool:
    """Whether a column's name is one of the time."""
    match = _OTHER_TIME.fullmatch(name.strip())
    return match is not None and (not match[1] or spelled(match[1]) in FACTORS["time"])


def _seconds(unit: str, name: str, where: str) -> float:
    """Factor from a unit of the time to seconds."""
    known = FACTORS["time"].get(spelled(unit) or "")
    if known is None:
        percent = " (a movement in percent has no speed)" * ("%" in unit or "percent" in unit)
        raise InputError(
            f"{where}, column {name!r}: unit {unit!r} is not known for time{percent}; use "
            f"{' or '.join(TIMES)}"
        )
    return known


def time_column(names: Sequence[str], where: str) -> tuple[str, float]:
    """Name of the time's column and its factor to seconds."""
    candidates = [name for name in names if name in TIMES] or [n for n in names if is_time(n)]
    if len(candidates) > 1:
        raise InputError(f"{where}: columns {some(candidates)} are all the time; keep one")
    if candidates:
        match = _OTHER_TIME.fullmatch(candidates[0].strip())
        return candidates[0], FACTORS["time"][spelled(match[1] if match else "") or "s"]
    for name in names:
        if name.startswith("time_"):
            _seconds(name[5:], name, where)
        if (match := _TIME_IN.fullmatch(name.strip())) is not None:
            _seconds(match[1], name, where)
    if names and _PERCENT.fullmatch(names[0].strip()):
        _seconds("%", names[0], where)
    return "", 1.0


def _numeric(cell: str) -> bool:
    """Whether a cell holds a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True
