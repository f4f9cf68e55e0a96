"""A TOML mapping: which column of which file is which signal, in which unit and direction.

It describes one recording, whose files it names; or every trial of a session: then its channels
have no ``file``, or one with ``{trial}`` in it, and ``[trials]`` says what differs in one of them.
"""

import glob
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, cast

from surae.errors import InputError
from surae.files import PathLike, shown
from surae.recording.mapping_reader import (
    TRIAL,
    Clock,
    MappedChannel,
    Reader,
    brief,
    choice_in,
    day_in,
    finite,
    parsed,
    refuse_unknown,
    settings_in,
    table_in,
    text_in,
    yes_in,
)
from surae.recording.recording import ROLES, Recording
from surae.recording.source import Source
from surae.recording.table import some

_SESSION = ("date", "condition", "notes")
_RECORDING = ("name", "emg", "fixed", "side", "device", "prepare")
_TOP = (*_RECORDING, *_SESSION, "channels", "trials")
#: What a channel with a clock of its own may say of it.
_CLOCK = ("time", "start_s", "rate_hz")
_ENTRY = ("file", "column", "unit", "sign", "scale", "offset", "zero", *_CLOCK)
#: What a line of [trials] may say of one trial, beside what differs in its channels.
_TRIAL = (*_RECORDING, *_SESSION, "effort", "use", *ROLES)
_EMG = ("raw", "envelope")
_SIDES = ("left", "right")
EFFORTS = ("passive", "active", "maximal")

#: How the first line of a TOML file begins: a table, or a key with its equals sign.
_FIRST = re.compile(r"\s*(\[|[\w.\"' -]+=)")


def recognises(source: Source) -> bool:
    """Whether the first line that is no comment is one of TOML."""
    lines = (line for line in source.head() if line.strip() and not line.lstrip().startswith("#"))
    return bool(_FIRST.match(next(lines, "")))


@dataclass(frozen=True, slots=True)
class TrialDescription:
    """What a mapping says of a trial beside its signals; None where it says nothing."""

    #: "passive", "active", "maximal": What the subject did, where the data are not to decide it.
    effort: str | None = None
    use: bool = True  #: False leaves the trial out.
    #: `side`, `date`, `condition`, `notes`: of the leg and the session, or of this trial.
    side: str | None = None
    date: str | None = None
    condition: str | None = None
    notes: str | None = None


@dataclass(frozen=True, slots=True)
class Description:
    """A mapping that was read, to be applied to one recording or to each trial of a session."""

    source: Source  #: The TOML file.
    toml: Mapping[str, Any] = field(repr=False)  #: What it says.

    @classmethod
    def of(cls, source: Source) -> "Description":
        """The mapping in a file, its keys checked."""
        toml = parsed(source)
        _roles(toml, source.shown)
        refuse_unknown(toml, _TOP, source.shown)
        description = cls(source, toml)
        for file in description.named:
            if TRIAL in file and (Path(file).is_absolute() or ".." in Path(file).parts):
                raise InputError(
                    f"{source.shown}: file {file!r} leads out of the folder of the trials; write "
                    "it from there"
                )
        for trial in description.trials:
            where = f"{source.shown}: trials.{trial}"
            refuse_unknown(
                table_in(toml["trials"], trial, f"{source.shown}: trials"), _TRIAL, where
            )
            description.said(trial)
        return description

    @property
    def name(self) -> str | None:
        """What it calls the recording or session."""
        return " ".join((text_in(self.toml, "name", self.source.shown) or "").split()) or None

    @property
    def trials(self) -> tuple[str, ...]:
        """The trials of which it says what differs."""
        return tuple(table_in(self.toml, "trials", self.source.shown))

    @property
    def patterns(self) -> tuple[str, ...]:
        """The names of a trial's files, with ``{trial}`` in them; none where a trial is one file.

        A channel without a file is in the trial's own, which then says which trial it is.
        """
        own = any("file" not in body for body in self._channels() if isinstance(body, dict))
        return () if own else tuple(file for file in self.named if TRIAL in file)

    @property
    def named(self) -> tuple[str, ...]:
        """The names of all files in it."""
        files = (body.get("file") for body in self._channels() if isinstance(body, dict))
        return tuple(dict.fromkeys(file for file in files if isinstance(file, str)))

    def said(self, trial: str | None = None) -> TrialDescription:
        """What it says of a trial, or of all, beside the signals."""
        where = self.source.shown + ("" if trial is None else f": trials.{trial}")
        toml = self._for(trial)
        own = {} if trial is None else table_in(self.toml, "trials", where).get(trial, {})
        return TrialDescription(
            effort=choice_in(own, "effort", EFFORTS, where),
            use=yes_in(own, "use", where),
            side=choice_in(toml, "side", _SIDES, where),
            date=day_in(toml, "date", where),
            condition=text_in(toml, "condition", where),
            notes=text_in(toml, "notes", where),
        )

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

        A channel's values are ``sign * (scale * raw + offset)`` in its unit, then brought to SI.
        Each keeps its own times.

        `trial` is what the session calls the trial, where that is not what its file is called: two
        folders may have files of one name.
        """
        filed, folder = (None, Path(self.source.path).parent)
        if data is not None:
            filed, folder = self.trial_of(data)
        trial = trial or filed
        toml = self._for(trial)
        where = self.source.shown
        inside = "" if trial not in self.trials else f", trials.{trial}"
        entries = [
            _entry(role, body, f"{where}: channels.{role}{inside}")
            for role, body in _roles(toml, where).items()
        ]
        reader = Reader(self.source, folder, filed, None if data is None else Path(data))
        channels = reader.channels(entries)
        read_files = (each.file for each in reader.sources.values())
        files = (*read_files, self.source.file) if data else (self.source.file, *read_files)
        return Recording(
            name=self._name(trial) or self.source.name,
            channels=channels,
            emg=cast("Literal['raw', 'envelope']", choice_in(toml, "emg", _EMG, where) or "raw"),
            fixed={
                name: finite(value, f"{where}: fixed.{brief(name)}")
                for name, value in table_in(toml, "fixed", where).items()
            },
            prepare=settings_in(toml, "prepare", where),
            side=choice_in(toml, "side", _SIDES, where),
            device=settings_in(toml, "device", where),
            files=files,
        )

    def _channels(self) -> list[Any]:
        return list(table_in(self.toml, "channels", self.source.shown).values())

    def _name(self, trial: str | None) -> str | None:
        """A recording's name: a trial's is its own unless the mapping gives it another."""
        if trial is None:
            return self.name
        own = table_in(self.toml, "trials", self.source.shown).get(trial, {})
        return text_in(own, "name", f"{self.source.shown}: trials.{trial}") or trial

    def _for(self, trial: str | None) -> Mapping[str, Any]:
        """What it says of one trial: for all, and what differs."""
        if trial not in self.trials:
            return self.toml
        own = self.toml["trials"][trial]
        merged = dict(self.toml)
        channels = dict(table_in(self.toml, "channels", self.source.shown))
        for key, value in own.items():
            if key not in ROLES:
                both = isinstance(value, dict) and isinstance(merged.get(key), dict)
                merged[key] = {**merged[key], **value} if both else value
            elif value is False:  # this trial has no such channel
                channels.pop(key, None)
            elif isinstance(value, dict):
                channels[key] = {**channels.get(key, {}), **value}
            else:
                raise InputError(
                    f"{self.source.shown}: trials.{trial}.{key} is {brief(value)}; write what "
                    f"differs, as {key}.sign = -1, or {key} = false where it has none"
                )
        return {**merged, "channels": channels}


def read_mapping(source: Source, data: PathLike | None = None) -> Recording:
    """The recording that a TOML file describes, or makes of a data file; see `Description.read`."""
    return Description.of(source).read(data)


def _hidden(path: Path, folder: PathLike) -> bool:
    """Whether a file, or a folder that it is in, is one that systems keep for themselves."""
    return any(part.startswith(".") for part in path.relative_to(folder).parts)


def _pattern(name: str) -> re.Pattern[str]:
    """What a file's name with ``{trial}`` in it stands for; the same wherever it comes again."""
    first, *rest = (re.escape(part) for part in Path(name).as_posix().split(TRIAL))
    return re.compile(first + "(?P<trial>[^/]+)" + "(?P=trial)".join(rest))


def _roles(toml: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The descriptions by role, the angle among them."""
    if "channels" not in toml:
        raise InputError(
            f"{where}: no channels: a recording's TOML has [channels.angle] with file, column and "
            "unit, and likewise torque, emg_ta, ..."
        )
    roles = table_in(toml, "channels", where)
    refuse_unknown(roles, ROLES, f"{where}: channels")
    if "angle" not in roles:
        raise InputError(f"{where}: channels.angle is missing; every recording needs the angle")
    return roles


def _entry(role: str, body: Any, where: str) -> MappedChannel:
    """Read one channel's description."""
    if not isinstance(body, dict):
        raise InputError(f"{where}: must be a table with: {', '.join(_ENTRY)}")
    refuse_unknown(body, _ENTRY, where)
    column = text_in(body, "column", where)
    if not column:
        raise InputError(f"{where}: column is missing")
    file = text_in(body, "file", where)
    if file == "":
        raise InputError(f"{where}: file is empty; name it, or leave it out")
    sign = body.get("sign", 1)
    if isinstance(sign, bool) or sign not in (1, -1):
        raise InputError(f"{where}: sign is {brief(sign)}; use 1 or -1")
    scale = finite(body.get("scale", 1.0), f"{where}: scale")
    if scale == 0:
        raise InputError(f"{where}: scale is 0, which would erase the signal")
    if "zero" in body and "offset" in body:
        raise InputError(f"{where}: zero and offset both say where the zero is; give one")
    start, rate = (finite(body[k], f"{where}: {k}") if k in body else None for k in _CLOCK[1:])
    if rate is not None and rate <= 0.0:
        raise InputError(f"{where}: rate_hz is {rate:g}; it must be above 0")
    if "time" in body and (start is not None or rate is not None):
        raise InputError(f"{where}: time and start_s or rate_hz both say when; give one")
    return MappedChannel(
        role=role,
        where=where,
        file=file,
        column=column,
        unit=text_in(body, "unit", where),
        sign=int(sign),
        scale=scale,
        offset=finite(body.get("offset", 0.0), f"{where}: offset"),
        zero=_zero_of(body.get("zero"), f"{where}: zero"),
        clock=Clock(text_in(body, "time", where), start, rate),
    )


def _zero_of(value: Any, where: str) -> str | tuple[float, float] | None:
    """A file, or a start and an end [s]."""
    if value is None or (isinstance(value, str) and value):
        return value
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(
            f'{where} is {brief(value)}; name a quiet trial, as "Pas_0.mat", or a quiet stretch '
            "of this one, as [0.0, 2.0] in s"
        )
    start, end = (finite(item, where) for item in value)
    if end <= start:
        raise InputError(f"{where}: {start:g} to {end:g} s is no stretch of time")
    return start, end
