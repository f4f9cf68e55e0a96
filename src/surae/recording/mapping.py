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

from surae.base.cleaning import cleaned
from surae.base.errors import InputError, within
from surae.base.files import PathLike, shown
from surae.base.packed import brief
from surae.base.records import from_plain, parse_toml
from surae.recording.corrections import Corrections
from surae.recording.described import TRIAL, MappedRecording, MappedTrial
from surae.recording.formats import open_table
from surae.recording.mapped_reader import MappedReader, column_of
from surae.recording.recording import ROLES, Recording
from surae.recording.source import Source, open_source
from surae.recording.table import some
from surae.recording.times import timed_by
from surae.recording.trials import chosen_trials

#: What a mapping has and nothing else: a channel.
_CHANNELS = re.compile(
    r"""^\s*(?:\[\s*['"]?channels['"]?\s*\.|channels\s*(?:\.|=\s*\{)"""
    r"""|\[\s*['"]?channels['"]?\s*\]\s*(?:#.*\s*)*[\w"']+\s*(?:\.|=\s*\{))""",
    re.MULTILINE,
)
#: How the first line of a TOML file begins: a table, or a key with its equals sign.
_FIRST = re.compile(r"\s*(\[|(?!(?i:sep)=.\s*$)[\w.\"' -]+=)")
#: What a line of [trials] may say of one trial, beside what differs in its channels.
_OF_A_TRIAL = {f.name for f in fields(MappedRecording)} - {"channels", "trials"}


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
        in_trial = any(channel.file is None for channel in self.mapped().channels.values())
        return () if in_trial else tuple(file for file in self.named if TRIAL in file)

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

    def _merged(self, differing: Any, where: str) -> dict[str, Any]:
        """What differs in a trial, put into what holds for all."""
        if not isinstance(differing, dict):
            raise InputError(
                f"{where} is {brief(differing)}; write what differs, as torque.sign = -1"
            )
        merged = {}
        channels = dict(self.toml["channels"])
        opened = self.toml.get("open", ())
        for key, value in differing.items():
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
        time = mapped.time
        table = open_table(open_source(path), timed=False)
        if time is not None and chosen.inside is None:
            table = timed_by(table, *column_of(time), self.source.shown)
        trials = chosen_trials(table, chosen, self.source.shown)
        return dict(zip(trials.names, trials.choices, strict=True))

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
        reader = MappedReader(
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
