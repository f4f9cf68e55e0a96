"""Values of a mapping, of their types or refused in a line, and its files: each is read once."""

import datetime
import difflib
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from surae.errors import InputError
from surae.files import shown
from surae.frozen import as_read_only
from surae.recording.channels import Scaling, channel, settle_unit
from surae.recording.formats import open_table
from surae.recording.recording import Channel
from surae.recording.roles import words_of
from surae.recording.samples import instants
from surae.recording.source import Source, open_source
from surae.recording.table import Column, Table, some
from surae.units import FACTORS, spelled, to_si


def parsed(source: Source) -> dict[str, Any]:
    """Parse the TOML's content."""
    source.require_text()
    try:
        return tomllib.loads("".join(source.lines()))
    except ValueError as error:
        # Beside tomllib's own error: Python's, of a number with thousands of digits.
        raise InputError(f"{source.shown}: not valid TOML: {error}") from None
    except RecursionError:
        raise InputError(f"{source.shown}: not valid TOML: nested too deeply") from None


def refuse_unknown(table: Mapping[str, Any], allowed: Sequence[str], where: str) -> None:
    """Refuse keys that aren't in `allowed`."""
    for key in table:
        if key not in allowed:
            raise InputError(f"{where}: key {brief(key)} is not known; use: {', '.join(allowed)}")


def table_in(table: Mapping[str, Any], key: str, where: str) -> dict[str, Any]:
    """A table within a table, empty where it is left out."""
    value = table.get(key, {})
    if not isinstance(value, dict):
        raise InputError(f"{where}: {key} must be a table of names and values")
    return value


def text_in(table: Mapping[str, Any], key: str, where: str) -> str | None:
    """A string, None where it is left out."""
    value = table.get(key)
    if value is not None and not isinstance(value, str):
        raise InputError(f"{where}: {key} is {brief(value)}; it must be a text in quotes")
    return value


def day_in(table: Mapping[str, Any], key: str, where: str) -> str | None:
    """A date as ISO text, None where it is left out; TOML's own dates need no quotes."""
    value = table.get(key)
    if isinstance(value, datetime.date):
        return value.isoformat()
    return text_in(table, key, where)


def yes_in(table: Mapping[str, Any], key: str, where: str) -> bool:
    """A truth value, True where it is left out."""
    value = table.get(key, True)
    if not isinstance(value, bool):
        raise InputError(f"{where}: {key} is {brief(value)}; it must be true or false")
    return value


def choice_in(table: Mapping[str, Any], key: str, allowed: Sequence[str], where: str) -> str | None:
    """One of a few words, None where it is left out."""
    value = table.get(key)
    if value is not None and value not in allowed:
        raise InputError(f"{where}: {key} is {brief(value)}; use one of: {', '.join(allowed)}")
    return cast("str | None", value)


def finite(value: Any, where: str) -> float:
    """Check that a value is a finite number, and give it."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{where} is {brief(value)}; it must be a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InputError(f"{where} is {brief(value)}; it must be a finite number")
    return number


def settings_in(toml: Mapping[str, Any], key: str, where: str) -> dict[str, Any]:
    """A table of plain values, which whoever uses them knows by name."""
    return {
        name: plain(value, f"{where}: {key}.{brief(name)}")
        for name, value in table_in(toml, key, where).items()
    }


def plain(value: Any, where: str) -> Any:
    """A text, number or truth value, or a tuple of them."""
    if isinstance(value, list):
        return tuple(plain(item, where) for item in value)
    if isinstance(value, float):
        return finite(value, where)
    if not isinstance(value, str | int):
        raise InputError(f"{where} must be a text, a number, true, false, or a list of these")
    return value


def brief(value: Any) -> str:
    """A value as it appears in a message."""
    try:
        shown = repr(value)
    except ValueError:
        return "a number with thousands of digits"
    return shown if len(shown) <= 60 else shown[:57] + "..."


#: What stands for the trial's name in the name of a file.
TRIAL = "{trial}"
#: What gives a zero may change, from one part of so long [s] to another, by this part of the
#: signal's own range, or by what a sensor's noise and a leg at rest bring: 1° and 1 Nm in SI.
_PART, _QUIET, _REST = 0.1, 0.05, {"angle": 0.0175, "torque": 1.0}


@dataclass(frozen=True, slots=True)
class Clock:
    """When the samples of a channel were taken, where its file does not say it."""

    time: str | None = None  #: The column of its file that has their times.
    start_s: float | None = None  #: Time of the first sample [s].
    rate_hz: float | None = None  #: Samples a second.

    def set(self, column: Column, columns: Mapping[str, Column], factor: float) -> Column:
        """A column with these times; `factor` brings those of a column to seconds."""
        seconds = column.time
        if self.time is not None and self.time in columns:
            seconds = as_read_only(columns[self.time].values * factor)
            return replace(column, time=seconds, time_name=self.time)
        if self.rate_hz is not None:
            start = 0.0 if self.start_s is None else self.start_s
            return replace(column, time=instants(start, self.rate_hz, len(seconds)))
        if self.start_s is not None and len(seconds):
            return replace(column, time=as_read_only(seconds - seconds[0] + self.start_s))
        return column


@dataclass(frozen=True, slots=True)
class MappedChannel:
    """One channel's description, checked on its own."""

    role: str
    where: str
    file: str | None
    column: str
    unit: str | None
    sign: int
    scale: float
    offset: float
    zero: str | tuple[float, float] | None
    clock: Clock


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

    def channels(self, entries: list[MappedChannel]) -> dict[str, Channel]:
        """The channels that are described, in SI units."""
        paths = self._paths(entries)
        units: dict[str, str] = {}
        wanted: dict[Path, list[str]] = {}
        for entry in entries:
            table = self._table(paths[entry.role], entry)
            units[entry.role] = settle_unit(
                table, entry.role, entry.column, entry.unit, entry.where
            )
            names = wanted.setdefault(paths[entry.role], [])
            clock = entry.clock.time
            if clock is not None and clock not in (*table.names, table.time_name):
                raise InputError(
                    f"{entry.where}: time: {table.file} has no column {some([clock])}; it has: "
                    f"{some(table.names)}"
                )
            names += [
                each for each in (entry.column, clock) if each in table.names and each not in names
            ]
        columns = {path: self.tables[path].load(names) for path, names in wanted.items()}
        channels: dict[str, Channel] = {}
        for entry in entries:
            path = paths[entry.role]
            table = self.tables[path]
            factor = _seconds(table, entry.clock.time)
            column = entry.clock.set(columns[path][entry.column], columns[path], factor)
            offset, note = entry.offset, ""
            if entry.zero is not None:
                offset, note = self._zero(entry, column, units[entry.role])
            scaling = Scaling(units[entry.role], entry.sign, entry.scale, offset, note)
            channels[entry.role] = channel(entry.role, column, scaling, table)
        return channels

    def _paths(self, entries: list[MappedChannel]) -> dict[str, Path]:
        """The file of every channel."""
        named = {entry.file for entry in entries}
        # A description of one file, given for another: it is the layout that is meant.
        layout = self.data is not None and len(named) == 1 and TRIAL not in str(named)
        paths = {}
        for entry in entries:
            if self.data is not None and (layout or entry.file is None):
                paths[entry.role] = self.data
            elif entry.file is None or (self.trial is None and TRIAL in entry.file):
                lacks = "file is missing" if entry.file is None else f"file is {entry.file!r}"
                raise InputError(
                    f"{entry.where}: {lacks}: name the file, or give this mapping of many files "
                    "by --mapping, with the files"
                )
            elif self.trial is not None and TRIAL not in entry.file:
                raise InputError(
                    f"{entry.where}: file {entry.file!r} is one and the same for all trials; "
                    'write it with "{trial}", or leave `file` out'
                )
            else:
                paths[entry.role] = self.folder / _named(entry.file, self.trial)
        return paths

    def _table(self, path: Path, entry: MappedChannel) -> Table:
        """A data file's table that has the channel's column; errors say where it is named."""
        if path not in self.tables:
            try:
                self.sources[path] = open_source(path)
                timed = entry.clock.rate_hz is None and entry.clock.time is None
                self.tables[path] = open_table(self.sources[path], timed=timed)
            except InputError as error:
                raise InputError(f"{entry.where}: {error}") from None
        table = self.tables[path]
        count = table.names.count(entry.column)
        if count > 1:
            raise InputError(
                f"{entry.where}: {table.file} has {count} columns {some([entry.column])}; "
                "rename one"
            )
        if count == 0:
            near = difflib.get_close_matches(entry.column, table.names, n=3, cutoff=0.5)
            has = f"did you mean {some(near)}?" if near else f"it has: {some(table.names)}"
            raise InputError(
                f"{entry.where}: {table.file} has no column {some([entry.column])}; {has}"
            )
        return table

    def _zero(self, entry: MappedChannel, column: Column, unit: str) -> tuple[float, str]:
        """The offset that takes a quiet trial or stretch to zero, and what to say of it."""
        where, zero = f"{entry.where}: zero", entry.zero
        quiet, origin = column, "itself"
        if isinstance(zero, str):
            path = self.folder / _named(zero, self.trial)
            if not path.exists():
                path = Path(self.source.path).parent / _named(zero, self.trial)
            quiet = self._table(path, entry).load([entry.column])[entry.column]
            origin = shown(path.name)
        time, values = quiet.time, quiet.values
        if isinstance(zero, tuple):
            start, end = zero
            origin = f"{start:g} to {end:g} s"
            inside = (time >= start) & (time <= end)
            time, values = time[inside], values[inside]
        if len(values) < 2 or not np.isfinite(values).all():
            raise InputError(f"{where}: {origin} holds no finite samples of {entry.column!r}")
        if entry.role in _REST:
            parts = min(max(round(float(time[-1] - time[0]) / _PART), 2), len(values))
            means = [float(part.mean()) for part in np.array_split(values, parts)]
            change, factor = max(means) - min(means), abs(entry.scale) * to_si(entry.role, unit, "")
            range_ = float(np.ptp(column.values[np.isfinite(column.values)]))
            if change > _QUIET * range_ and factor * change > _REST[entry.role]:
                raise InputError(
                    f"{where}: {entry.column!r} is not quiet in {origin}: it changes by "
                    f"{abs(entry.scale) * change:.3g} {unit}; name a trial or a stretch in which "
                    "nothing happens"
                )
        mean = entry.scale * float(values.mean())
        return -mean, f"zero {mean:.4g} ± {abs(entry.scale) * float(values.std()):.2g} of {origin}"


def _seconds(table: Table, column: str | None) -> float:
    """What brings the times in a column to seconds: by the file's word, or by its name's last."""
    if column is None:
        return 1.0
    said = table.units.get(column) or words_of(column)[-1]
    return FACTORS["time"].get(spelled(said) or "s", 1.0)


def _named(file: str, trial: str | None) -> str:
    return file if trial is None else file.replace(TRIAL, trial)
