"""OpenSim .sto and .mot: ``key=value`` header until ``endheader``, names, numbers."""

from collections.abc import Mapping, Sequence

from surae.base.errors import InputError
from surae.recording.rows import Rows
from surae.recording.source import Source
from surae.recording.table import Column, Table, some

_END = "endheader"
_EMG = ("raw", "envelope")

#: Units of the rotational columns, by the header's ``inDegrees``.
_UNITS = {
    "yes": {"angle": "deg", "angular_velocity": "deg/s", "angular_acceleration": "deg/s2"},
    "no": {"angle": "rad", "angular_velocity": "rad/s", "angular_acceleration": "rad/s2"},
}


def recognises(source: Source) -> bool:
    """Whether one of its first lines ends an OpenSim header."""
    return any(line.strip().casefold() == _END for line in source.head())


def open_table(source: Source) -> Table:
    """Read the header: it must name its columns and a time, its ``inDegrees`` be yes or no."""
    source.require_text()
    units: Mapping[str, str] = {}
    notes: dict[str, str] = {}
    lines = enumerate(source.lines(), start=1)
    for number, line in lines:
        if line.strip().casefold() == _END:
            break
        key, _, value = (part.strip() for part in line.partition("="))
        if key.casefold() == "indegrees":
            if value.casefold() not in _UNITS:
                raise InputError(
                    f"{source.shown}: row {number}: inDegrees is {value!r}; use yes or no"
                )
            units = _UNITS[value.casefold()]
        elif key == "emg" and value in _EMG:  # as files of surae say
            notes["emg"] = value
    header, line = next(((number, line) for number, line in lines if line.strip()), (0, ""))
    # Names may hold spaces where tabs separate them.
    names = tuple(map(str.strip, line.strip().split("\t"))) if "\t" in line else (*line.split(),)
    time = next((name for name in names if name.casefold() == "time"), None)
    if time is None:
        raise InputError(
            f"{source.shown}: no column 'time' after {_END}; columns found: {some(names)}"
        )
    rows = Rows(source=source, header=header, names=names, delimiter=None)

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        return rows.columns(wanted, time, 1.0)

    others = tuple(name for name in names if name and name != time)
    return Table(source.shown, "OpenSim", others, time, load, units_of_kind=units, notes=notes)
