"""CSV: a header row that names the columns, then numbers; ``#`` lines are comments."""

import csv
import re
from collections.abc import Mapping, Sequence

from surae.errors import InputError
from surae.recording.naming import NAMES, TIMES, plain
from surae.recording.rows import Rows, split
from surae.recording.source import Source
from surae.recording.table import Column, Table, some

#: Separators, by preference where the header has as many of several.
DELIMITERS = (",", ";", "\t")

_NOTE = re.compile(r"#\s*(name|emg)\s*[:=]\s*(.*?)\s*")
_EMG = ("raw", "envelope")

#: Names of the time in files that are described by a mapping, beside our own.
_OTHER_TIME = re.compile(r"(?:time|t)(?:[ _]*[\[(]?(s|sec|seconds|ms)[\])]?)?", re.IGNORECASE)


def recognises(source: Source) -> bool:
    """Whether to read it as CSV: yes, what no other format claims."""
    del source
    return True


def open_table(source: Source) -> Table:
    """Read the header of a CSV file.

    Raises
    ------
    InputError
        It is no text, has no header, no time, or a comment sets what isn't known.
    """
    source.require_text()
    header, names, delimiter, notes = _header(source)
    where = f"{source.shown}: row {header}"
    if all(_numeric(name) for name in names):
        raise InputError(
            f"{where}: numbers where the names of the columns belong; the first line that is no "
            "comment must name them (time_s, angle_rad, ...)"
        )
    time, factor = _time(names, where)
    rows = Rows(source=source, header=header, names=names, delimiter=delimiter)

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        return rows.columns(wanted, time, factor)

    others = tuple(name for name in names if name and name != time)
    return Table(
        file=source.shown,
        format="CSV",
        names=others,
        time_name=time,
        load=load,
        units={name: NAMES[plain(name)][1] for name in others if plain(name) in NAMES},
        notes=notes,
        header=header,
    )


def _header(source: Source) -> tuple[int, tuple[str, ...], str, dict[str, str]]:
    """Row and names of the header, the delimiter, and what comments before it set."""
    notes: dict[str, str] = {}
    for number, raw in enumerate(source.lines(), start=1):
        line = raw.strip(" \n")
        if line.lstrip().startswith("#"):
            if note := _NOTE.fullmatch(line.strip()):
                notes[note[1]] = _note(note[1], note[2], f"{source.shown}: row {number}")
        elif line.strip():
            delimiter = max(DELIMITERS, key=line.count)
            try:
                return number, tuple(split(line, delimiter)), delimiter, notes
            except csv.Error as error:
                raise InputError(f"{source.shown}: row {number}: {error}") from None
    raise InputError(f"{source.shown}: no header: every line is a comment")


def _note(key: str, text: str, where: str) -> str:
    """The value that a comment sets."""
    text = text.strip("\"'")
    if key == "name":
        return text
    word = text.split()[0].casefold() if text.split() else ""
    if word not in _EMG:
        raise InputError(f"{where}: emg is {text!r}; use one of: {', '.join(_EMG)}")
    return word


def _time(names: Sequence[str], where: str) -> tuple[str, float]:
    """Name of the time's column and its factor to seconds."""
    ours = [name for name in names if name in TIMES]
    others = {name: match for name in names if (match := _OTHER_TIME.fullmatch(name))}
    candidates = ours or [name for name in names if name in others]
    if len(candidates) > 1:
        raise InputError(f"{where}: columns {some(candidates)} are all the time; keep one")
    if candidates:
        name = candidates[0]
        unit = (others[name][1] or "s").casefold() if name in others else "s"
        return name, TIMES["time_ms" if unit == "ms" else "time_s"]
    for name in names:
        if name.startswith("time_"):
            raise InputError(
                f"{where}, column {name!r}: unit {name[5:]!r} is not known for time; "
                f"use {' or '.join(TIMES)}"
            )
    raise InputError(
        f"{where}: missing column time_s (or time_ms); columns found: {some(names)}; a recording "
        "is a CSV with such columns, or a TOML mapping of other files"
    )


def _numeric(cell: str) -> bool:
    """Whether a cell holds a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True
