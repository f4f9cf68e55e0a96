"""OpenSim .sto and .mot: ``key=value`` header until ``endheader``, names, numbers."""

import re
from collections.abc import Mapping, Sequence

from surae.base.errors import InputError
from surae.recording.recording import EMG_KINDS
from surae.recording.rows import Rows
from surae.recording.source import Source
from surae.recording.table import Column, Table, some

_END = "endheader"
_ROWS = re.compile(r"(?:nRows|datarows)\s*[= ]\s*(\d{1,12})", re.IGNORECASE)

#: Units of the rotational columns, by the header's ``inDegrees``.
_UNITS = {
    "yes": {"angle": "deg", "angular_velocity": "deg/s", "angular_acceleration": "deg/s2"},
    "no": {"angle": "rad", "angular_velocity": "rad/s", "angular_acceleration": "rad/s2"},
}


def recognises(source: Source) -> bool:
    """Whether one of its first lines ends an OpenSim header."""
    return any(_plain(line).casefold() == _END for line in source.head())


def _plain(line: str) -> str:
    """A line of the header without the separators that spreadsheets leave behind its last cell."""
    return line.strip(", \t\r\n;")


def open_table(source: Source) -> Table:
    """Read the header: it must name its columns and a time, its ``inDegrees`` be yes or no."""
    source.require_text()
    units: Mapping[str, str] = {}
    notes: dict[str, str] = {}
    stated: int | None = None
    lines = enumerate(source.lines(), start=1)
    for number, line in lines:
        line = _plain(line)  # noqa: PLW2901
        if line.casefold() == _END:
            break
        key, _, value = (part.strip() for part in line.partition("="))
        if (rows := _ROWS.fullmatch(line)) is not None:  # SIMM's older header has no "="
            stated = int(rows[1])
        if key.casefold() == "indegrees":
            if value.casefold() not in _UNITS:
                raise InputError(
                    f"{source.shown}: row {number}: inDegrees is {value!r}; use yes or no"
                )
            units = _UNITS[value.casefold()]
        elif key == "emg" and value in EMG_KINDS:  # as files of surae say
            notes["emg"] = value
    header, line = next(((number, line) for number, line in lines if line.strip()), (0, ""))
    # Names may hold spaces where tabs separate them.
    delimiter = next((each for each in ("\t", ",", ";") if each in line), None)
    names = tuple(map(str.strip, line.strip().split(delimiter)))
    delimiter = None if delimiter == "\t" else delimiter
    time = next((name for name in names if name.casefold() == "time"), None)
    if time is None:
        raise InputError(
            f"{source.shown}: no column 'time' after {_END}; columns found: {some(names)}"
        )
    table = Rows(source=source, header=header, names=names, delimiter=delimiter)
    held = sum(1 for _, line in lines if line.strip())
    remark = ""
    if stated is not None and held != stated:
        short = ": it was cut short" if held < stated else ""
        remark = f"the header states {stated} rows, the file holds {held}{short}"

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        return table.columns(wanted, time, 1.0)

    others = tuple(name for name in names if name and name != time)
    return Table(
        source.shown,
        "OpenSim",
        others,
        time,
        load,
        units_of_kind=units,
        notes=notes,
        remarks=dict.fromkeys(others, remark) if remark else {},
    )
