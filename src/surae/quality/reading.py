"""From a file to findings, also where the file is too faulty to be read as a recording."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.base.frozen import read_only
from surae.base.units import FACTORS, SI, FloatArray, kind, plain
from surae.protocol import read_protocol
from surae.quality.commanded import Commanded
from surae.quality.finding import Finding, Quality, Skipped, make_finding
from surae.quality.numeric import BoolArray
from surae.quality.registry import CHECKS, check_recording, ordered
from surae.quality.timing import axis_findings
from surae.recording import MUSCLES, Channel, Recording
from surae.recording.channels import Scaling, channel
from surae.recording.formats import open_table
from surae.recording.inspection import recording_by_names
from surae.recording.reading import read_described, recording_of_table
from surae.recording.roles import NAMES
from surae.recording.source import Source, open_source
from surae.recording.table import Column, Table, load_each
from surae.recording.trials import SeveralTrialsError
from surae.signals import ModelInputs

#: Columns of a recording that hold the commanded angle, and their factor to radians.
_COMMANDED = {f"commanded_angle_{unit}": factor for unit, factor in FACTORS["angle"].items()}
#: Samples that must be left to look at more than the time.
_FEWEST = 32


def recording_or_findings(path: PathLike) -> tuple[Recording | Quality, Commanded | None]:
    """A file's recording and the motion that it says was commanded, or what its samples lack.

    A file that `surae.read` refuses for samples that are missing or times that do not increase is
    checked nevertheless: that is a finding, and what is left of the signals is looked at. So is a
    file whose columns have other names than ours, where they and their units leave nothing open.
    The commanded motion is a column ``commanded_angle_rad`` of the file.

    Raises
    ------
    InputError
        The file cannot be read at all.
    """
    source = open_source(path)
    if (described := read_described(source)) is not None:
        return described, None
    table = open_table(source)
    try:
        recording = recording_of_table(table, source.name, (source.file,))
    except SeveralTrialsError:
        raise
    except InputError:
        if (faulty := _faulty(source, table)) is not None:
            return faulty, None
        foreign = not any(plain(name) in NAMES for name in table.names)
        named = recording_by_names(path) if foreign else None
        if named is None:
            raise
        return named, None
    return recording, _commanded_column(table)


def commanded_file(path: PathLike) -> Commanded:
    """The commanded motion and effort of a protocol's file.

    Parameters
    ----------
    path : path
        As ``surae protocol --output P.csv`` writes it.

    Raises
    ------
    InputError
        It is no protocol, see `surae.protocol.read_protocol`.
    """
    made = read_protocol(path)
    return Commanded("the commanded profile", made.time, made.angle, made.effort)


def _commanded_column(table: Table) -> Commanded | None:
    """The commanded angle that a table of our columns has beside the measured one, or None."""
    name = next((name for name in table.names if name in _COMMANDED), "")
    column = load_each(table, [name])[name] if name else None
    if not isinstance(column, Column) or not np.isfinite(column.values).all():
        return None
    angle = read_only(column.values * _COMMANDED[name])
    return Commanded("the commanded profile", column.time, angle)


def _faulty(source: Source, table: Table) -> Quality | None:
    """Findings of a table whose samples no reader takes; None where that is not what is wrong."""
    names: dict[str, str] = {}
    units: dict[str, str] = {}
    for name in table.names:
        role, unit = NAMES.get(plain(name), ("", ""))
        if role and role not in names:
            names[role] = name
            units[role] = unit
    try:
        loaded = table.load(list(names.values()))
    except InputError:
        return None
    columns = {role: loaded[name] for role, name in names.items()}
    if "angle" not in columns or not any(np.isfinite(c.values).any() for c in columns.values()):
        return None
    findings = [
        finding
        for role, column in columns.items()
        for finding in _missing(role, column, ~np.isfinite(column.values))
    ]
    time = np.asarray(columns["angle"].time)
    known = np.isfinite(time)
    findings += _missing("time", columns["angle"], ~known)
    if known.sum() >= 2:
        axis = Channel("time", read_only(time[known]), read_only(time[known]), "s", table.file)
        findings += axis_findings(axis)
    if not findings:
        return None
    recording = _whole_samples(table, columns, units)
    if recording is not None:
        rest = check_recording(replace(recording, files=(source.file,)))
        codes = {finding.code for finding in findings}
        # Time was looked at as it is in the file.
        findings += [f for f in rest.findings if f.code not in codes and f.code != "time-gap"]
        skipped = rest.skipped
    else:
        skipped = tuple(Skipped(c, "Too few samples are left.") for k in CHECKS for c in k.codes)
    return Quality(table.notes.get("name", source.name), ordered(findings), skipped)


def _missing(role: str, column: Column, wrong: BoolArray) -> Iterator[Finding]:
    """Samples that are not numbers."""
    where = np.flatnonzero(wrong)
    if where.size:
        times = column.time[np.isfinite(column.time)]
        inside = column.time[where][np.isfinite(column.time[where])]
        begin, end = (inside[0], inside[-1]) if inside.size else (times[0], times[-1])
        yield make_finding(
            "samples-missing",
            role,
            (begin, end),
            float(where.size),
            n=where.size,
            column=column.name,
            where=column.position(int(where[0])),
        )


def _whole_samples(
    table: Table, columns: Mapping[str, Column], units: Mapping[str, str]
) -> Recording | None:
    """A recording of the samples that are whole, in the order of time; None if they are few."""
    time = columns["angle"].time
    if any(len(column.time) != len(time) for column in columns.values()):
        return None
    whole = np.isfinite(time) & np.all([np.isfinite(c.values) for c in columns.values()], axis=0)
    rising = np.full(len(time), -np.inf)
    rising[1:] = np.maximum.accumulate(np.where(whole, time, -np.inf))[:-1]
    whole &= time > rising
    if int(whole.sum()) < _FEWEST:
        return None
    channels = {}
    for role, column in columns.items():
        kept = replace(column, time=read_only(time[whole]), values=read_only(column.values[whole]))
        channels[role] = channel(role, kept, Scaling(units[role]), table)
    smooth = table.notes.get("emg") == "envelope"
    return Recording("left", channels, emg="envelope" if smooth else "raw")


def recording_of(inputs: ModelInputs, *, derivatives: bool = False) -> Recording:
    """The recording whose channels are prepared signals, EMG as envelopes."""
    signals: dict[str, FloatArray | None] = {"angle": inputs.angle, "torque": inputs.torque}
    for k, muscle in enumerate(MUSCLES):
        if muscle not in inputs.missing_emg:
            signals[f"emg_{muscle}"] = inputs.emg[:, k]
    if derivatives:
        signals["angular_velocity"] = inputs.velocity
        signals["angular_acceleration"] = inputs.acceleration
        signals["second_angle"] = inputs.second[0] if inputs.second else None
    channels = {}
    for role, values in signals.items():
        if values is not None:
            unit = inputs.emg_unit if role.startswith("emg_") else SI[kind(role)]
            channels[role] = Channel(role, inputs.time, values, unit, "prepared")
    return Recording(inputs.name, channels, emg="envelope", fixed=inputs.fixed, files=inputs.files)
