"""What data files hold, which channel seems to be which signal, and what is left to say."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

from surae.base.errors import InputError
from surae.base.files import PathLike, paths_of, shown
from surae.base.formatting import check_known
from surae.base.frozen import FrozenDict
from surae.base.units import kind, stated
from surae.base.words import N_
from surae.recording.channels import Scaling, written_unit
from surae.recording.channels import channel as read_channel
from surae.recording.emg_kind import contradiction, relation
from surae.recording.formats import open_table
from surae.recording.inspected_advice import (
    if_among,
    missing_signals,
    no_shared_span,
    not_one,
    other_starts,
)
from surae.recording.inspected_channel_of import described_channel
from surae.recording.inspected_channels import InspectedChannel, Inspection
from surae.recording.inspected_file import arranged
from surae.recording.reading import is_mapping
from surae.recording.recording import ROLES, Recording
from surae.recording.roles import (
    CONFIDENCES,
    Side,
    guess_role,
    is_plate_moment,
    joint_of_muscles,
    other_joint,
    unit_kind,
)
from surae.recording.source import open_source
from surae.recording.table import Column, Table, some
from surae.recording.times import on_one_clock
from surae.recording.trials import trials_in
from surae.recording.unknown import not_understood

_SIDES = ("left", "right")
#: What a channel's source says where only its column's name tells what it is.
BY_NAME = "taken for what its column's name and unit say, its sign as in the file"
#: What differs between rules of the same kind.
_NUMBER = re.compile(r"\d+")


def inspect(paths: PathLike | Sequence[PathLike], *, side: str | None = None) -> Inspection:
    """Describe the channels of data files and guess which signal each is.

    Nothing is settled by a guess: a fit takes it only from the mapping that a user has seen.

    Parameters
    ----------
    paths : path, or sequence of paths
        Data files in any supported format; several may hold the channels of one recording.
    side : {"left", "right"}, optional
        The leg, where the files hold both.

    Returns
    -------
    Inspection

    Raises
    ------
    InputError
        A file is in no supported format, is a mapping already, or the side is none.

    Examples
    --------
    >>> surae.inspect("lab.csv").roles["angle"].column
    """
    if side is not None:
        check_known("side", _SIDES, side)
    every = [str(path) for path in paths_of(paths)]
    if not every:
        raise InputError("there is no file to inspect")
    opened = {path: arranged(_opened(path)) for path in every}
    tables = {path: each.table for path, each in opened.items()}
    columns = _by_clock({path: each.columns for path, each in opened.items()})
    channels = _of_their_joint(
        [
            described_channel(path, tables[path], name, columns[path][name])
            for path in every
            for name in dict.fromkeys(tables[path].names)
        ]
    )
    leg, rule = _side(channels, side)
    roles, open_roles = _assigned(channels, leg)
    stated = {table.notes["emg"] for table in tables.values() if "emg" in table.notes}
    emg, emg_rule = _emg(roles, open_roles, stated)
    direction = ""
    if {"angle", "torque"} <= roles.keys():
        pair = (columns[roles[r].file][roles[r].column] for r in ("angle", "torque"))
        direction = relation(*(column for column in pair if isinstance(column, Column)))
    formats = FrozenDict((path, table.format) for path, table in tables.items())
    missing = tuple(r for r in ROLES[:6] if r not in roles and r not in open_roles)
    inspection = Inspection(
        tuple(channels),
        formats,
        FrozenDict(roles),
        FrozenDict(open_roles),
        missing,
        leg,
        rule,
        emg,
        emg_rule,
        direction,
        clocks=FrozenDict((path, one.clock) for path, one in opened.items() if one.clock),
        trials=FrozenDict((path, one.trials) for path, one in opened.items() if one.trials),
    )
    began = {path: table.began for path, table in tables.items()}
    return replace(inspection, advice=(*_advice(inspection), *other_starts(began, roles)))


def _by_clock(
    columns: Mapping[str, Mapping[str, Column | InputError]],
) -> dict[str, dict[str, Column | InputError]]:
    """The columns of several files, on one clock where their times are times of day."""
    flat = {
        (path, name): column
        for path, each in columns.items()
        for name, column in each.items()
        if isinstance(column, Column)
    }
    shared = on_one_clock(flat)
    return {
        path: {name: shared.get((path, name), column) for name, column in each.items()}
        for path, each in columns.items()
    }


def recording_by_names(path: PathLike) -> Recording | None:
    """A file's recording as `inspect` understands the names and units of its columns.

    It is good for a check, which says so, and for no fit: signs are as in the file. None where the
    angle or what the EMG is stays open. A channel that is there, but unusable, or whose unit is not
    stated, is an InputError: none is guessed.
    """
    inspected = inspect(path)
    emg = [role for role in inspected.roles if role.startswith("emg_")]
    if inspected.faults:
        raise InputError(f"{shown(path)}: {'; '.join(inspected.faults)}")
    if "angle" not in inspected.roles or inspected.open or (emg and inspected.emg is None):
        return None
    if unknown := _units_unknown(inspected.roles):
        raise InputError(
            f"{shown(path)}: {unknown}; settle it in a mapping, which `surae inspect FILE --output "
            "MAP.toml` begins"
        )
    source = open_source(path)
    table = open_table(source)
    columns = table.load(tuple(c.column for c in inspected.roles.values()))
    channels = {}
    for role, each in inspected.roles.items():
        scaling = Scaling(each.known_unit or "", scale=each.scale)
        read = read_channel(role, columns[each.column], scaling, table)
        channels[role] = replace(read, source=f"{read.source}; {BY_NAME}")
    return Recording(
        name=source.name,
        channels=channels,
        emg=inspected.emg or "raw",
        side=inspected.side,
        files=(source.file,),
    )


def channels_by_names(
    columns: Sequence[tuple[str, str]],
) -> tuple[dict[str, InspectedChannel], dict[str, tuple[InspectedChannel, ...]]]:
    """What columns seem to be before there is a sample of them: by their names and units.

    `columns` are name and stated unit, empty where none is. Returned are, as `Inspection` has them,
    the channel of each role that has one plainly, and what could be each role that is left open.
    """
    channels = []
    for column, unit in columns:
        guess = guess_role(column, unit or None)
        known = stated(unit)
        of_role = guess is not None and known is not None and kind(guess.roles[0]) == known.kind
        fits = of_role and known is not None and bool(known.unit) and not known.per_kg
        channels.append(
            InspectedChannel(
                "",
                column,
                unit or None,
                known_unit=known.unit if fits and known is not None else None,
                scale=known.scale if fits and known is not None else 1.0,
                guess=guess,
            )
        )
    channels = _of_their_joint(channels)
    return _assigned(channels, _side(channels, None)[0])


def _units_unknown(roles: Mapping[str, InspectedChannel]) -> str:
    """That units of channels are none that are known; empty where all are."""
    unknown = [channel for channel in roles.values() if channel.known_unit is None]
    names = some(c.column for c in unknown)
    says = {c.unit or "none": 0 for c in unknown}
    return f"the unit of {names} is not known (the file says {', '.join(says)})" if says else ""


def _opened(path: PathLike) -> Table:
    """A data file's table, also without times if a channel is one of ours; a mapping is none."""
    source = open_source(path)
    if is_mapping(source):
        raise InputError(
            f"{source.shown}: this is a TOML mapping already: fit it, or inspect the data files "
            "that it names"
        )
    table = open_table(source, timed=False)
    guesses = [guess_role(name, written_unit(table, name)) for name in table.names]
    # What has neither times nor a signal's name is no recording.
    if table.time_name or table.offered or any(guesses) or trials_in(table):
        return table
    raise InputError(not_understood(source, table))


def _of_their_joint(channels: Sequence[InspectedChannel]) -> list[InspectedChannel]:
    """Channels with no joint in their names are only possibly the ankle's beside a knee's muscles.

    Those of another joint or of a force plate say so in their remark.
    """
    joint = joint_of_muscles([channel.column for channel in channels])
    judged = []
    for channel in channels:
        guess = channel.guess
        other = other_joint(channel.column)
        remark = f"of the {other}, not the ankle" if other else ""
        if other == "knee" and unit_kind(channel.unit) in (None, "angle"):
            remark += " (second_angle of a geometry over both)"
        if not remark and is_plate_moment(channel.column, channel.unit):
            remark = "a moment about an axis of a force plate or load cell, not the ankle's"
        changed: dict[str, Any] = {}
        if guess is None:
            changed["remark"] = "; ".join(filter(None, (remark, channel.remark)))
        elif joint and guess.role and guess.confidence == "likely":
            rule = f"{guess.rule}, and the muscles are of the {joint}: is it the ankle's?"
            changed["guess"] = replace(guess, confidence="possible", rule=rule)
        judged.append(replace(channel, **changed))
    return judged


def _plain_candidates(
    channels: Sequence[InspectedChannel], role: str, *, usable: bool = True
) -> list[InspectedChannel]:
    """The channels whose name says this role most plainly, vague ones left out."""
    candidates = [
        c for c in channels if c.usable is usable and c.guess is not None and c.guess.role == role
    ]
    for confidence in CONFIDENCES[:-1]:
        level = [c for c in candidates if c.guess is not None and c.guess.confidence == confidence]
        if level:
            return level
    return []


def _side(channels: Sequence[InspectedChannel], chosen: str | None) -> tuple[Side | None, str]:
    """The leg: as given, else the one side that some role's channels all are of."""
    if chosen is not None:
        return ("left" if chosen == "left" else "right"), "as given"
    votes: dict[Side, list[str]] = {}
    for role in ROLES:
        sides = {c.guess.side for c in _plain_candidates(channels, role) if c.guess is not None}
        if len(sides) == 1 and (only := sides.pop()) is not None:
            votes.setdefault(only, []).append(role)
    if len(votes) != 1:
        return None, ""
    ((leg, roles),) = votes.items()
    return leg, f"all channels of {', '.join(roles)} are of the {leg} side"


def _assigned(
    channels: Sequence[InspectedChannel], leg: Side | None
) -> tuple[dict[str, InspectedChannel], dict[str, tuple[InspectedChannel, ...]]]:
    """The channel of each role, and the roles that are left open with what could be them."""
    fitting = [c for c in channels if not leg or c.guess is None or c.guess.side in (None, leg)]
    plain = {role: tuple(_plain_candidates(fitting, role)) for role in ROLES}
    assigned = {role: several[0] for role, several in plain.items() if len(several) == 1}
    open_roles = {role: several for role, several in plain.items() if len(several) > 1}
    for role in ROLES:
        if plain[role]:
            continue
        could = [c for c in fitting if c.guess and role in c.guess.roles]
        vague = [c for c in could if c.usable]
        vague = [c for c in vague if c.alive] or vague
        unusable = _plain_candidates(fitting, role, usable=False) or ([] if vague else could)
        if vague or unusable:
            open_roles[role] = (*unusable, *vague)
    return assigned, open_roles


def _emg(
    assigned: Mapping[str, InspectedChannel],
    open_roles: Mapping[str, Sequence[InspectedChannel]],
    notes: set[str],
) -> tuple[Literal["raw", "envelope"] | None, str]:
    """Whether the EMG is raw or an envelope, and how that is known."""
    looks = {role: c.look for role, c in assigned.items() if c.look is not None} or {
        c.column: c.look for some in open_roles.values() for c in some if c.look is not None
    }
    if not looks:
        return None, ""
    if len(notes) == 1:
        return ("envelope" if notes == {"envelope"} else "raw"), "as the file states"
    if len({look.kind for look in looks.values()}) == 1:
        only = next(iter(looks.values()))
        if only.kind is not None:
            return only.kind, only.rule
    alike: dict[str, list[str]] = {}
    for role, look in looks.items():
        alike.setdefault(_NUMBER.sub("", look.rule), []).append(role)
    rules = (
        f"{first}{f' and {len(others)} more' if others else ''}: {looks[first].rule}"
        for first, *others in alike.values()
    )
    return None, "; ".join(rules)


def _advice(inspection: Inspection) -> Iterator[str]:
    """What is missing or open, and what to do about it."""
    yield from inspection.faults
    yield from _open_advice(inspection)
    yield from not_one(inspection.trials, inspection.clocks)
    yield from no_shared_span(inspection.roles)
    yield from missing_signals(inspection)
    if silent := [role for role in inspection.missing if role.startswith("emg_")]:
        yield (
            f"no channel of {', '.join(silent)}: the mapping fixes their weights at 0, which is "
            "right only while these muscles are silent" + if_among(inspection)
        )
    if unknown := _units_unknown(inspection.roles):
        yield f"{unknown}: see the mapping"
    yield from _emg_advice(inspection)
    moving = [inspection.roles[role] for role in ("angle", "torque") if role in inspection.roles]
    if any(c.guess is None or c.guess.confidence != "stated" for c in moving):
        yield N_(
            "Their names do not say which direction of angle and torque is positive: dorsiflexion "
            "and the triceps’s pull must be, else correct sign in the mapping"
        )
    if inspection.direction:
        yield inspection.direction


def _open_advice(inspection: Inspection) -> Iterator[str]:
    """Which roles have several candidates, or a guess alone; alike ones together."""
    together: dict[tuple[int, ...], list[str]] = {}
    for role, candidates in inspection.open.items():
        together.setdefault(tuple(map(id, candidates)), []).append(role)
    for roles in together.values():
        candidates = inspection.open[roles[0]]
        if roles[0] in inspection.unusable:
            continue
        sides = {c.guess.side for c in candidates if c.guess is not None}
        todo = "choose in the mapping"
        if sides == {"left", "right"}:
            todo = "give --side left or --side right, or choose in the mapping"
        elif len(candidates) == 1 and (guess := candidates[0].guess) is not None:
            todo = f"only a guess ({guess.rule}): confirm it in the mapping"
        names = some([c.column for c in candidates])
        yield f"{', '.join(roles)} {'is' if len(roles) == 1 else 'are'} open: {names}; {todo}"
        if len({c.column.partition("(")[0] for c in candidates}) == 1 and len(roles) == 4:
            yield (
                "which muscle is which column of the matrix? TA, GL, SOL, GM is the order of "
                "equation (13) of the thesis, TA, SOL, GM, GL that of its figures"
            )


def _emg_advice(inspection: Inspection) -> Iterator[str]:
    """Where EMG looks otherwise than it is said to be, or nothing says what it is."""
    for c in inspection.roles.values():
        if c.look is not None and inspection.emg is not None:
            yield from filter(None, [contradiction(repr(c.column), c.look, inspection.emg)])
    if inspection.emg is None and inspection.emg_rule:
        yield f"whether the EMG is raw is unclear ({inspection.emg_rule}): write it in the mapping"
