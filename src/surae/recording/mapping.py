"""A TOML mapping: which column of which file is which signal, in which unit and direction.

It describes one recording, whose files it names; or every trial of a session: then its channels
have no ``file``, or one with ``{trial}`` in it, and ``[trials]`` says what differs in one of them.
What it may say is written in `surae.recording.described`.
"""

import datetime
import glob
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from surae.errors import InputError
from surae.files import PathLike, shown
from surae.recording.described import MappedRecording
from surae.recording.mapping_reader import TRIAL, Reader
from surae.recording.recording import ROLES, Recording
from surae.recording.source import Source
from surae.recording.table import some
from surae.records import brief, from_plain

#: How the first line of a TOML file begins: a table, or a key with its equals sign.
_FIRST = re.compile(r"\s*(\[|[\w.\"' -]+=)")
#: What a line of [trials] may say of one trial, beside what differs in its channels.
_OF_A_TRIAL = {f.name for f in fields(MappedRecording)} - {"channels", "trials"}


def recognises(source: Source) -> bool:
    """Whether the first line that is no comment is one of TOML."""
    lines = (line for line in source.head() if line.strip() and not line.lstrip().startswith("#"))
    return bool(_FIRST.match(next(lines, "")))


@dataclass(frozen=True, slots=True)
class Description:
    """A mapping that was read, to be applied to one recording or to each trial of a session."""

    source: Source  #: The TOML file.
    toml: Mapping[str, Any] = field(repr=False)  #: What it says.

    @classmethod
    def of(cls, source: Source) -> "Description":
        """The mapping in a file, all of it checked."""
        description = cls(source, _parsed(source))
        if "channels" not in description.toml:
            raise InputError(
                f"{source.shown}: no channels: a recording's TOML has [channels.angle] with file, "
                "column and unit, and likewise torque, emg_ta, ..."
            )
        whole = description.mapped()
        for file in description.named:
            if TRIAL in file and (Path(file).is_absolute() or ".." in Path(file).parts):
                raise InputError(
                    f"{source.shown}: file {file!r} leads out of the folder of the trials; write "
                    "it from there"
                )
        for trial in whole.trials:
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
        where, table = self.source.shown, dict(self.toml)
        if trial is not None:
            table.pop("name", None)
        if trial in self.trials:
            where += f": trials.{shown(trial)}"
            table |= self._merged(self.toml["trials"][trial], where)
        for key in ("name", "date"):
            if isinstance(table.get(key), datetime.date):  # which TOML writes without quotes
                table[key] = table[key].isoformat()
            elif isinstance(table.get(key), str):
                table[key] = " ".join(table[key].split()) or None
        try:
            return from_plain(MappedRecording, table)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None

    def _merged(self, own: Any, where: str) -> dict[str, Any]:
        """What differs in a trial, put into what holds for all."""
        if not isinstance(own, dict):
            raise InputError(f"{where} is {brief(own)}; write what differs, as torque.sign = -1")
        merged, channels = {}, dict(self.toml["channels"])
        for key, value in own.items():
            both = isinstance(value, dict) and isinstance(self.toml.get(key), dict)
            if key in _OF_A_TRIAL:
                merged[key] = {**self.toml[key], **value} if both else value
            elif key not in ROLES:
                known = ", ".join((*sorted(_OF_A_TRIAL), *ROLES))
                raise InputError(f"{where}: key {brief(key)} is not known; use: {known}")
            elif value is False:  # this trial has no such channel
                channels.pop(key, None)
            elif isinstance(value, dict):
                channels[key] = {**channels.get(key, {}), **value}
            else:
                raise InputError(
                    f"{where}.{key} is {brief(value)}; write what differs, as {key}.sign = -1, or "
                    f"{key} = false where it has none"
                )
        return {**merged, "channels": channels}

    def files(self, folder: PathLike) -> tuple[Path, ...]:
        """The data files in a folder that its ``{trial}`` stands for; none where it has none."""
        if not self.patterns:
            return ()
        # Every sign but the trial's name stands for itself.
        parts = Path(self.patterns[0]).parts
        names = [glob.escape(part).replace(glob.escape(TRIAL), "*") for part in parts]
        paths = Path(folder).glob("/".join(names))
        return tuple(sorted(path for path in paths if not _hidden(path, folder)))

    def trial_of(self, data: PathLike) -> tuple[str, Path]:
        """The name of the trial that a data file is of, and the folder of its files."""
        path = Path(data)
        for pattern in self.patterns:
            depth = len(Path(pattern).parts)
            tail = Path(*path.parts[-depth:]).as_posix()
            if match := _pattern(pattern).fullmatch(tail):
                return match["trial"], path.parents[depth - 1]
        if self.patterns:
            raise InputError(
                f"{shown(data)}: {self.source.shown} names files {some(self.patterns)}, and this "
                "is none of them; leave `file` out if each trial is one file"
            )
        return shown(path.stem), path.parent

    def read(self, data: PathLike | None = None, trial: str | None = None) -> Recording:
        """The recording that the mapping describes, or that it makes of a trial's data file.

        Each channel keeps its own times. `trial` is what the session calls the trial, where that is
        not what its file is called: two folders may have files of one name.
        """
        filed, folder = (None, Path(self.source.path).parent)
        if data is not None:
            filed, folder = self.trial_of(data)
        trial = trial or filed
        mapped = self.mapped(trial)
        reader = Reader(self.source, folder, filed, None if data is None else Path(data))
        channels = reader.channels(mapped.channels)
        read_files = (each.file for each in reader.sources.values())
        files = (*read_files, self.source.file) if data else (self.source.file, *read_files)
        return Recording(
            mapped.name or trial or self.source.name, channels, mapped.emg, mapped.fixed,
            mapped.prepare, files, mapped.side, mapped.device,
        )  # fmt: skip


def read_mapping(source: Source, data: PathLike | None = None) -> Recording:
    """The recording that a TOML file describes, or makes of a data file; see `Description.read`."""
    return Description.of(source).read(data)


def _parsed(source: Source) -> dict[str, Any]:
    source.require_text()
    try:
        return tomllib.loads("".join(source.lines()))
    except ValueError as error:
        # Beside tomllib's own error: Python's, of a number with thousands of digits.
        raise InputError(f"{source.shown}: not valid TOML: {error}") from None
    except RecursionError:
        raise InputError(f"{source.shown}: not valid TOML: nested too deeply") from None


def _hidden(path: Path, folder: PathLike) -> bool:
    """Whether a file, or a folder that it is in, is one that systems keep for themselves."""
    return any(part.startswith(".") for part in path.relative_to(folder).parts)


def _pattern(name: str) -> re.Pattern[str]:
    """What a file's name with ``{trial}`` in it stands for; the same wherever it comes again."""
    first, *rest = (re.escape(part) for part in Path(name).as_posix().split(TRIAL))
    return re.compile(first + "(?P<trial>[^/]+)" + "(?P=trial)".join(rest))
