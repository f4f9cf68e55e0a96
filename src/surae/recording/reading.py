"""Any supported file to a recording: by its own format, a mapping, or columns with our names."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from surae.base.errors import InputError
from surae.base.files import PathLike, shown
from surae.base.frozen import freeze
from surae.base.units import SI, plain
from surae.recording import hdf5, opensim
from surae.recording.beside import description_beside
from surae.recording.channels import Scaling, channel, settle_unit
from surae.recording.corrections import Corrections
from surae.recording.described import MappedRecording
from surae.recording.formats import data_files, open_table
from surae.recording.mapping import Description, recognises
from surae.recording.recording import Channel, Recording, SourceFile
from surae.recording.roles import NAMES, TIMES, guess_role, role_and_unit
from surae.recording.source import Source, open_source
from surae.recording.table import Table, some
from surae.recording.trials import SeveralTrialsError, trials_in

#: Folders in folders that are looked into, and files that are taken from there.
_DEEPEST = 5
_MOST_BELOW = 1000

_RIGHT = ("sign", "scale", "offset", "swap", "wrap")


def read(
    path: PathLike,
    *,
    mapping: PathLike | None = None,
    sign: Mapping[str, float] | None = None,
    scale: Mapping[str, float] | None = None,
    offset: Mapping[str, float] | None = None,
    swap: Sequence[Sequence[str]] = (),
    wrap: Mapping[str, float] | None = None,
) -> Recording:
    """Read a recording: our CSV or HDF5, a TOML mapping, or a file whose columns have our names.

    What the file is shows in its content; its name doesn't matter.

    Parameters
    ----------
    path : str or path
        A regular file.
    mapping : str or path, optional
        A TOML that describes the columns of many files, of which `path` is one.
    sign, scale, offset : mapping of str to float, optional
        What to put right in signals, by role: ``sign * (scale * value + offset)``, the offset in
        the unit of the file, as ``offset={"angle": -90}`` where 90° is the neutral position.
    swap : sequence of pairs of str
        Muscles whose electrodes were exchanged, as ``[("ta", "sol")]``.
    wrap : mapping of str to float, optional
        Periods of signals that jump by one at the end of their range, as ``{"angle": 360}``.

    Returns
    -------
    Recording
        In SI units, each channel on its own times, with the SHA-256 of every file read.

    Raises
    ------
    InputError
        One line that names file, column and row, and says what to do.

    Examples
    --------
    >>> surae.read("trial.csv").channels["torque"].unit
    """
    corrections = Corrections(sign or {}, scale or {}, offset or {}, swap, wrap or {})
    if mapping is not None:
        return corrections(Description.of(open_mapping(mapping)).read(path))
    source = open_source(path)
    described = read_described(source)
    if described is not None:
        return corrections(described)
    table = open_table(source)
    try:
        recording = recording_of_table(table, source.name, (source.file,))
    except InputError as error:
        if type(error) is InputError and (other := description_beside(path, table.names)):
            raise InputError(
                f"{error}; {other.source.shown} describes a file with these columns: it reads this "
                f"one too as mapping (--mapping {other.source.shown})"
            ) from None
        raise
    return corrections(recording)


def read_trials(
    path: PathLike, *, mapping: PathLike | None = None, **corrections: Any
) -> list[Recording]:
    """The recordings in a file: one, or each of the trials that its mapping tells apart.

    Parameters
    ----------
    path, mapping, **corrections
        As of `read`.

    Returns
    -------
    list of Recording
        Of several trials each has the name of its own behind that of the recording.

    Raises
    ------
    InputError
        As of `read`.
    """
    source = open_source(path) if mapping is None else open_mapping(mapping)
    if mapping is None and (hdf5.recognises(source) or not is_mapping(source)):
        return [read(path, **corrections)]
    description = Description.of(source)
    data = None if mapping is None else path
    within = description.within(data)
    if not within:
        return [read(path, mapping=mapping, **corrections)]
    given: dict[str, Any] = {name: each for name in _RIGHT if (each := corrections.get(name))}
    right = Corrections(**given)
    made = []
    for name, chosen in within.items():
        recording = description.read(data, chosen=chosen)
        made.append(right(replace(recording, name=f"{recording.name}-{name}")))
    return made


def read_contraction(
    path: PathLike, *, mapping: PathLike | None = None, **corrections: Any
) -> Recording:
    """Read a maximum contraction, of which EMG is all that is needed.

    Parameters
    ----------
    path, mapping, **corrections
        As of `read`; what is to be put right in signals that it lacks has no effect.

    Returns
    -------
    Recording
        Where it has no angle, one of zeros says in its source that it stands in for one.

    Raises
    ------
    InputError
        As of `read`.
    """
    source = open_source(path)
    if mapping is not None:
        made = Description.of(open_mapping(mapping)).read(path, emg_alone=True)
    elif hdf5.recognises(source):
        made = hdf5.read_recording(source)
    elif is_mapping(source):
        made = Description.of(source).read(emg_alone=True)
    else:
        table = open_table(source)
        made = recording_of_table(table, source.name, (source.file,), emg_alone=True)
    if "angle" not in made.channels:
        first = next(iter(made.channels.values()))
        none = freeze(np.zeros(len(first.time)))
        stands_in = Channel("angle", first.time, none, SI["angle"], "not measured, nor needed")
        made = replace(made, channels={"angle": stands_in, **made.channels})
    known = {n: _of(given, made) for n in _RIGHT if (given := corrections.get(n))}
    return Corrections(**known)(made)


def _of(given: Any, recording: Recording) -> Any:
    """What is put right in the channels that a recording has."""
    if isinstance(given, Mapping):
        return {role: value for role, value in given.items() if role in recording.channels}
    return given


def is_several(path: PathLike, mapping: PathLike | None = None) -> bool:
    """Whether a mapping, or the one given for a file, tells several trials in it apart."""
    source = open_source(path) if mapping is None else open_mapping(mapping)
    if mapping is None and (hdf5.recognises(source) or not is_mapping(source)):
        return False
    return bool(Description.of(source).within(None if mapping is None else path))


def read_described(source: Source) -> Recording | None:
    """The recording of a file that says what each channel is: our HDF5 or a mapping; else None."""
    if hdf5.recognises(source):
        return hdf5.read_recording(source)
    return Description.of(source).read() if is_mapping(source) else None


def is_mapping(source: Source) -> bool:
    """Whether it is a TOML mapping; the header of an OpenSim file looks like one."""
    return recognises(source) and not opensim.recognises(source)


def is_recording(path: PathLike) -> bool:
    """Whether a file is a recording, or a mapping that says how one is read."""
    try:
        source = open_source(path)
        if is_mapping(source) or hdf5.recognises(source):
            return True
        table = open_table(source, timed=False)
    except InputError:
        return False
    return table.header is None or bool(table.time_name or table.offered)


def data_files_below(folder: PathLike) -> list[Path]:
    """The files of a folder that can hold signals, or where none is a recording, those below it.

    Raises
    ------
    InputError
        There is no such folder, or it cannot be read; or too many files are below it.
    """
    files = data_files(folder)
    if any(map(is_recording, files)):
        return files
    below: list[Path] = []
    folders = [Path(folder)]
    for _ in range(_DEEPEST):
        folders = [
            inner
            for outer in folders
            for inner in sorted(outer.iterdir())
            if inner.is_dir() and not inner.is_symlink() and not inner.name.startswith(".")
        ]
        below += [path for inner in folders for path in data_files(inner)]
        if len(below) > _MOST_BELOW or len(folders) > _MOST_BELOW:
            raise InputError(
                f"{shown(folder)}: more than {_MOST_BELOW} files are in its subfolders; give one "
                "of these"
            )
    return below or files


def open_mapping(path: PathLike) -> Source:
    """Open a TOML mapping's file.

    Raises
    ------
    InputError
        It is no mapping.
    """
    source = open_source(path)
    if not is_mapping(source):
        raise InputError(
            f"{source.shown}: this is no TOML mapping; `surae inspect FILE --output MAP.toml` "
            "writes one"
        )
    return source


def mapped_recording(path: PathLike) -> MappedRecording:
    """What a TOML mapping says of one recording, or of every trial of a session."""
    return Description.of(open_mapping(path)).mapped()


def recording_of_table(
    table: Table, name: str, files: tuple[SourceFile, ...] = (), *, emg_alone: bool = False
) -> Recording:
    """The recording of columns with our names, called `name` unless a note says otherwise.

    `emg_alone` says that it needs no angle, as one of maximum contractions.
    """
    if table.header is not None and table.time_name.casefold() not in TIMES:
        if not any(plain(column) in NAMES for column in table.names):
            raise InputError(_no_angle(table))
        raise InputError(
            f"{_where(table, table.time_name)}: call it {' or '.join(TIMES)}, whichever it is in"
        )
    columns_of: dict[str, str] = {}
    units: dict[str, str] = {}
    for column in table.names:
        where = _where(table, column)
        # Only in our own format does a name that is nearly ours mean a mistake.
        ours = table.header is not None
        claim = role_and_unit(column, where) if ours else NAMES.get(plain(column))
        if claim is None:
            continue
        role, unit = claim
        if columns_of.get(role) == column:
            raise InputError(f"{where}: the column is there twice; keep one")
        if role in columns_of:
            raise InputError(f"{where}: column {columns_of[role]!r} is the {role} too; keep one")
        columns_of[role] = column
        units[role] = settle_unit(table, role, column, unit, where)
    some_emg = any(role.startswith("emg_") for role in columns_of)
    if "angle" not in columns_of and not (some_emg and emg_alone):
        raise InputError(_no_angle(table))
    unread = {name: guess_role(name) for name in table.names if name not in columns_of.values()}
    emg = [
        name
        for name, guess in unread.items()
        if guess is not None
        and guess.confidence != "likely"
        and guess.roles[0].startswith("emg_")
        and not columns_of.keys() & {*guess.roles}
    ]
    if emg:  # left out, these muscles would pass for silent ones
        raise InputError(
            f"{table.file}: {some(emg)}: EMG by name, but not called emg_ta_V, …; rename it, or "
            "write a TOML mapping, which `surae inspect FILE --output MAP.toml` begins"
        )
    columns = table.load(tuple(columns_of.values()))
    if (trials := trials_in(table, columns)) is not None:
        raise SeveralTrialsError(
            f"{table.file}: {trials.text}; each is a recording of its own: `surae inspect FILE "
            f"--output MAP.toml` writes a mapping that reads them, with trial = {trials.line}"
        )
    return Recording(
        name=table.notes.get("name", name),
        channels={
            role: channel(role, columns[column], Scaling(units[role]), table)
            for role, column in columns_of.items()
        },
        emg="envelope" if table.notes.get("emg") == "envelope" else "raw",
        files=files,
    )


def _where(table: Table, name: str) -> str:
    """A column's place for a message."""
    row = "" if table.header is None else f", row {table.header}"
    return f"{table.file}: column {name!r}{row}"


def _likely(table: Table) -> str:
    """Which columns seem to be the angle and the torque by their names; empty where none does."""
    seem: dict[str, str] = {}
    for name in table.names:
        if plain(name) in NAMES:  # what is called as it is to be, is that
            continue
        guess = guess_role(name, table.units.get(name))
        if guess is not None and len(guess.roles) == 1 and guess.roles[0] in ("angle", "torque"):
            seem.setdefault(guess.roles[0], f"{some([name])} seems to be the {guess.roles[0]}")
    return f" ({', '.join(seem.values())})" if seem else ""


def _no_angle(table: Table) -> str:
    """Why a table without a column of ours for the angle is refused."""
    if table.header is not None and table.time_name in TIMES:
        emg = [name for name in table.names if NAMES.get(plain(name), ("",))[0].startswith("emg_")]
        seems = _likely(table)
        lacks = (
            f"no column is called angle_rad (or angle_deg){seems}"
            if seems
            else ("missing column angle_rad (or angle_deg)")
        )
        return (
            f"{table.file}: row {table.header}: {lacks}; columns "
            f"found: {some((table.time_name, *table.names))}; rename them, or describe the file "
            "in a TOML mapping, which `surae inspect` begins"
            + "; EMG alone is a recording of maximum contractions: give it by --mvc"
            * bool(emg)
        )
    remarks = {table.remarks.get(name, "") for name in table.names}
    alike = "".join(remarks) if len(remarks) == 1 else ""  # what is remarked of all columns
    some_own = any(plain(name) in NAMES for name in table.names)
    lacks = (
        f"none of its {table.format} columns is called angle_rad (or angle_deg)"
        if some_own
        else f"its {table.format} columns have other names than surae's own"
    )
    return (
        f"{table.file}: {lacks}{_likely(table)}: "
        "write a TOML mapping, which `surae inspect FILE --output MAP.toml` begins, and read "
        f"that; columns here: {some(table.names)}{f' ({alike})' if alike else ''}"
    )
