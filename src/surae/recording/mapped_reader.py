"""The channels that a mapping describes, read from their files, each of which is opened once."""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from surae.base.errors import InputError, within
from surae.base.files import shown
from surae.base.frozen import as_read_only, freeze
from surae.base.units import to_si
from surae.recording.channels import Scaling, channel, settle_unit
from surae.recording.described import TRIAL, MappedChannel, MappedTime, MappedTrial
from surae.recording.formats import open_table
from surae.recording.recording import Channel
from surae.recording.source import Source, open_source
from surae.recording.table import Column, IndexArray, Table, fallbacks, instants, some
from surae.recording.times import on_one_clock, timed_by
from surae.recording.trials import frames_begin_again, one_trial

#: What gives a zero may change, from one part of so long [s] to another, by this part of the
#: signal's own range, or by what a sensor's noise and a leg at rest bring: 1° and 1 Nm in SI.
_PART = 0.1
_QUIET = 0.05
_REST = {"angle": 0.0175, "torque": 1.0}


@dataclass(frozen=True, slots=True)
class MappedReader:
    """Reads the files of one recording, each once."""

    source: Source  #: The mapping.
    folder: Path  #: What its names of files are relative to.
    #: `trial`, `data`: the trial's name and data file, for a mapping of many.
    trial: str | None
    data: Path | None
    time: str | MappedTime | None = None  #: The column of times of all channels.
    chosen: MappedTrial | None = None  #: Which trial of a file is read.
    opened: dict[Path, tuple[Source, Table]] = field(default_factory=dict)  #: What has been read.

    def channels(self, described: Mapping[str, MappedChannel]) -> dict[str, Channel]:
        """The channels that are described, in SI units."""
        tables = self._tables(described)
        for role, each in described.items():
            table = tables[role]
            if each.time is not None:
                tables[role] = timed_by(table, *column_of(each.time), self._at(role))
        columns = self._loaded(described, tables)
        by_clock = {r: c for r, c in columns.items() if described[r].start_s is None}
        columns |= on_one_clock(by_clock)
        channels: dict[str, Channel] = {}
        for role, each in described.items():
            table = tables[role]
            unit = settle_unit(table, role, each.column, each.unit, self._at(role))
            column = _timed(each, columns[role], table, self._at(role))
            if each.wrap is not None:
                column = replace(column, values=freeze(np.unwrap(column.values, period=each.wrap)))
            offset = each.offset
            note = ""
            if each.zero is not None:
                offset, note = self._zero(role, each, each.zero, column, unit)
            scaling = Scaling(unit, each.sign, each.scale, offset, note, each.bridge_s)
            channels[role] = channel(role, column, scaling, table)
        return channels

    def _loaded(
        self, described: Mapping[str, MappedChannel], tables: Mapping[str, Table]
    ) -> dict[str, Column]:
        """The columns that are wanted, those of one table read together."""
        roles_of: dict[int, list[str]] = {}
        for role, table in tables.items():
            roles_of.setdefault(id(table), []).append(role)
        loaded: dict[str, Column] = {}
        for roles in roles_of.values():
            names = list(dict.fromkeys(described[role].column for role in roles))
            columns = tables[roles[0]].load(names)
            loaded |= {role: columns[described[role].column] for role in roles}
        return loaded

    def _at(self, role: str) -> str:
        """Where the mapping describes a channel, for messages."""
        return f"{self.source.shown}: channels.{role}"

    def _tables(self, described: Mapping[str, MappedChannel]) -> dict[str, Table]:
        """The table of every channel's file."""
        named = {one.file for one in described.values()}
        # A description of one file, given for another: it is the layout that is meant.
        layout = self.data is not None and len(named) == 1 and TRIAL not in str(named)
        tables = {}
        for role, one in described.items():
            where = self._at(role)
            if not one.column:
                raise InputError(f"{where}: column is missing")
            if self.data is not None and (layout or one.file is None):
                path = self.data
            elif one.file is None or (self.trial is None and TRIAL in one.file):
                lacks = "file is missing" if one.file is None else f"file is {one.file!r}"
                raise InputError(
                    f"{where}: {lacks}: name the file, or give this mapping of many files by "
                    "--mapping, with the files"
                )
            elif self.trial is not None and TRIAL not in one.file:
                raise InputError(
                    f"{where}: file {one.file!r} is one and the same for all trials; write it with "
                    '"{trial}", or leave `file` out'
                )
            else:
                path = self.folder / self._named(one.file)
            tables[role] = self._table(path, one, where)
        return tables

    def _named(self, file: str) -> str:
        return file if self.trial is None else file.replace(TRIAL, self.trial)

    def _arranged(self, table: Table, quiet: bool) -> Table:
        """A file's table with the trial and the time that the mapping says, of all its channels.

        A quiet trial that gives a zero is a file of its own, and no part of one.
        """
        chosen = None if quiet else self.chosen
        if chosen is not None and chosen.inside is not None:
            table = one_trial(table, chosen, self.source.shown)
        if self.time is not None:
            column, unit = column_of(self.time)
            # Of several files one may have its own times.
            if column in (*table.names, table.time_name) or not table.time_name:
                table = timed_by(table, column, unit, self.source.shown)
        if chosen is not None and chosen.inside is None:
            table = one_trial(table, chosen, self.source.shown)
        return table

    def _table(
        self, path: Path, mapped: MappedChannel, where: str, *, quiet: bool = False
    ) -> Table:
        """A data file's table that has the channel's column; errors say where it is named."""
        if path not in self.opened:
            with within(where):
                source = open_source(path)
                table = open_table(source, timed=False)
            self.opened[path] = source, self._arranged(table, quiet)
        table = self.opened[path][1]
        count = table.names.count(mapped.column)
        if count > 1:
            raise InputError(
                f"{where}: {table.file} has {count} columns {some([mapped.column])}; rename one"
            )
        if count == 0:
            near = difflib.get_close_matches(mapped.column, table.names, n=3, cutoff=0.5)
            has = f"did you mean {some(near)}?" if near else f"it has: {some(table.names)}"
            raise InputError(f"{where}: {table.file} has no column {some([mapped.column])}; {has}")
        return table

    def _zero(
        self,
        role: str,
        mapped: MappedChannel,
        zero: str | tuple[float, float],
        column: Column,
        unit: str,
    ) -> tuple[float, str]:
        """The offset that takes a quiet trial or stretch to zero, and what to say of it."""
        where = f"{self._at(role)}: zero"
        if isinstance(zero, str):
            path = self.folder / self._named(zero)
            if not path.exists():
                path = Path(self.source.path).parent / self._named(zero)
            quiet = self._table(path, mapped, where, quiet=True).load([mapped.column])[
                mapped.column
            ]
            time = quiet.time
            values = quiet.values
            origin = shown(path.name)
        else:
            start, end = zero
            inside = (column.time >= start) & (column.time <= end)
            time = column.time[inside]
            values = column.values[inside]
            origin = f"{start:g} to {end:g} s"
        if len(values) < 2 or not np.isfinite(values).all():
            raise InputError(f"{where}: {origin} holds no finite samples of {mapped.column!r}")
        if role in _REST:
            parts = min(max(round(float(time[-1] - time[0]) / _PART), 2), len(values))
            means = [float(part.mean()) for part in np.array_split(values, parts)]
            change = max(means) - min(means)
            factor = abs(mapped.scale) * to_si(role, unit, "")
            range_ = float(np.ptp(column.values[np.isfinite(column.values)]))
            if change > _QUIET * range_ and factor * change > _REST[role]:
                raise InputError(
                    f"{where}: {mapped.column!r} is not quiet in {origin}: it changes by "
                    f"{abs(mapped.scale) * change:.3g} {unit}; name a trial or a stretch in which "
                    "nothing happens"
                )
        mean = mapped.scale * float(values.mean())
        return -mean, f"zero {mean:.4g} ± {abs(mapped.scale) * float(values.std()):.2g} of {origin}"


def column_of(time: str | MappedTime) -> tuple[str, str | None]:
    """The column of times that a mapping says, and its unit."""
    return (time, None) if isinstance(time, str) else (time.column, time.unit)


def _timed(mapped: MappedChannel, column: Column, table: Table, where: str) -> Column:
    """A channel's column, with the times of its own clock where it has one."""
    if mapped.rate_hz is not None:
        backs = fallbacks(column.time) if column.time_name else _frames_back(table, column)
        if n := len(backs):
            raise InputError(
                f"{where}: {table.file} holds {n + 1} trials, whose times or frames fall back: "
                "rate_hz would "
                "join them; say which with trial = { column = … } or { index = … }, at the top"
            )
        even = instants(mapped.start_s or 0.0, mapped.rate_hz, len(column.time))
        return _clocked(replace(column, time=even), mapped)
    if not column.time_name:
        raise InputError(
            f"{where}: {table.file} has no times of {mapped.column!r}: give start_s, when the "
            "recording's clock shows its first sample, and rate_hz, its samples a second"
        )
    if mapped.start_s is not None and len(column.time):
        column = replace(column, time=as_read_only(column.time - column.time[0] + mapped.start_s))
    return _clocked(column, mapped)


def _frames_back(table: Table, column: Column) -> IndexArray:
    """Where a count of frames falls back among a column's samples, which have no times."""
    try:
        loaded = table.load(table.names)
    except InputError:
        return np.empty(0, dtype=np.intp)
    return frames_begin_again(c for c in loaded.values() if len(c.values) == len(column.values))


def _clocked(column: Column, mapped: MappedChannel) -> Column:
    """A column whose clock is slow or fast, in true time; a first instant that is given is true."""
    if not mapped.clock_ppm or not len(column.time):
        return column
    true = 0.0 if mapped.start_s is None else mapped.start_s
    time = true + (column.time - true) / (1.0 + 1e-6 * mapped.clock_ppm)
    said = f"clock {mapped.clock_ppm:g} ppm {'fast' if mapped.clock_ppm > 0 else 'slow'}, corrected"
    remark = "; ".join(filter(None, (column.remark, said)))
    return replace(column, time=as_read_only(time), remark=remark)
