"""Uploaded files to recordings: looked into, mapped by the user, read, kept.

Files lie under names that we made; readers see them under the names their user gave, in a folder
made for the occasion, so that their messages name what the user knows, and nothing else is in
reach: a mapping can only name files that were uploaded.
"""

import os
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from surae import api
from surae.base.errors import InputError
from surae.base.records import to_plain
from surae.base.units import FloatArray
from surae.base.words import Message

#: The description that we write beside the files.
_MAPPING = "mapping.toml"
#: Longest name of a file [bytes]; a number may come before it.
_LONGEST = 160
#: Names that Windows takes for devices, whatever their ending.
_RESERVED = re.compile(r"(con|prn|aux|nul|com[0-9¹²³]|lpt[0-9¹²³]|conin\$|conout\$) *(\.|$)", re.I)
#: What says when the first frame of a film was, and how fast they follow.
CLOCK = ("time", "start_s", "rate_hz")
#: What the form is told of a column.
COLUMN = ("low", "high", "usable", "bridge_s", "scale")
#: What else a mapping says of a channel, as the form does.
KEPT = ("column", "unit", "sign", "scale", "offset", "bridge_s", "clock_ppm")
#: Signals that must be settled: measured, or left out aloud.
NEEDED = api.ROLES[:6]
#: Points of a preview, and of torque over angle.
_PREVIEW = 200
_LOOP = 400

#: An uploaded file: `id`, `path` and the `name` its user gave.
Upload = Mapping[str, str]


def file_name(name: str, number: int = 0) -> str:
    """A user's file name without folders or anything that means something to a system."""
    base = name.replace("\\", "/").rsplit("/", 1)[-1]
    plain = "".join(c if c.isalnum() or c in " ._-()+" else "_" for c in base).strip(" .")
    while len(plain.encode()) > _LONGEST:  # systems count bytes; the end says what it is
        plain = plain[1:]
    plain = plain.lstrip(" .") or "file"
    if plain == _MAPPING or _RESERVED.match(plain):
        plain = f"given-{plain}"
    return f"{number}-{plain}" if number else plain


@contextmanager
def _folder(files: Sequence[Upload]) -> Iterator[dict[str, str]]:
    """The files under their users' names, in the current folder; the names by upload id."""
    before = Path.cwd()
    folder = Path(tempfile.mkdtemp(prefix="import-", dir=Path(files[0]["path"]).parent))
    try:
        names: dict[str, str] = {}
        for upload in files:
            name = file_name(upload["name"])
            number = 2
            while name in names.values():
                name = file_name(upload["name"], number)
                number = number + 1
            names[upload["id"]] = name
            try:
                os.link(upload["path"], folder / name)
            except OSError:  # a file system without links
                shutil.copyfile(upload["path"], folder / name)
        os.chdir(folder)
        yield names
    finally:
        os.chdir(before)
        shutil.rmtree(folder, ignore_errors=True)


#: Trials of one file that are imported at once.
_MOST_TRIALS = 64


def inspected(files: Sequence[Upload]) -> dict[str, Any]:
    """What is in files, and a guess of what each column is; of a mapping, its content."""
    with _folder(files) as names:
        first = names[files[0]["id"]]
        ids = {name: id_ for id_, name in names.items()}
        if api.is_mapping(api.open_source(first)):
            return _of_mapping(first, ids)
        return _of_data(list(names.values()), ids)


def _of_data(names: Sequence[str], ids: Mapping[str, str]) -> dict[str, Any]:
    """Columns of data files with the guesses of `surae.recording.inspection`."""
    names, aside = _readable(names)
    inspection = api.inspect(list(names))
    previews: dict[tuple[str, str], Any] = {}
    for name in names:
        table = api.open_table(api.open_source(name), timed=False)
        for column, loaded in api.arranged(table).columns.items():
            if not isinstance(loaded, InputError):
                previews[name, column] = preview(loaded.time, loaded.values)
    taken = {id(channel): role for role, channel in inspection.roles.items()}
    columns = [
        {
            **{
                key: getattr(channel, key) for key in ("low", "high", "usable", "bridge_s", "scale")
            },
            "upload": ids[channel.file],
            "name": channel.column,
            "unit": channel.known_unit or channel.unit,
            "role": taken.get(id(channel)),
            "preview": previews.get((channel.file, channel.column), {"t": [], "v": []}),
        }
        for channel in inspection.channels
    ]
    silent = [role for role in inspection.missing if role.startswith("emg_")]
    channels = {
        role: {
            "upload": ids[channel.file],
            "column": channel.column,
            "unit": channel.known_unit,
            "sign": 1,
            "scale": channel.scale,
            "offset": 0.0 if channel.look is None else channel.look.offset,
        }
        for role, channel in inspection.roles.items()
    }
    within = _trials_within(Path(names[0]).stem, inspection) if len(names) == 1 else []
    weights = {"emg_ta": "g1", "emg_gl": "g2", "emg_sol": "g3", "emg_gm": "g4"}
    return {
        "format": " + ".join(dict.fromkeys(inspection.formats.values())),
        "columns": columns,
        "mapping": {
            "name": Path(names[0]).stem,
            "emg": inspection.emg,
            "side": inspection.side,
            "channels": channels,
            "fixed": {weights[role]: 0.0 for role in silent},
            "prepare": {},
            "open": [role for role in NEEDED if role in inspection.open],
            **_times_and_trial(inspection),
        },
        "notes": [
            *inspection.advice,
            *inspection.remarks,
            *([] if inspection.roles or inspection.open else [api.nothing_mapped(inspection)]),
            *aside,
            *(
                f"this form reads the first of them, {trials.names[0]}; the others by a mapping, "
                "with surae session or surae fit"
                for trials in inspection.trials.values()
                if not within
            ),
        ],
        "trials": within,
        "ready": {"angle", "torque"} <= channels.keys()
        and not inspection.open
        and (inspection.emg is not None or not any(role.startswith("emg_") for role in channels))
        and all(channel["unit"] is not None for channel in channels.values()),
    }


def _readable(names: Sequence[str]) -> tuple[Sequence[str], list[str]]:
    """The files that can be inspected, and why others cannot: one never blocks another."""
    if len(names) == 1:
        return names, []
    good = []
    wrong: dict[str, InputError] = {}
    for name in names:
        try:
            api.inspect(name)
        except InputError as error:
            wrong[name] = error
        else:
            good.append(name)
    if not good:
        raise next(iter(wrong.values()))
    reasons = (str(error).removeprefix(f"{name}: ") for name, error in wrong.items())
    return good, [f"set aside: {name}: {why}" for name, why in zip(wrong, reasons, strict=True)]


def _trials_within(stem: str, inspection: api.Inspection) -> list[dict[str, Any]]:
    """The trials in one file by name, as the form imports each; none where they are too many."""
    return [
        {"name": f"{stem}-{name}", "trial": _chosen(choice)}
        for trials in inspection.trials.values()
        for name, choice in zip(trials.names, trials.choices, strict=True)
        if len(trials.names) <= _MOST_TRIALS
    ]


def _chosen(trial: Any) -> dict[str, Any]:
    """What a mapping says of one trial in a file."""
    named = {key: getattr(trial, key) for key in ("column", "sheet", "group", "index")}
    return {key: value for key, value in named.items() if value is not None}


def _times_and_trial(inspection: api.Inspection) -> dict[str, Any]:
    """The column of times, and the first of several trials, as the form's mapping says them.

    The form reads one recording: what it is told of the others stands in its notes.
    """
    made: dict[str, Any] = {}
    for clock in inspection.clocks.values():
        made["time"] = {"column": clock.column, "unit": clock.unit}
    for trials in inspection.trials.values():
        made["trial"] = _chosen(trials.choices[0])
    return made


def _of_mapping(name: str, ids: Mapping[str, str]) -> dict[str, Any]:
    """A mapping that was uploaded, its files found among the uploads."""
    mapped = api.mapped_recording(name)
    if mapped.trials:  # the form describes one recording
        raise InputError(
            f"{name}: [trials] says what differs in trials, which this form cannot keep: drop the "
            "trials alone and change what differs on each recording's page; `surae session` and "
            "`surae convert --mapping` read it as it is"
        )
    channels = {}
    missing = []
    for role, described in mapped.channels.items():
        if described.file is None or file_name(described.file) not in ids:
            missing.append(str(described.file))
            continue
        kept = {key: getattr(described, key) for key in KEPT}
        clock = {key: to_plain(at) for key in CLOCK if (at := getattr(described, key)) is not None}
        channels[role] = {"upload": ids[file_name(described.file)], **kept, **clock}
    mapping = {
        "name": mapped.name or Path(name).stem,
        "emg": mapped.emg,
        "side": mapped.side,
        "channels": channels,
        "fixed": dict(mapped.fixed),
        "prepare": dict(mapped.prepare),
        **_told(mapped),
    }
    if missing:
        notes = [f"upload the files it names too: {', '.join(dict.fromkeys(missing))}"]
    else:
        notes = _zeros(mapped.channels, name, mapping, {id_: file for file, id_ in ids.items()})
    return {
        "format": "TOML mapping",
        "columns": [],
        "mapping": mapping,
        "notes": notes,
        "ready": bool(channels) and not missing,
    }


def _told(mapped: Any) -> dict[str, Any]:
    """What a mapping says of times and of the trial, as the form's mapping has it."""
    made: dict[str, Any] = {}
    if mapped.time is not None:
        plain = isinstance(mapped.time, str)
        made["time"] = {"column": mapped.time} if plain else to_plain(mapped.time)
    if mapped.trial is not None:
        if mapped.trial.several:
            raise InputError(
                "trial: this mapping reads several trials of a file, and the form one: choose it "
                "with value or index, or the name of its group"
            )
        made["trial"] = to_plain(mapped.trial)
    return made


def _zeros(
    described: Mapping[str, Any], name: str, mapping: Mapping[str, Any], names: Mapping[str, str]
) -> list[str]:
    """Put the offset that each `zero` means into the form's mapping; a sentence on each."""
    channels = mapping["channels"]
    notes = []

    def first(role: str, **changes: Any) -> float:
        """The first sample of a channel that is described so."""
        every = {**mapping, "channels": {**channels, role: {**channels[role], **changes}}}
        Path(_MAPPING).write_text(_toml(every, names), encoding="utf-8")
        return float(api.read(_MAPPING).channels[role].values[0])

    for role, channel in described.items():
        zero = channel.zero
        if zero is None:
            continue
        if isinstance(zero, str) and (zero := file_name(zero)) not in names.values():
            raise InputError(f"{name}: channels.{role}.zero: upload {zero} too")
        plain = first(role)
        step = first(role, offset=1.0) - plain  # sign and unit
        offset = (first(role, zero=zero) - plain) / step
        channels[role]["offset"] = float(f"{offset:.9g}")
        where = zero if isinstance(zero, str) else f"{zero[0]:g} to {zero[1]:g} s"
        notes.append(f"{role}: its zero is that of {where}, an offset of {offset:.4g}")
    return notes


def imported(
    files: Sequence[Upload], mapping: Mapping[str, Any], output: str | None
) -> dict[str, Any]:
    """Read what a mapping describes, and keep it as HDF5 where `output` says so."""
    with _folder(files) as names:
        Path(_MAPPING).write_text(_toml(mapping, names), encoding="utf-8")
        try:
            recording = api.read(_MAPPING)
        except InputError as error:  # the user sees a form, not our file
            raise InputError(str(error).removeprefix(f"{_MAPPING}: ")) from None
    recording = replace(recording, files=recording.files[1:])
    if output is None:
        return described(recording) | {"pictures": pictures(recording)}
    api.write_hdf5(output, recording)
    return described(recording)


def described(recording: api.Recording) -> dict[str, Any]:
    """A recording as plain data, with what is questionable about it."""
    channels = list(recording.channels.values())
    return {
        "channels": [
            {
                **{key: getattr(channel, key) for key in ("role", "unit", "rate_hz", "source")},
                "n": len(channel.time),
                "low": float(channel.values.min()),
                "high": float(channel.values.max()),
            }
            for channel in channels
        ],
        "duration_s": max(float(channel.time[-1]) for channel in channels)
        - min(float(channel.time[0]) for channel in channels),
        **{key: getattr(recording, key) for key in ("name", "emg", "side")},
        "fixed": dict(recording.fixed),
        "files": [{"name": channel.path, "sha256": channel.sha256} for channel in recording.files],
        "findings": findings(recording),
    }


def read_recording(path: str | Path) -> api.Recording:
    """A recording of the project, as it was read from the user's own files."""
    recording = api.read(path)
    return replace(recording, files=recording.files[1:] or recording.files)


def quality(path: str) -> list[dict[str, Any]]:
    """What is questionable about a recording of the project."""
    return findings(read_recording(path))


def findings(recording: api.Recording) -> list[dict[str, Any]]:
    """What is questionable about a recording."""
    checked = api.check(recording)
    rows: list[dict[str, Any]] = checked.as_dict()["findings"]
    for row, one in zip(rows, checked.findings, strict=True):
        if isinstance(one.message, Message) and isinstance(one.advice, Message):
            row |= {"said": one.message.parts(), "advised": one.advice.parts()}
    return rows


def _toml(mapping: Mapping[str, Any], names: Mapping[str, str]) -> str:
    """The mapping as the TOML that the readers take."""
    channels = mapping["channels"]
    if mapping.get("emg") is None and any(role.startswith("emg_") for role in channels):
        raise InputError("EMG is raw or an envelope: choose which, its samples do not say")
    kept = (*KEPT, "zero", *CLOCK)
    described = {}
    for role, channel in channels.items():
        if channel["upload"] not in names:
            raise InputError(f"channels.{role}: its file is not among the uploads; upload it")
        left = "offset" if channel.get("zero") is not None else "zero"
        entry: dict[str, Any] = {"file": names[channel["upload"]]}
        for key in kept:
            if key != left and (at := channel.get(key)) is not None:
                entry[key] = _given(at) if isinstance(at, Mapping) else at
        described[role] = entry
    keys = ("name", "emg", "side", "fixed", "prepare", "open")
    whole = {key: mapping.get(key) for key in keys}
    for key in ("time", "trial"):  # TOML has no word for what is not there
        if entry := {
            name: each for name, each in (mapping.get(key) or {}).items() if each is not None
        }:
            whole[key] = entry
    return api.toml_text(
        {**{key: value for key, value in whole.items() if value is not None}, "channels": described}
    )


def _given(table: Mapping[str, Any]) -> dict[str, Any]:
    """What a table says, without what it leaves open."""
    return {key: each for key, each in table.items() if each is not None}


def pictures(recording: api.Recording) -> dict[str, Any]:
    """What a recording looks like: torque over angle [Nm, °], and each signal over time in SI."""
    channels = recording.channels
    over: dict[str, list[float]] = {"angle": [], "torque": []}
    if "angle" in channels and "torque" in channels:
        angle = channels["angle"]
        torque = channels["torque"]
        time = np.linspace(*_shared(angle.time, torque.time), _LOOP)
        over = {
            "angle": np.degrees(np.interp(time, angle.time, angle.values)).round(3).tolist(),
            "torque": np.interp(time, torque.time, torque.values).round(3).tolist(),
        }
    return {"over": over, "of": {r: preview(c.time, c.values) for r, c in channels.items()}}


def _shared(*times: FloatArray) -> tuple[float, float]:
    """The span that all have."""
    return max(float(t[0]) for t in times), min(float(t[-1]) for t in times)


def preview(time: FloatArray, values: FloatArray) -> dict[str, Any]:
    """A curve of few points."""
    good = np.isfinite(time) & np.isfinite(values)
    if not good.any():
        return {"t": [], "v": []}
    t, v = api.min_max(time[good], values[good], _PREVIEW - 2)
    return {"t": t.tolist(), "v": v.tolist()}
