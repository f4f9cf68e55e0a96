"""CSV of Vicon Nexus: sections of devices, model outputs and trajectories, each with its rate.

A section has five lines: its title, its rate, the devices (over the first of their columns), the
columns, their units; then its samples, counted by ``Frame`` and ``Sub Frame``, until a blank line.
Frame 1, sub frame 0 is time 0.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.recording.rows import Rows, split
from surae.recording.source import Source
from surae.recording.table import Column, Table, in_row, instants

_TITLES = ("Devices", "Model Outputs", "Trajectories", "Joints", "Segments")
_FRAME = ("Frame", "Sub Frame")
_DELIMITERS = ("\t", ";", ",")
_AROUND = ', \t\r\n;"'
#: Samples that are looked at for how decimals begin.
_LOOKED_AT = 100


@dataclass(frozen=True, slots=True)
class _Section:
    """A section of the file."""

    title: str
    row: int  #: Row of its columns' names.
    rate_hz: float
    names: tuple[str, ...]
    units: tuple[str, ...]
    rows: Rows


def recognises(source: Source) -> bool:
    """Whether it has a section's title, a rate, and Frame and Sub Frame three lines below."""
    return next(_begins(source.head()), None) is not None


def _begins(lines: Sequence[str]) -> Iterator[int]:
    """Where sections begin, counted from 0."""
    for at, line in enumerate(lines):
        if line.strip(_AROUND) in _TITLES and at + 3 < len(lines):
            head = lines[at + 3]
            delimiter = next((each for each in _DELIMITERS if each in head), ",")
            if tuple(cell.strip(' "') for cell in head.split(delimiter)[:2]) == _FRAME:
                yield at


def open_table(source: Source) -> Table:
    """Read the sections' headers."""
    source.require_text()
    lines = list(source.lines())
    sections = [_section(source, lines, at) for at in _begins(lines)]
    places: dict[str, tuple[_Section, int]] = {}
    for section in sections:
        for index, name in enumerate(section.names):
            if name and index >= len(_FRAME):
                places[name if name not in places else f"{name} #{index + 1}"] = section, index

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        loaded: dict[str, Column] = {}
        for section in sections:
            of_section = {name: places[name][1] for name in wanted if places[name][0] is section}
            if of_section:
                data = section.rows.load([0, 1, *of_section.values()])
                time = _times(data[0], data[1], section, source.shown)
                position = in_row(range(section.row + 2, section.row + 2 + len(time)))
                for (name, index), values in zip(of_section.items(), data[2:], strict=True):
                    why = section.rows.reason(index)
                    loaded[name] = Column(name, time, values, _FRAME[0], position, why)
        return loaded

    units = {n: s.units[i] for n, (s, i) in places.items() if i < len(s.units) and s.units[i]}
    return Table(source.shown, "Vicon Nexus CSV", tuple(places), _FRAME[0], load, units)


def _times(frames: FloatArray, subs: FloatArray, section: _Section, shown: str) -> FloatArray:
    """Times [s] of samples, which must follow each other without a gap."""
    with np.errstate(all="ignore"):
        counted = (frames - 1.0) * (subs.max() + 1.0) + subs
        follows = (np.diff(counted) == 1.0).all() and np.isfinite(counted).all()
    if not follows:
        raise InputError(f"{shown}: {section.title}: frames are missing or out of order")
    return instants(float(counted[0]) / section.rate_hz, section.rate_hz, len(counted))


def _section(source: Source, lines: Sequence[str], at: int) -> _Section:
    """The section whose title is line `at`, counted from 0."""
    title = lines[at].strip(_AROUND)
    try:
        rate = float(lines[at + 1].strip(_AROUND))
    except ValueError:
        rate = 0.0
    if not 0.0 < rate < 1e7:
        raise InputError(
            f"{source.shown}: row {at + 2}: {title} has no sampling rate where Nexus writes it"
        )
    delimiter = next(each for each in _DELIMITERS if each in lines[at + 3])
    devices, columns, units = (split(line, delimiter) for line in (*lines[at + 2 : at + 5], "")[:3])
    device = ""
    names = []
    for index, column in enumerate(columns):
        device = (devices[index] if index < len(devices) else "") or device
        full = f"{device}: {column}" if device and column else column
        names.append(column if column in _FRAME else full)
    rest = range(at + 5, len(lines))
    last = next((k for k in rest if not lines[k].strip(_AROUND)), len(lines))
    within = replace(source, data="".join(lines[:last]).encode())
    cells = tuple(map(str, range(len(names))))
    body = "".join(lines[at + 5 : at + 5 + _LOOKED_AT])
    decimal = "," if delimiter != "," and "," in body and "." not in body else "."
    rows = Rows(within, at + 5, cells, delimiter, decimal)
    return _Section(title, at + 4, rate, tuple(names), tuple(units), rows)
