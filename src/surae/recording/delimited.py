"""CSV: a header row that names the columns, then numbers; ``#`` lines are comments.

Columns are separated by commas, semicolons or tabs; where it is no comma, numbers may have a
decimal one. A block of lines about the recording may come before the names, rows of names or units
after them, and lines that are no numbers at the end, as programs export them.
"""

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray, plain
from surae.recording.body import body_of
from surae.recording.clocks import clocks_behind
from surae.recording.headings import TableHeading, heading_of, numeric, rate_in
from surae.recording.roles import NAMES, guess_role
from surae.recording.rows import Rows, is_clock, split
from surae.recording.source import Source
from surae.recording.table import Clock, Column, Table, instants
from surae.recording.times import (
    LOOKED_AT,
    counted,
    is_clocks,
    is_part_of_movement,
    rises_in_percent,
    seconds,
    time_by_shape,
    time_column,
    unit_since_epoch,
)

#: Tables of BIDS without a heading.
_BIDS = ("_motion.tsv", "_physio.tsv")
#: Where numbers begin, so many bytes show how they are written.
_LOOKED_AT = 2**20
_CELL = rb"(?:^|[;\t])[ \"]*[+-]?\d*%s\d+(?:[eE][+-]?\d+)?[ \"]*(?=[;\t\r\n]|$)"
_WITH_COMMA = re.compile(_CELL % rb",", re.MULTILINE)
_WITH_POINT = re.compile(_CELL % rb"\.", re.MULTILINE)


def open_table(source: Source, clock: Clock | None = None) -> Table:
    """Read the header of a CSV file, and which column is the time unless a clock is given.

    Text with no header, or a comment that sets what isn't known, is refused.
    """
    source.require_text()
    head = heading_of(source)
    where = f"{source.shown}: row {head.row}"
    if all(numeric(name) for name in head.names):
        raise InputError(
            f"{where}: numbers where the names of the columns belong; the first line that is no "
            "comment must name them (time_s, angle_rad, ...)"
            + " (BIDS keeps them in channels.tsv, of physio in the file .json beside it)"
            * source.path.endswith(_BIDS)
        )
    body = body_of(source, head)
    names = _named(body.source, head)
    return table_of(
        body.source,
        replace(head, names=names),
        clock or _clock(head, where),
        remark="; ".join(filter(None, (source.decoded, head.remark, body.remark))),
        given=clock is not None,
    )


def table_of(
    source: Source,
    head: TableHeading,
    clock: Clock | None,
    *,
    form: str = "CSV",
    remark: str = "",
    given: bool = False,
) -> Table:
    """The table below a heading.

    Without a clock its times are those of the heading's rate; where that says none, a column may
    offer itself by its shape.
    """
    where = f"{source.shown}: row {head.row}"
    decimal = _decimal(source, head)
    time = "" if clock is None else clock.column
    unit = head.units.get(time)
    if clock is not None and not given and unit and not is_clocks(unit):
        seconds(unit, time, where)
        clock = replace(clock, unit=plain(unit))
    first = next(itertools.islice(source.lines(), head.row, None), "")
    names = head.names
    cells = split(first, head.delimiter)
    if len(cells) == len(names) + 1 and not cells[-1]:  # every row ends with a separator
        names = (*names, "")
    of_day = None
    if time and len(cells) == len(names):
        at = names.index(time)
        of_day = at if is_clock(cells[at]) else None
    rows = Rows(source, head.row, names, head.delimiter, decimal, of_day)
    offered = None
    counted_by = ""
    if not time and not head.rate_hz:
        offered = _by_shape(rows, where, cells)
        if offered is not None and not offered.unit and (rate := rate_in(offered.column)):
            counted_by = offered.column  # Sample (500 Hz)
            head = replace(head, rate_hz=rate)
            offered = None
    elif clock is not None and not clock.unit and of_day is None:
        clock, said = _plausible(rows, clock)
        remark = "; ".join(filter(None, (remark, said)))
    factor = 1.0 if clock is None else clock.in_seconds
    apart = {}
    if clock is not None and of_day is None:
        apart = clocks_behind(names, clock, _first_numbers(rows))

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        loaded = rows.columns([name for name in wanted if name not in apart], time, factor)
        loaded |= _by_their_clocks(rows, wanted, apart)
        if time or not head.rate_hz:
            return loaded
        n = len(next(iter(loaded.values())).time) if loaded else 0
        even = instants(0.0, head.rate_hz, n)
        return {name: replace(each, time=even, time_name="time") for name, each in loaded.items()}

    def retimed(column: str, unit: str) -> Table:
        clock = Clock(column, unit, "as the mapping says")
        return table_of(source, head, clock, form=form, remark=remark, given=True)

    times = {time, *(each.column for each in apart.values())}
    others = tuple(name for name in names if name and name not in times)
    ours = {name: NAMES[plain(name)][1] for name in others if plain(name) in NAMES}
    units = {n: unit for n in others if (unit := head.units.get(n) or head.unit)} | ours
    said_by = f"column {counted_by!r} says" if counted_by else "the lines above the names say"
    by_rate = f"{head.rate_hz:g} Hz, as {said_by}" if head.rate_hz else ""
    said = "; ".join(filter(None, (remark, by_rate * (not time))))
    return Table(
        source.shown,
        form,
        others,
        time or ("time" if head.rate_hz else ""),
        load,
        units,
        notes=head.notes,
        header=head.row,
        remarks=dict.fromkeys(others, said) if said else {},
        began="" if of_day is not None else head.began,
        offered=offered,
        retimed=retimed,
        cells=rows.texts,
    )


def _by_their_clocks(
    rows: Rows, wanted: Sequence[str], apart: Mapping[str, Clock]
) -> dict[str, Column]:
    """Columns that have a column of times of their own."""
    loaded: dict[str, Column] = {}
    for clock in dict.fromkeys(apart[name] for name in wanted if name in apart):
        clocks = [name for name in wanted if apart.get(name) == clock]
        said = f"its times are those of column {clock.column!r}"
        for name, column in rows.columns(clocks, clock.column, clock.in_seconds).items():
            remark = "; ".join(filter(None, (said, column.remark)))
            loaded[name] = replace(column, remark=remark)
    return loaded


def _clock(head: TableHeading, where: str) -> Clock | None:
    """The column that is the time by its name."""
    return time_column(head.names, where)


def _named(source: Source, head: TableHeading) -> tuple[str, ...]:
    """The names, those that are blank above numbers by their place."""
    if all(head.names):
        return head.names
    first = next(itertools.islice(source.lines(), head.row, None), "")
    cells = split(first, head.delimiter)
    cells += [""] * (len(head.names) - len(cells))
    return tuple(
        name or (f"column {k}" if cells[k - 1] else "") for k, name in enumerate(head.names, 1)
    )


def _decimal(source: Source, head: TableHeading) -> str:
    """What begins the decimals."""
    if head.delimiter == ",":
        return "."
    body = "".join(itertools.islice(source.lines(), head.row, head.row + 1000)).encode()
    body = body[:_LOOKED_AT]
    return "," if _WITH_COMMA.search(body) and not _WITH_POINT.search(body) else "."


def _first_numbers(rows: Rows) -> dict[str, FloatArray]:
    """The first numbers of every column with a name."""
    lines = itertools.islice(rows.source.lines(), rows.header + LOOKED_AT)
    few = replace(rows, source=replace(rows.source, data="".join(lines).encode()))
    named = {name: k for k, name in reversed(list(enumerate(rows.names))) if name}
    try:
        data = few.load(list(named.values()))
    except InputError:
        return {}
    return dict(sorted(zip(named, data, strict=True), key=lambda item: named[item[0]]))


def _by_shape(rows: Rows, where: str, first: Sequence[str]) -> Clock | None:
    """The column that is the time by its shape; a movement in percent is refused.

    `first` are the cells of the first row: times of day have a shape of their own.
    """
    of_day = [name for name, cell in zip(rows.names, first, strict=False) if is_clock(cell)]
    if len(of_day) == 1:
        return Clock(of_day[0], "s", "its cells are times of day")
    columns = _first_numbers(rows)
    for name, values in columns.items():
        in_percent = "%" in name or "percent" in name.casefold() or is_part_of_movement(name)
        if in_percent and rises_in_percent(values):
            seconds("%", name, where)
    # A ramp of the angle rises evenly too.
    signals = {n: v for n, v in columns.items() if guess_role(n) is None}
    clock = time_by_shape(signals)
    if clock is None and (count := counted(signals)):
        return Clock(count, "", "it counts the samples")
    return clock


def _plausible(rows: Rows, clock: Clock) -> tuple[Clock, str]:
    """The clock in the unit that makes its rate one of a laboratory, where seconds do not."""
    values = _first_numbers(rows).get(clock.column, np.empty(0))
    if (since := unit_since_epoch(values)) not in ("", "s"):
        said = f"{clock.column!r} is taken as {since}: it is the time of day and year in that unit"
        return replace(clock, unit=since), said
    by_shape = time_by_shape({clock.column: values})
    if by_shape is None or by_shape.unit == "s":
        return clock, ""
    step = float(np.median(np.diff(values)))
    if step < 5.0:  # a slow recording in seconds
        return clock, ""
    said = f"{clock.column!r} is taken as {by_shape.unit}: in s it would be {1 / step:.3g} Hz"
    return replace(clock, unit=by_shape.unit), said
