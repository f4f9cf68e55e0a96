"""The channels that a mapping describes, read from their files: each file once."""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from surae.errors import InputError
from surae.files import shown
from surae.frozen import as_read_only
from surae.recording.channels import Scaling, channel, settle_unit
from surae.recording.described import MappedChannel
from surae.recording.formats import open_table
from surae.recording.recording import Channel
from surae.recording.roles import words_of
from surae.recording.samples import instants
from surae.recording.source import Source, open_source
from surae.recording.table import Column, Table, some
from surae.units import FACTORS, spelled, to_si

#: What stands for the trial's name in the name of a file.
TRIAL = "{trial}"
#: What gives a zero may change, from one part of so long [s] to another, by this part of the
#: signal's own range, or by what a sensor's noise and a leg at rest bring: 1° and 1 Nm in SI.
_PART, _QUIET, _REST = 0.1, 0.05, {"angle": 0.0175, "torque": 1.0}


@dataclass(frozen=True, slots=True)
class Reader:
    """Reads the files of one recording, each once."""

    source: Source  #: The mapping.
    folder: Path  #: What its names of files are relative to.
    #: `trial`, `data`: the trial's name and data file, for a mapping of many.
    trial: str | None
    data: Path | None
    #: `sources`, `tables`: what has been read.
    sources: dict[Path, Source] = field(default_factory=dict)
    tables: dict[Path, Table] = field(default_factory=dict)

    def channels(self, described: Mapping[str, MappedChannel]) -> dict[str, Channel]:
        """The channels that are described, in SI units."""
        tables = self._tables(described)
        wanted: dict[Path, list[str]] = {}
        for role, own in described.items():
            table = self.tables[tables[role]]
            if own.time is not None and own.time not in (*table.names, table.time_name):
                raise InputError(
                    f"{self._at(role)}: time: {table.file} has no column {some([own.time])}; it "
                    f"has: {some(table.names)}"
                )
            names = wanted.setdefault(tables[role], [])
            names += [
                name for name in (own.column, own.time) if name in table.names and name not in names
            ]
        columns = {path: self.tables[path].load(names) for path, names in wanted.items()}
        channels: dict[str, Channel] = {}
        for role, own in described.items():
            path = tables[role]
            table = self.tables[path]
            unit = settle_unit(table, role, own.column, own.unit, self._at(role))
            column = _timed(own, columns[path], table)
            offset, note = own.offset, ""
            if own.zero is not None:
                offset, note = self._zero(role, own, own.zero, column, unit)
            scaling = Scaling(unit, own.sign, own.scale, offset, note)
            channels[role] = channel(role, column, scaling, table)
        return channels

    def _at(self, role: str) -> str:
        """Where the mapping describes a channel, for messages."""
        return f"{self.source.shown}: channels.{role}"

    def _tables(self, described: Mapping[str, MappedChannel]) -> dict[str, Path]:
        """The file of every channel, opened."""
        named = {own.file for own in described.values()}
        # A description of one file, given for another: it is the layout that is meant.
        layout = self.data is not None and len(named) == 1 and TRIAL not in str(named)
        paths = {}
        for role, own in described.items():
            where = self._at(role)
            if not own.column:
                raise InputError(f"{where}: column is missing")
            if self.data is not None and (layout or own.file is None):
                path = self.data
            elif own.file is None or (self.trial is None and TRIAL in own.file):
                lacks = "file is missing" if own.file is None else f"file is {own.file!r}"
                raise InputError(
                    f"{where}: {lacks}: name the file, or give this mapping of many files by "
                    "--mapping, with the files"
                )
            elif self.trial is not None and TRIAL not in own.file:
                raise InputError(
                    f"{where}: file {own.file!r} is one and the same for all trials; write it with "
                    '"{trial}", or leave `file` out'
                )
            else:
                path = self.folder / _named(own.file, self.trial)
            self._table(path, own, where)
            paths[role] = path
        return paths

    def _table(self, path: Path, own: MappedChannel, where: str) -> Table:
        """A data file's table that has the channel's column; errors say where it is named."""
        if path not in self.tables:
            try:
                self.sources[path] = open_source(path)
                self.tables[path] = open_table(self.sources[path], timed=False)
            except InputError as error:
                raise InputError(f"{where}: {error}") from None
        table = self.tables[path]
        if not table.time_name and own.rate_hz is None and own.time is None:
            raise InputError(
                f"{where}: {table.file} has no column of times: give start_s, when the recording's "
                "clock shows its first sample, and rate_hz, its samples a second"
            )
        count = table.names.count(own.column)
        if count > 1:
            raise InputError(
                f"{where}: {table.file} has {count} columns {some([own.column])}; rename one"
            )
        if count == 0:
            near = difflib.get_close_matches(own.column, table.names, n=3, cutoff=0.5)
            has = f"did you mean {some(near)}?" if near else f"it has: {some(table.names)}"
            raise InputError(f"{where}: {table.file} has no column {some([own.column])}; {has}")
        return table

    def _zero(
        self,
        role: str,
        own: MappedChannel,
        zero: str | tuple[float, float],
        column: Column,
        unit: str,
    ) -> tuple[float, str]:
        """The offset that takes a quiet trial or stretch to zero, and what to say of it."""
        where = f"{self._at(role)}: zero"
        if isinstance(zero, str):
            path = self.folder / _named(zero, self.trial)
            if not path.exists():
                path = Path(self.source.path).parent / _named(zero, self.trial)
            quiet = self._table(path, own, where).load([own.column])[own.column]
            time, values, origin = quiet.time, quiet.values, shown(path.name)
        else:
            start, end = zero
            inside = (column.time >= start) & (column.time <= end)
            time, values = column.time[inside], column.values[inside]
            origin = f"{start:g} to {end:g} s"
        if len(values) < 2 or not np.isfinite(values).all():
            raise InputError(f"{where}: {origin} holds no finite samples of {own.column!r}")
        if role in _REST:
            parts = min(max(round(float(time[-1] - time[0]) / _PART), 2), len(values))
            means = [float(part.mean()) for part in np.array_split(values, parts)]
            change, factor = max(means) - min(means), abs(own.scale) * to_si(role, unit, "")
            range_ = float(np.ptp(column.values[np.isfinite(column.values)]))
            if change > _QUIET * range_ and factor * change > _REST[role]:
                raise InputError(
                    f"{where}: {own.column!r} is not quiet in {origin}: it changes by "
                    f"{abs(own.scale) * change:.3g} {unit}; name a trial or a stretch in which "
                    "nothing happens"
                )
        mean = own.scale * float(values.mean())
        return -mean, f"zero {mean:.4g} ± {abs(own.scale) * float(values.std()):.2g} of {origin}"


def _timed(own: MappedChannel, columns: Mapping[str, Column], table: Table) -> Column:
    """A channel's column, with the times of its own clock where it has one."""
    column = columns[own.column]
    if own.time is not None and own.time in columns:
        # Their unit is by the file's word, or by the last of the column's name.
        unit = table.units.get(own.time) or words_of(own.time)[-1]
        factor = FACTORS["time"].get(spelled(unit) or "s", 1.0)
        seconds = as_read_only(columns[own.time].values * factor)
        return replace(column, time=seconds, time_name=own.time)
    if own.rate_hz is not None:
        return replace(column, time=instants(own.start_s or 0.0, own.rate_hz, len(column.time)))
    if own.start_s is not None and len(column.time):
        return replace(column, time=as_read_only(column.time - column.time[0] + own.start_s))
    return column


def _named(file: str, trial: str | None) -> str:
    return file if trial is None else file.replace(TRIAL, trial)
