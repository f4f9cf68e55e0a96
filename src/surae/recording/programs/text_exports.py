"""Text exports of programs that say names, units and rates in lines of their own.

LabChart, AcqKnowledge, Qualisys Track Manager (TSV), Motion Analysis (.anc) and OpenSignals: what
stands above the numbers is read here, the numbers as those of CSV.
"""

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FACTORS, spelled
from surae.recording.body import body_of
from surae.recording.delimited import table_of
from surae.recording.headings import TableHeading
from surae.recording.source import Source
from surae.recording.table import Clock, Column, Table

_COMMENT = re.compile(rb"\t#(?:\d+|\*)[^\t\r\n]*(?=[\r\n]|$)")
#: Lines that may stand above the numbers.
_MOST = 400


@dataclass(frozen=True, slots=True)
class _Said:
    """What an export says above its numbers."""

    row: int  #: The last row above them, counted from 1.
    names: tuple[str, ...]
    units: Mapping[str, str] = field(default_factory=dict)
    rate_hz: float = 0.0
    time: str = ""  #: The column of times, in seconds or in its unit.
    time_unit: str = "s"
    samples: int = 0  #: How many it announces; 0 where it does not.
    delimiter: str | None = "\t"


def recognises(source: Source) -> bool:
    """Whether its first lines are those of one of the programs."""
    return _program(source.head()[:_MOST]) is not None


def open_table(source: Source) -> Table:
    """The columns of an export."""
    source.require_text()
    lines = [line.rstrip("\n") for line in islice(source.lines(), _MOST)]
    known = _program(lines)
    if known is None:
        raise InputError(f"{source.shown}: of none of the programs that are known")
    program, read = known
    try:
        said = read(lines)
    except (ValueError, IndexError, KeyError, TypeError, AttributeError, StopIteration):
        raise InputError(
            f"{source.shown}: {program}'s lines above the numbers are not as it writes them: "
            "export it again, or as MATLAB"
        ) from None
    if len(said.names) < 1 or not np.isfinite(said.rate_hz):
        raise InputError(f"{source.shown}: {program} names no channel here")
    head = TableHeading(
        said.row, _apart(said.names), said.delimiter, {}, said.units, rate_hz=said.rate_hz
    )
    body = (
        body_of(_without_comments(source), head) if program == "LabChart" else body_of(source, head)
    )
    clock = Clock(said.time, said.time_unit, f"{program}'s times") if said.time else None
    remark = "; ".join(filter(None, (source.decoded, body.remark)))
    given = clock is not None
    table = table_of(body.source, head, clock, form=program, remark=remark, given=given)
    table = replace(table, header=None)
    return _announced(table, said.samples) if said.samples else table


def _without_comments(source: Source) -> Source:
    """A text without what LabChart writes behind a row: ``#1 contraction begins``."""
    return replace(source, data=_COMMENT.sub(b"", source.data))


def _announced(table: Table, samples: int) -> Table:
    """A table whose columns say where they hold fewer samples than announced."""

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        loaded = table.load(wanted)
        return {name: _short(column, samples) for name, column in loaded.items()}

    return replace(table, load=load)


def _short(column: Column, samples: int) -> Column:
    n = len(column.values)
    if n >= samples:
        return column
    said = f"the header states {samples} samples, the file holds {n}: it was cut short"
    return replace(column, remark="; ".join(filter(None, (column.remark, said))))


def _apart(names: Sequence[str]) -> tuple[str, ...]:
    """Names, those that are blank by their place."""
    return tuple(name or f"column {k}" for k, name in enumerate(names, 1))


_Reader = Callable[[Sequence[str]], _Said]


def _program(lines: Sequence[str]) -> tuple[str, _Reader] | None:
    """The program that wrote these first lines."""
    head = "\n".join(lines[:40])
    for pattern, program, reader in _PROGRAMS:
        if re.search(pattern, head, re.MULTILINE):
            return program, reader
    return None


def _keyed(lines: Sequence[str], between: str) -> Iterator[tuple[int, str, list[str]]]:
    """Rows of a key and its values: number, key, values."""
    for number, line in enumerate(lines, start=1):
        key, *values = re.split(between, line)
        yield number, key.strip(), [value.strip() for value in values]


def _first_numbers(lines: Sequence[str], delimiter: str | None, start: int = 0) -> int:
    """The number of lines above the first row of numbers, at `start` or behind it."""
    for k in range(start, len(lines)):
        cells = [cell.strip().replace(",", ".") for cell in lines[k].split(delimiter)]
        cells = [cell for cell in cells if cell]
        try:
            if len([float(cell) for cell in cells]) > 0:
                return k
        except ValueError:
            continue
    return len(lines)


def _labchart(lines: Sequence[str]) -> _Said:
    """LabChart: ``Interval=``, ``ChannelTitle=``, ``UnitName=``, then times and samples."""
    said = {key: (number, values) for number, key, values in _keyed(lines, "=?\t")}
    said = {key.rstrip("="): pair for key, pair in said.items()}
    titles = [title for title in said["ChannelTitle"][1] if title]
    above = _first_numbers(lines, "\t", said["ChannelTitle"][0])
    units = dict(zip(titles, said["UnitName"][1], strict=False)) if "UnitName" in said else {}
    count = len(lines[above].rstrip("\t").split("\t")) if above < len(lines) else len(titles) + 1
    interval = said["Interval"][1][0].split() if "Interval" in said else ["0", "s"]
    seconds = float(interval[0].replace(",", ".")) * FACTORS["time"].get(
        spelled(interval[-1]) or "s", 1.0
    )
    if count == len(titles):  # the times were left out
        return _Said(above, tuple(titles), units, 1.0 / seconds if seconds > 0 else 0.0)
    return _Said(above, ("Time", *titles), {k: u for k, u in units.items() if u}, time="Time")


def _acqknowledge(lines: Sequence[str]) -> _Said:
    """AcqKnowledge: the interval, the number of channels, then each one's name and unit."""
    at = next(k for k, line in enumerate(lines) if re.match(_PER_SAMPLE, line))
    number, unit = re.split(r"\s+", lines[at].strip().partition("/")[0])[:2]
    if unit.casefold().startswith(("sample", "hz")):
        seconds = 1.0 / float(number)
    else:
        seconds = float(number) * FACTORS["time"][spelled(unit) or ""]
    count = int(lines[at + 1].split()[0])
    about = [line.strip() for line in lines[at + 2 : at + 2 + 2 * count]]
    names, units = about[0::2], about[1::2]
    delimiter = next(d for d in ("\t", ",") if d in lines[at + 2 + 2 * count])
    above = _first_numbers(lines, delimiter, at + 2 + 2 * count)
    if above < len(lines) and not lines[above].split(delimiter)[0].strip():
        above += 1  # a row that says how many samples each channel has
    samples = re.match(r"\s*(\d+)(?:\s+samples|\s)", lines[above - 1].replace(delimiter, " "))
    heads = [cell.strip() for cell in lines[at + 2 + 2 * count].split(delimiter)]
    timed = spelled(heads[0]) in FACTORS["time"] or heads[0].casefold().startswith(("time", "min"))
    every = (*(("time",) if timed else ()), *names)
    cells = lines[above].rstrip(delimiter).split(delimiter) if above < len(lines) else every
    if len(cells) != len(every):
        raise ValueError
    known = dict(zip(names, units, strict=True))
    return _Said(
        above,
        every,
        known,
        rate_hz=0.0 if timed else 1.0 / seconds,
        time="time" if timed else "",
        time_unit=spelled(heads[0]) or "s",
        samples=int(samples[1]) if samples else 0,
        delimiter=delimiter,
    )


def _qualisys(lines: Sequence[str]) -> _Said:
    """Qualisys TSV: keys, ``FREQUENCY``, the names of markers or channels, then the numbers."""
    said = {key: (number, values) for number, key, values in _keyed(lines, "\t")}
    rate = float(said["FREQUENCY"][1][0])
    named = next(k for k in ("MARKER_NAMES", "CHANNEL_NAMES", "FORCE_PLATE_NAME") if k in said)
    names = [name for name in said[named][1] if name]
    above = _first_numbers(lines, "\t", max(number for number, _ in said.values() if number < 40))
    above = _first_numbers(lines, "\t", said[named][0])
    count = len(lines[above].rstrip("\t").split("\t"))
    if named == "MARKER_NAMES":
        names = [f"{name}.{axis}" for name in names for axis in "XYZ"]
    heads = [c.strip() for c in lines[above - 1].split("\t")] if above > said[named][0] else []
    if count == len(names) + 2:
        names = ["Frame", "Time", *names]
    elif count == len(names) + 1:
        names = ["Time" if heads[:1] == ["Time"] else "Frame", *names]
    if count != len(names):
        raise ValueError
    key = next((k for k in ("NO_OF_FRAMES", "NO_OF_SAMPLES") if k in said), "")
    units = dict.fromkeys(names, "mm") if named == "MARKER_NAMES" else {}
    return _Said(
        above, tuple(names), units, rate_hz=rate, samples=int(said[key][1][0]) if key else 0
    )


def _anc(lines: Sequence[str]) -> _Said:
    """Motion Analysis .anc: rows ``Name``, ``Rate`` and ``Range``, then times and samples."""
    said = {key: (number, values) for number, key, values in _keyed(lines, "\t+")}
    names = [name for name in said["Name"][1] if name]
    above = _first_numbers(
        lines, "\t", max(said[k][0] for k in ("Name", "Rate", "Range") if k in said)
    )
    announced = re.search(r"#Samples:\s*(\d+)|Duration\(Sec\.\):\t*([\d.]+)", "\n".join(lines[:8]))
    rate = float(said["Rate"][1][0]) if "Rate" in said else 0.0
    samples = 0
    if announced:
        samples = int(announced[1]) if announced[1] else round(float(announced[2]) * rate)
    return _Said(above, ("Time", *names), {}, time="Time", samples=max(samples - 1, 0))


def _opensignals(lines: Sequence[str]) -> _Said:
    """OpenSignals: a line of JSON on each device, then its columns."""
    about = json.loads(next(line for line in lines if line.startswith("# {"))[2:])
    names: list[str] = []
    for number, device in enumerate(about.values(), start=1):
        columns = [str(name) for name in device["column"]]
        labels = [str(label) for label in device.get("label", [])]
        sensors = [str(sensor) for sensor in device.get("sensor", [])]
        first = len(columns) - len(labels)  # counters stand before the channels
        for k, (label, sensor) in enumerate(zip(labels, sensors, strict=False)):
            columns[first + k] = f"{sensor} {label}".strip()
        names += [f"device {number}: {name}" for name in columns] if len(about) > 1 else columns
    device = next(iter(about.values()))
    above = next(k for k, line in enumerate(lines) if "EndOfHeader" in line) + 1
    return _Said(above, tuple(names), {}, rate_hz=float(device["sampling rate"]))


#: AcqKnowledge's second line.
_PER_SAMPLE = r"^[\d.]+\s+(?:[mu]?sec/sample|samples/sec(?:ond)?|Hz)\s*$"

_PROGRAMS: Sequence[tuple[str, str, _Reader]] = (
    (r"^ChannelTitle=", "LabChart", _labchart),
    (_PER_SAMPLE, "AcqKnowledge", _acqknowledge),
    (r"^NO_OF_(FRAMES|SAMPLES|CHANNELS)\t", "Qualisys", _qualisys),
    (r"^File_Type:\t*Analog R/C ASCII", "Motion Analysis", _anc),
    (r"^# OpenSignals Text File", "OpenSignals", _opensignals),
)
