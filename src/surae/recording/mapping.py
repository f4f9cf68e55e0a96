"""A TOML mapping: which column of which file is which signal, in which unit and direction.

It describes one recording, whose files it names; or every trial of a session: then its channels
have no ``file``, or one with ``{trial}`` in it, and ``[trials]`` says what differs in one of them.
What it may say is written in `surae.recording.described`.
"""

import datetime
import difflib
import glob
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from surae.base.cleaning import cleaned
from surae.base.errors import InputError, within
from surae.base.files import PathLike, shown
from surae.base.frozen import as_read_only, freeze
from surae.base.packed import brief
from surae.base.records import from_plain, parse_toml
from surae.base.units import to_si
from surae.recording.channels import Scaling, channel, settle_unit
from surae.recording.corrections import Corrections
from surae.recording.described import MappedChannel, MappedRecording, MappedTime, MappedTrial
from surae.recording.formats import open_table
from surae.recording.recording import ROLES, Channel, Recording
from surae.recording.source import Source, open_source
from surae.recording.table import Column, Table, fallbacks, instants, some
from surae.recording.times import timed_by
from surae.recording.trials import chosen_trials, one_trial

#: What a mapping has and nothing else: a channel.
_CHANNELS = re.compile(r"""^\s*(?:\[\s*['"]?channels['"]?\s*[.\]]|channels\s*[.=])""", re.MULTILINE)
#: How the first line of a TOML file begins: a table, or a key with its equals sign.
_FIRST = re.compile(r"\s*(\[|(?!(?i:sep)=.\s*$)[\w.\"' -]+=)")
#: What stands for the trial's name in the name of a file.
TRIAL = "{trial}"
#: What a line of [trials] may say of one trial, beside what differs in its channels.
_OF_A_TRIAL = {f.name for f in fields(MappedRecording)} - {"channels", "trials"}
#: What gives a zero may change, from one part of so long [s] to another, by this part of the
#: signal's own range, or by what a sensor's noise and a leg at rest bring: 1° and 1 Nm in SI.
_PART = 0.1
_QUIET = 0.05
_REST = {"angle": 0.0175, "torque": 1.0}


def recognises(source: Source) -> bool:
    """Whether its first line is one of TOML, and it has channels, or else TOML alone."""
    lines = (line for line in source.head() if line.strip() and not line.lstrip().startswith("#"))
    if not _FIRST.match(next(lines, "")):
        return False
    text = "\n".join(source.head())
    if _CHANNELS.search(text):
        return True
    try:
        tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError):
        return False
    return True


@dataclass(frozen=True, slots=True)
class Description:
    """A mapping that was read, to be applied to one recording or to each trial of a session."""

    source: Source  #: The TOML file.
    toml: Mapping[str, Any] = field(repr=False)  #: What it says.
    #: What it says of every trial, once it was asked: thousands of files are looked at with it.
    _whole: list[MappedRecording] = field(default_factory=list, repr=False, compare=False)

    @classmethod
    def of(cls, source: Source) -> "Description":
        """The mapping in a file, all of it checked."""
        source.require_text()
        with within(source.shown):
            description = cls(source, parse_toml("".join(source.lines())))
        if "channels" not in description.toml:
            raise InputError(
                f"{source.shown}: no channels: a recording's TOML has [channels.angle] with file, "
                "column and unit, and likewise torque, emg_ta, ..."
            )
        for file in description.named:
            if TRIAL in file and (Path(file).is_absolute() or ".." in Path(file).parts):
                raise InputError(
                    f"{source.shown}: file {file!r} leads out of the folder of the trials; write "
                    "it from there"
                )
        for trial in description.trials:
            description.mapped(trial)
        return description

    @property
    def name(self) -> str | None:
        """What it calls the recording or session."""
        return self.mapped().name

    @property
    def trials(self) -> tuple[str, ...]:
        """The trials of which it says what differs."""
        return tuple(self.toml.get("trials", ()))

    @property
    def patterns(self) -> tuple[str, ...]:
        """The names of a trial's files, with ``{trial}`` in them; none where a trial is one file.

        A channel without a file is in the trial's own, which then says which trial it is.
        """
        own = any(channel.file is None for channel in self.mapped().channels.values())
        return () if own else tuple(file for file in self.named if TRIAL in file)

    @property
    def named(self) -> tuple[str, ...]:
        """The names of all files in it."""
        files = (channel.file for channel in self.mapped().channels.values())
        return tuple(dict.fromkeys(file for file in files if file is not None))

    def mapped(self, trial: str | None = None) -> MappedRecording:
        """The mapped recording of a trial, or of every one."""
        if trial is None and self._whole:
            return self._whole[0]
        where = self.source.shown
        table = dict(self.toml)
        if trial is not None:
            table.pop("name", None)
            table["trials"] = {}
        if trial in self.toml.get("trials", ()):
            where += f": trials.{shown(str(trial))}"
            table |= self._merged(self.toml["trials"][trial], where)
        for key in ("name", "date", "condition", "notes"):
            if isinstance(table.get(key), datetime.date):  # which TOML writes without quotes
                table[key] = table[key].isoformat()
            elif isinstance(table.get(key), str):
                table[key] = " ".join(cleaned(table[key]).split()) or None
        with within(where):
            made = from_plain(MappedRecording, table)
        if trial is None:
            self._whole.append(made)
        return made

    def _merged(self, own: Any, where: str) -> dict[str, Any]:
        """What differs in a trial, put into what holds for all."""
        if not isinstance(own, dict):
            raise InputError(f"{where} is {brief(own)}; write what differs, as torque.sign = -1")
        merged = {}
        channels = dict(self.toml["channels"])
        opened = self.toml.get("open", ())
        for key, value in own.items():
            both = isinstance(value, dict) and isinstance(self.toml.get(key), dict)
            if key in _OF_A_TRIAL:
                merged[key] = {**self.toml[key], **value} if both else value
            elif key not in ROLES:
                known = ", ".join((*sorted(_OF_A_TRIAL), *ROLES))
                raise InputError(f"{where}: key {brief(key)} is not known; use: {known}")
            elif value is False:  # this trial has no such channel
                channels.pop(key, None)
                merged["open"] = [role for role in merged.get("open", opened) if role != key]
            elif isinstance(value, dict):
                channels[key] = {**channels.get(key, {}), **value}
            else:
                raise InputError(
                    f"{where}.{key} is {brief(value)}; write what differs, as {key}.sign = -1, or "
                    f"{key} = false where it has none"
                )
        return {**merged, "channels": channels}

    def files(self, folder: PathLike) -> tuple[Path, ...]:
        """The data files in a folder that ``{trial}`` stands for, if any; no hidden ones."""
        if not self.patterns:
            return ()
        # Every sign but the trial's name stands for itself.
        parts = Path(self.patterns[0]).parts
        names = [glob.escape(part).replace(glob.escape(TRIAL), "*") for part in parts]
        return tuple(
            path
            for path in sorted(Path(folder).glob("/".join(names)))
            if not any(part.startswith(".") for part in path.relative_to(folder).parts)
        )

    def trial_of(self, data: PathLike) -> tuple[str, Path]:
        """The name of the trial that a data file is of, and the folder of its files."""
        path = Path(data)
        for pattern in self.patterns:
            depth = len(Path(pattern).parts)
            # The trial's name is the same wherever it comes again.
            first, *rest = (re.escape(part) for part in Path(pattern).as_posix().split(TRIAL))
            name = first + "(?P<trial>[^/]+)" + "(?P=trial)".join(rest)
            if match := re.fullmatch(name, Path(*path.parts[-depth:]).as_posix()):
                return match["trial"], path.parents[depth - 1]
        if self.patterns:
            raise InputError(
                f"{shown(data)}: {self.source.shown} names files {some(self.patterns)}, and this "
                "is none of them; leave `file` out if each trial is one file"
            )
        return shown(path.stem), path.parent

    def within(self, data: PathLike | None = None) -> dict[str, MappedTrial]:
        """The trials in one file by their names, where the mapping reads them all; else none."""
        mapped = self.mapped(None if data is None else self.trial_of(data)[0])
        chosen = mapped.trial
        if chosen is None or not chosen.several:
            return {}
        folder = Path(self.source.path).parent if data is None else self.trial_of(data)[1]
        first = next(iter(self.mapped().channels.values()))
        path = Path(data) if data is not None else folder / str(first.file)
        own = mapped.time
        table = open_table(open_source(path), timed=False)
        if own is not None and chosen.inside is None:
            table = timed_by(table, *_column_of(own), self.source.shown)
        found = chosen_trials(table, chosen, self.source.shown)
        return dict(zip(found.names, found.choices, strict=True))

    def read(
        self,
        data: PathLike | None = None,
        trial: str | None = None,
        chosen: MappedTrial | None = None,
        *,
        emg_alone: bool = False,
    ) -> Recording:
        """The recording that the mapping describes, or that it makes of a trial's data file.

        Each channel keeps its own times. `trial` is what the session calls the trial, where that is
        not what its file is called: two folders may have files of one name. Of several trials in
        one file `chosen` says which.
        """
        filed = None
        folder = Path(self.source.path).parent
        if data is not None:
            filed, folder = self.trial_of(data)
        trial = trial or filed
        mapped = self.mapped(trial)
        chosen = chosen or mapped.trial
        if "angle" not in mapped.channels and not emg_alone:
            raise InputError(
                f"{self.source.shown}: channels.angle is missing; every recording needs the angle, "
                "but one of maximum contractions"
            )
        reader = _Reader(
            self.source, folder, filed, None if data is None else Path(data), mapped.time, chosen
        )
        channels = reader.channels(mapped.channels)
        read_files = (source.file for source, _ in reader.opened.values())
        files = (*read_files, self.source.file) if data else (self.source.file, *read_files)
        recording = Recording(
            mapped.name or trial or self.source.name,
            channels,
            mapped.emg,
            mapped.fixed,
            mapped.prepare,
            files,
            mapped.side,
            mapped.device,
        )
        return Corrections(swap=mapped.swap)(recording)


@dataclass(frozen=True, slots=True)
class _Reader:
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
        for role, own in described.items():
            table = tables[role]
            if own.time is not None:
                tables[role] = timed_by(table, *_column_of(own.time), self._at(role))
        columns = self._loaded(described, tables)
        channels: dict[str, Channel] = {}
        for role, own in described.items():
            table = tables[role]
            unit = settle_unit(table, role, own.column, own.unit, self._at(role))
            column = _timed(own, columns[role], table, self._at(role))
            if own.wrap is not None:
                column = replace(column, values=freeze(np.unwrap(column.values, period=own.wrap)))
            offset = own.offset
            note = ""
            if own.zero is not None:
                offset, note = self._zero(role, own, own.zero, column, unit)
            scaling = Scaling(unit, own.sign, own.scale, offset, note, own.bridge_s)
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
        named = {own.file for own in described.values()}
        # A description of one file, given for another: it is the layout that is meant.
        layout = self.data is not None and len(named) == 1 and TRIAL not in str(named)
        tables = {}
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
                path = self.folder / self._named(own.file)
            tables[role] = self._table(path, own, where)
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
            column, unit = _column_of(self.time)
            # Of several files one may have its own times.
            if column in (*table.names, table.time_name) or not table.time_name:
                table = timed_by(table, column, unit, self.source.shown)
        if chosen is not None and chosen.inside is None:
            table = one_trial(table, chosen, self.source.shown)
        return table

    def _table(self, path: Path, own: MappedChannel, where: str, *, quiet: bool = False) -> Table:
        """A data file's table that has the channel's column; errors say where it is named."""
        if path not in self.opened:
            with within(where):
                source = open_source(path)
                table = open_table(source, timed=False)
            self.opened[path] = source, self._arranged(table, quiet)
        table = self.opened[path][1]
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
            path = self.folder / self._named(zero)
            if not path.exists():
                path = Path(self.source.path).parent / self._named(zero)
            quiet = self._table(path, own, where, quiet=True).load([own.column])[own.column]
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
            raise InputError(f"{where}: {origin} holds no finite samples of {own.column!r}")
        if role in _REST:
            parts = min(max(round(float(time[-1] - time[0]) / _PART), 2), len(values))
            means = [float(part.mean()) for part in np.array_split(values, parts)]
            change = max(means) - min(means)
            factor = abs(own.scale) * to_si(role, unit, "")
            range_ = float(np.ptp(column.values[np.isfinite(column.values)]))
            if change > _QUIET * range_ and factor * change > _REST[role]:
                raise InputError(
                    f"{where}: {own.column!r} is not quiet in {origin}: it changes by "
                    f"{abs(own.scale) * change:.3g} {unit}; name a trial or a stretch in which "
                    "nothing happens"
                )
        mean = own.scale * float(values.mean())
        return -mean, f"zero {mean:.4g} ± {abs(own.scale) * float(values.std()):.2g} of {origin}"


def _column_of(time: str | MappedTime) -> tuple[str, str | None]:
    """The column of times that a mapping says, and its unit."""
    return (time, None) if isinstance(time, str) else (time.column, time.unit)


def _timed(own: MappedChannel, column: Column, table: Table, where: str) -> Column:
    """A channel's column, with the times of its own clock where it has one."""
    if own.rate_hz is not None:
        if column.time_name and (n := len(fallbacks(column.time))):
            raise InputError(
                f"{where}: {table.file} holds {n + 1} trials, whose times fall back: rate_hz would "
                "join them; say which with trial = { column = … } or { index = … }, at the top"
            )
        even = instants(own.start_s or 0.0, own.rate_hz, len(column.time))
        return _clocked(replace(column, time=even), own)
    if not column.time_name:
        raise InputError(
            f"{where}: {table.file} has no times of {own.column!r}: give start_s, when the "
            "recording's clock shows its first sample, and rate_hz, its samples a second"
        )
    if own.start_s is not None and len(column.time):
        column = replace(column, time=as_read_only(column.time - column.time[0] + own.start_s))
    return _clocked(column, own)


def _clocked(column: Column, own: MappedChannel) -> Column:
    """A column whose clock is slow or fast, in true time; a first instant that is given is true."""
    if not own.clock_ppm or not len(column.time):
        return column
    true = 0.0 if own.start_s is None else own.start_s
    time = true + (column.time - true) / (1.0 + 1e-6 * own.clock_ppm)
    said = f"clock {own.clock_ppm:g} ppm {'fast' if own.clock_ppm > 0 else 'slow'}, corrected"
    remark = "; ".join(filter(None, (column.remark, said)))
    return replace(column, time=as_read_only(time), remark=remark)
