"""An inspection as a mapping: TOML that a fit takes, with comments on what to check."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from surae.base.files import PathLike, shown
from surae.base.units import FACTORS, kind, stated
from surae.recording.described import toml_value
from surae.recording.inspected_advice import could_be
from surae.recording.inspected_channels import InspectedChannel, Inspection
from surae.recording.recording import FILM_ROLES, ROLES, weight_of
from surae.recording.roles import unit_is_volts

#: An EMG without a unit whose greatest value is one of these was normalised.
_NORMALISED = (0.05, 2.0)
#: Volts that no skin electrode measures: such EMG was amplified.
_AMPLIFIED_V = 0.05
#: Channels that are listed as not used.
_MOST_UNUSED = 100

_SIGN = {
    "angle": "check: 1 if dorsiflexion is positive in the file, -1 if plantarflexion is",
    "torque": "check: 1 if it is positive when the triceps pulls, -1 if when the tibialis does",
    "angular_velocity": "check: as the angle's",
    "angular_acceleration": "check: as the angle's",
    "second_angle": "check: as in the geometry's file",
    "commanded_angle": "check: as the angle's",
}
_OFFSET = {
    "angle": "added before the sign; 0 must be the foot perpendicular to the shank",
    "torque": "Nm, added before the sign: takes away a drift of the zero, or the footplate's "
    "weight beyond what m (at most 3 kg) can hold",
}


def mapping_text(
    inspection: Inspection,
    folder: PathLike = ".",
    files: Mapping[str, str] | None = None,
    name: str = "",
) -> str:
    """The mapping that an inspection suggests.

    A role with one plainly named channel is written; one that is open is written as comments, to
    choose from. Signs are written as 1 with a comment on what to check; a unit that neither the
    file nor its format states is a comment to complete.

    Parameters
    ----------
    inspection : Inspection
        What the files hold.
    folder : path
        Where the mapping will be: its file names are relative to it.
    files : mapping of str to str, optional
        Of a mapping of many trials: what it calls the files, by path; those that are not in it are
        a trial's only one and need no name.
    name : str
        Of the session; by default that of the first file.

    Raises
    ------
    InputError
        A file's name cannot be written as text.
    """
    roles = inspection.roles
    open_roles = inspection.open
    channels = inspection.channels
    title = shown(Path(channels[0].file).stem) if channels else "recording"
    lines = [
        "# Which channel is which signal, as `surae inspect` found it by the channels' names.",
        "# Lines that say check are yours to confirm. Then: "
        + ("surae fit this file" if files is None else "surae session FILES --mapping this file"),
        f"name = {toml_value(name or title)}",
    ]
    lines += _head(inspection)
    for role in ROLES:
        if role in roles:
            lines += ["", *_entry(role, roles[role], inspection, folder, files)]
        elif role in open_roles:
            lines += ["", *_choice(role, inspection, folder, files)]
        elif role in ("angle", "torque"):
            lines += ["", _missing(role, channels)]
    used = {id(channel) for several in open_roles.values() for channel in several}
    used |= set(map(id, roles.values()))
    rest = [channel for channel in channels if id(channel) not in used]
    lines += ["", "# Not used:"] if rest else []
    for channel in rest[:_MOST_UNUSED]:
        remarks = ", ".join(_line(text) for text in (channel.unit, channel.remark) if text)
        lines.append(f"#   {_line(channel.column)}{f' ({remarks})' if remarks else ''}")
    if len(rest) > _MOST_UNUSED:
        lines.append(f"#   and {len(rest) - _MOST_UNUSED} more")
    return "\n".join(lines) + "\n"


def _head(inspection: Inspection) -> list[str]:
    """What the mapping says of EMG, side and silent muscles, and what is to be settled first."""
    roles = inspection.roles
    open_roles = inspection.open
    lines: list[str] = []
    if inspection.emg is not None:
        lines.append(f"emg = {toml_value(inspection.emg)}  # {inspection.emg_rule}")
    elif any(role.startswith("emg_") for role in (*roles, *open_roles)):
        why = _line(inspection.emg_rule or "no EMG was settled")
        lines.append(f'# emg = "raw"  # state it: raw or envelope ({why})')
    if inspection.side is not None:
        lines.append(f"side = {toml_value(inspection.side)}  # {inspection.side_rule}")
    lines += _times_and_trials(inspection)
    silent = [role[4:] for role in inspection.missing if role.startswith("emg_")]
    if silent:
        weights = ", ".join(f"{weight_of(muscle)} = 0.0" for muscle in silent)
        muscles = ", ".join(silent)
        lines.append(f"# check: no EMG of {muscles}: right only while these muscles are silent")
        lines.append(f"fixed = {{ {weights} }}")
    if unsettled := [role for role in ROLES[:6] if role in open_roles]:
        lines.append("# In the files, but not settled: nothing is read before each is a channel")
        lines.append("# below, is left out by a weight in fixed = { … }, or is taken out here.")
        lines.append(f"open = [{', '.join(map(toml_value, unsettled))}]")
    if "torque" in roles and inspection.formats[roles["torque"].file] == "OpenSim":
        lines.append("# check: moments of inverse dynamics hold no inertia and weight of the foot:")
        lines.append("# then put m = 0.0 into fixed = { … }")
    return lines


def _missing(role: str, channels: Sequence[InspectedChannel]) -> str:
    """The line on a role that no channel has, and which channels could be it."""
    could = [repr(_line(c.column)) for c in channels if could_be(c)][:6]
    one = f" if one of {', '.join(could)} is it, or its file" if could else ""
    return f"# {role} is missing: add [channels.{role}] with file, column, unit{one}."


def _choice(
    role: str, inspection: Inspection, folder: PathLike, files: Mapping[str, str] | None
) -> list[str]:
    """The channels that a role may be, as comments to choose from."""
    if (reason := inspection.unusable.get(role)) is not None:
        lines = [
            f"# {role} is there, but unusable: {_line(reason)}.",
            "# Correct the file, or take the # away from what helps:",
        ]
    else:
        lines = [f"# {role} is open: choose one, and take the # away from its lines."]
    for channel in inspection.open[role]:
        lines += [f"# {line}" for line in _entry(role, channel, inspection, folder, files)]
    return lines


def _times_and_trials(inspection: Inspection) -> list[str]:
    """The lines on the column of times and on the trials in a file."""
    lines = []
    for clock in dict.fromkeys(inspection.clocks.values()):
        column = toml_value(clock.column)
        said = f"time = {{ column = {column}, unit = {toml_value(clock.unit)} }}"
        lines.append(f"{said}  # check: {_line(clock.rule)}")
        break
    for each in dict.fromkeys(inspection.trials.values()):
        lines.append(f"# {_line(each.text)}.")
        of_one = {
            "column": f"one alone: add value = {toml_value(each.names[0])}",
            "group": f"one alone: {toml_value(each.names[0])} in place of the star",
            "index": "one alone: its number in place of the star, counted from 1",
        }[each.how]
        lines.append(f"trial = {each.line}  # each is a recording of its own; {of_one}")
        break
    return lines


def _entry(
    role: str,
    channel: InspectedChannel,
    inspection: Inspection,
    folder: PathLike,
    files: Mapping[str, str] | None,
) -> list[str]:
    """Write one channel's table."""
    guess = channel.guess
    opensim = inspection.formats[channel.file] == "OpenSim"
    why = "" if guess is None else f"{guess.confidence}: {_line(guess.rule)}"
    lines = [f"[channels.{role}]  # {why}"]
    if files is None:
        lines.append(f"file = {toml_value(_relative(channel.file, folder))}")
    elif channel.file in files:  # elsewhere a trial is one file
        lines.append(f"file = {toml_value(files[channel.file])}")
    lines.append(f"column = {toml_value(channel.column)}")
    lines += _unit_lines(role, channel, opensim=opensim)
    if role in _SIGN:
        sign = f"sign = 1  # {_SIGN[role]}"
        if role == "torque" and opensim:
            sign += "; -1 for OpenSim's own moments, dorsiflexion positive"
        if role in ("angle", "torque") and channel.low is not None and channel.high is not None:
            sign += f"; here {channel.low:.4g} … {channel.high:.4g} {_line(channel.unit or '')}"
        lines.append(sign.rstrip())
        if role == "torque" and inspection.direction:
            lines.append(f"# {_line(inspection.direction)}")
    if files is not None and role == "torque":
        lines.append('# zero = "FILE"  # a quiet trial, or [0.0, 2.0]: a quiet stretch of each [s]')
    elif role in _OFFSET:
        lines.append(f"# offset = 0.0  # {_OFFSET[role]}")
    if role in FILM_ROLES:
        lines.append("# start_s = 0.0  # check: when the recording's clock shows the first frame")
        lines.append(
            "# rate_hz = 30.0  # frames a second; or time = its column of times on that clock"
        )
    if channel.bridge_s:
        lines.append(f"bridge_s = {channel.bridge_s:g}  # a straight line over each such gap")
    if channel.n and channel.start_s is None and role not in FILM_ROLES:
        lines.append("# start_s = 0.0")
        lines.append("# rate_hz = 1000.0  # state it: samples a second")
    # Of many trials each has its own; the preparation takes it away.
    if files is None and channel.look and channel.look.offset and inspection.emg == "raw":
        lines.append(f"offset = {channel.look.offset!r}  # check: {channel.look.rule}")
    return lines


def _unit_lines(role: str, channel: InspectedChannel, *, opensim: bool) -> list[str]:
    """The unit, where it is known; else what to write."""
    sort = kind(role)
    unit = channel.unit
    look = channel.look
    if (known := channel.known_unit) is not None:
        lines = [f"unit = {toml_value(known)}  # as the file states"]
        if channel.scale != 1.0:
            lines = [
                f"unit = {toml_value(known)}",
                f"scale = {channel.scale!r}  # check: the file says {_line(unit or '')}",
            ]
        if sort == "emg" and channel.high is not None and channel.low is not None and known != "1":
            peak = max(abs(channel.high), abs(channel.low)) * FACTORS["emg"][known]
            if peak > _AMPLIFIED_V:
                too = "; the offset too times that" if look and look.offset else ""
                lines.append(
                    f"# scale = 0.001  # check: {peak:.2g} V left an amplifier: 1 / its gain here "
                    f"makes weights g comparable{too}"
                )
        return lines
    if unit is None and sort == "torque" and opensim:
        return ['unit = "Nm"  # check: the file states none; moments of OpenSim are in Nm']
    normalised = _NORMALISED[0] <= (channel.high or 0.0) <= _NORMALISED[1]
    if sort == "emg" and unit is None and look and look.kind == "envelope" and normalised:
        return [
            f'unit = "1"  # check: the file states none; 0 … {channel.high:.3g} is normalised '
            "(weights g come out in N)"
        ]
    states = "the file states none" if unit is None else _line(f"the file says {unit!r}")
    first, *others = FACTORS[sort]
    known_units = ", ".join((first, *others))
    lines = [f"# unit = {toml_value(first)}  # state it: {known_units} ({states})"]
    said = stated(unit)
    if said is not None and said.per_kg:
        lines.append(f"# scale = {70 * said.scale:g}  # the body's mass [kg]: the file's is per kg")
    elif unit_is_volts(unit) and sort != "emg":
        lines.append("# scale = 1.0  # from the sensor's volts to that unit")
    elif sort == "torque" and said is not None and said.kind == "other":
        lines.append("# scale = 1.0  # a force? its lever arm [m]; a slip in the heading? then 1")
    return lines


def _relative(file: str, folder: PathLike) -> str:
    """A file's path as seen from a folder, absolute where they share no folder but the root."""
    target = Path(file).resolve()
    base = Path(folder).resolve()
    try:
        shared = Path(os.path.commonpath([target.parent, base]))
    except ValueError:  # on two drives
        shared = Path(target.anchor)
    far = shared == Path(shared.anchor)
    return (target if far else Path(os.path.relpath(target, base))).as_posix()


def _line(text: str) -> str:
    """A text within a comment: one line of characters that TOML allows there."""
    clean = "".join(c if c.isprintable() else " " for c in text)
    return " ".join(clean.encode(errors="replace").decode().split())
