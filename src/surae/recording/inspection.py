"""What data files hold, which channel seems to be which signal, and what is left to say."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from surae.errors import InputError
from surae.files import PathLike, paths_of
from surae.frozen import FrozenDict
from surae.recording.channels import stated_unit, written_unit
from surae.recording.emg_kind import Look, contradiction, look_of, relation
from surae.recording.formats import open_table
from surae.recording.reading import is_mapping
from surae.recording.recording import FILM_ROLES, ROLES
from surae.recording.roles import (
    CONFIDENCES,
    Guess,
    Side,
    guess_role,
    is_plate_moment,
    joint_of_muscles,
    other_joint,
    unit_kind,
)
from surae.recording.source import open_source
from surae.recording.table import Column, Sampling, Table, load_each, sampling_of, some
from surae.records import to_plain


@dataclass(frozen=True, slots=True)
class InspectedChannel:
    """One channel of a data file.

    Attributes
    ----------
    file : str
        Path of its file as given.
    column : str
        Its name there.
    unit : str or None
        The unit that the file states, in its own spelling.
    known_unit : str or None
        That unit as a mapping writes it for the guessed role; None where it is unknown.
    n : int or None
        Number of samples; None where the channel cannot be read.
    rate_hz : float or None
        Sampling rate [Hz]; None where time steps differ.
    start_s, end_s : float or None
        Times of the first and last sample [s].
    low, high : float or None
        Least and greatest finite value, in the file's unit.
    guess : Guess or None
        What it seems to be.
    look : Look or None
        What its samples look like as an EMG.
    remark : str
        What to know of it; why it cannot be used.
    usable : bool
        Whether a mapping can name it.
    """

    file: str
    column: str
    unit: str | None = None
    known_unit: str | None = None
    n: int | None = None
    rate_hz: float | None = None
    start_s: float | None = None
    end_s: float | None = None
    low: float | None = None
    high: float | None = None
    guess: Guess | None = None
    look: Look | None = None
    remark: str = ""
    usable: bool = True


@dataclass(frozen=True, slots=True)
class Inspection:
    """What data files hold; `surae.recording.mapping_text` writes it as a mapping.

    Attributes
    ----------
    channels : tuple of InspectedChannel
        Every channel, file by file.
    formats : mapping of str to str
        Format by file.
    roles : mapping of str to InspectedChannel
        The one channel that each role was found for.
    open : mapping of str to tuple of InspectedChannel
        Roles of which several channels, or only a vague one, could be it: the user decides.
    missing : tuple of str
        Roles of angle, torque and EMG of which there is no channel.
    side : {"left", "right"} or None
        The leg, and `side_rule`: how it is known.
    side_rule : str
        Empty where there is no side.
    emg : {"raw", "envelope"} or None
        What the EMG seems to be, None where it is unclear, and `emg_rule`: why.
    emg_rule : str
        Empty where there is no EMG.
    direction : str
        How the torque goes with the angle, where it does.
    advice : tuple of str
        What to do, one line each.
    """

    channels: tuple[InspectedChannel, ...]
    formats: Mapping[str, str]
    roles: Mapping[str, InspectedChannel]
    open: Mapping[str, tuple[InspectedChannel, ...]]
    missing: tuple[str, ...]
    side: Side | None = None
    side_rule: str = ""
    emg: Literal["raw", "envelope"] | None = None
    emg_rule: str = ""
    direction: str = ""
    advice: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Give all of it as plain data."""
        plain: dict[str, Any] = to_plain(self)
        return plain


_SIDES = ("left", "right")
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
    """
    if side is not None and side not in _SIDES:
        raise InputError(f"side is {side!r}; use one of: {', '.join(_SIDES)}")
    every = paths_of(paths)
    if not every:
        raise InputError("there is no file to inspect")
    channels: list[InspectedChannel] = []
    formats: dict[str, str] = {}
    notes: set[str] = set()
    raw: dict[int, Column] = {}
    for path in every:
        table = _opened(path)
        formats[str(path)] = table.format
        if "emg" in table.notes:
            notes.add(table.notes["emg"])
        for channel, column in _channels(str(path), table):
            if column is not None and channel.guess is not None and channel.guess.role is not None:
                raw[id(channel)] = column
            channels.append(channel)
    channels = _of_their_joint(channels, raw)
    leg, rule = _side(channels, side)
    assigned, open_roles = _assigned(channels, leg)
    missing = tuple(r for r in ROLES[:6] if r not in assigned and r not in open_roles)
    emg, emg_rule = _emg(assigned, open_roles, notes)
    direction = ""
    if {"angle", "torque"} <= assigned.keys():
        angle, torque = assigned["angle"], assigned["torque"]
        direction = relation(raw[id(angle)], raw[id(torque)])
    inspection = Inspection(
        channels=tuple(channels),
        formats=FrozenDict(formats),
        roles=FrozenDict(assigned),
        open=FrozenDict(open_roles),
        missing=missing,
        side=leg,
        side_rule=rule,
        emg=emg,
        emg_rule=emg_rule,
        direction=direction,
    )
    return replace(inspection, advice=tuple(_advice(inspection)))


def _opened(path: PathLike) -> Table:
    """A data file's table, of a film also without times; a mapping is none."""
    source = open_source(path)
    if is_mapping(source):
        raise InputError(
            f"{source.shown}: this is a TOML mapping already: fit it, or inspect the data files "
            "that it names"
        )
    table = open_table(source, timed=False)
    guesses = [guess_role(name, written_unit(table, name)) for name in table.names]
    filmed = any({*guess.roles} & {*FILM_ROLES} for guess in guesses if guess is not None)
    return table if table.time_name or filmed else open_table(source)


def _channels(path: str, table: Table) -> list[tuple[InspectedChannel, Column | None]]:
    """Every channel of a file, with its samples where they can be read."""
    loaded = load_each(table, table.names)
    described: list[tuple[InspectedChannel, Column | None]] = []
    for name, count in Counter(table.names).items():
        unit, column = written_unit(table, name), loaded[name]
        remark = table.remarks.get(name, "")
        usable = True
        if count > 1:
            remark, usable = f"{count} columns have this name: rename one", False
        if isinstance(column, InputError):
            reason = str(column).removeprefix(f"{table.file}: ").removeprefix(f"column {name!r}: ")
            reason = "; ".join(text for text in (reason, remark) if text)
            described.append(
                (InspectedChannel(path, name, unit, remark=reason, usable=False), None)
            )
            continue
        finite = column.values[np.isfinite(column.values)]
        if len(finite) < len(column.values):
            wrong = len(column.values) - len(finite)
            remark = f"{wrong} samples are no finite numbers{'; ' + remark if remark else ''}"
        sampling = sampling_of(column.time) if table.time_name else Sampling(len(column.time))
        if not table.time_name:
            remark = "; ".join(filter(None, ("no times: give start_s and rate_hz", remark)))
        guess = guess_role(name, unit) if usable else None
        role = guess.roles[0] if guess else None
        if role is not None:  # a file may state one unit for all signals of a kind
            unit = written_unit(table, name, role)
        described.append(
            (
                InspectedChannel(
                    file=path,
                    column=name,
                    unit=unit,
                    known_unit=None if role is None else stated_unit(table, role, name),
                    n=sampling.n,
                    rate_hz=sampling.rate_hz,
                    start_s=sampling.start_s,
                    end_s=float(column.time[-1]) if sampling.start_s is not None else None,
                    low=float(finite.min()) if len(finite) else None,
                    high=float(finite.max()) if len(finite) else None,
                    guess=guess,
                    look=look_of(column.time, column.values)
                    if role and role.startswith("emg_")
                    else None,
                    remark=remark,
                    usable=usable and sampling.n > 1,
                ),
                column,
            )
        )
    return described


def _of_their_joint(
    channels: Sequence[InspectedChannel], raw: dict[int, Column]
) -> list[InspectedChannel]:
    """Channels with no joint in their names are only possibly the ankle's beside a knee's muscles.

    Those of another joint or of a force plate say so in their remark. `raw` goes over to what
    replaces them.
    """
    joint = joint_of_muscles([channel.column for channel in channels])
    judged = []
    for channel in channels:
        guess, other = channel.guess, other_joint(channel.column)
        own = f"of the {other}, not the ankle" if other else ""
        if other == "knee" and unit_kind(channel.unit) in (None, "angle"):
            own += " (second_angle of a geometry over both)"
        if not own and is_plate_moment(channel.column, channel.unit):
            own = "a moment about an axis of a force plate or load cell, not the ankle's"
        if guess is None and own:
            remark = "; ".join(filter(None, (own, channel.remark)))
            judged.append(replace(channel, remark=remark))
        elif joint and guess and guess.role and guess.confidence == "likely":
            rule = f"{guess.rule}, and the muscles are of the {joint}: is it the ankle's?"
            judged.append(replace(channel, guess=replace(guess, confidence="possible", rule=rule)))
        else:
            judged.append(channel)
        if id(channel) in raw:
            raw[id(judged[-1])] = raw[id(channel)]
    return judged


def _plain_candidates(channels: Sequence[InspectedChannel], role: str) -> list[InspectedChannel]:
    """The channels whose name says this role most plainly, vague ones left out."""
    candidates = [c for c in channels if c.usable and c.guess is not None and c.guess.role == role]
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
        only = sides.pop() if len(sides) == 1 else None
        if only is not None:
            votes.setdefault(only, []).append(role)
    if len(votes) != 1:
        return None, ""
    leg, roles = next(iter(votes.items()))
    return leg, f"all channels of {', '.join(roles)} are of the {leg} side"


def _assigned(
    channels: Sequence[InspectedChannel], leg: Side | None
) -> tuple[dict[str, InspectedChannel], dict[str, tuple[InspectedChannel, ...]]]:
    """The channel of each role, and the roles that are left open with what could be them."""
    assigned: dict[str, InspectedChannel] = {}
    open_roles: dict[str, tuple[InspectedChannel, ...]] = {}

    def fits(channel: InspectedChannel) -> bool:
        own_side = None if channel.guess is None else channel.guess.side
        return leg is None or own_side in (None, leg)

    for role in ROLES:
        candidates = [c for c in _plain_candidates(channels, role) if fits(c)]
        if len(candidates) == 1:
            assigned[role] = candidates[0]
        elif candidates:
            open_roles[role] = tuple(candidates)
    for role in ROLES:
        if role in assigned or role in open_roles:
            continue
        vague = tuple(
            c
            for c in channels
            if c.usable and c.guess is not None and role in c.guess.roles and fits(c)
        )
        if vague:
            open_roles[role] = vague
    return assigned, open_roles


def _emg(
    assigned: Mapping[str, InspectedChannel],
    open_roles: Mapping[str, Sequence[InspectedChannel]],
    notes: set[str],
) -> tuple[Literal["raw", "envelope"] | None, str]:
    """Whether the EMG is raw or an envelope, and how that is known."""
    looks = {role: c.look for role, c in assigned.items() if c.look is not None}
    if not looks:
        looks = {
            c.column: c.look for some in open_roles.values() for c in some if c.look is not None
        }
    if not looks:
        return None, ""
    if len(notes) == 1:
        stated = notes.pop()
        return ("envelope" if stated == "envelope" else "raw"), "as the file states"
    kinds = {look.kind for look in looks.values()}
    if len(kinds) == 1 and (only := next(iter(looks.values()))).kind is not None:
        return only.kind, only.rule
    alike: dict[str, list[tuple[str, str]]] = {}
    for role, look in looks.items():
        alike.setdefault(_NUMBER.sub("", look.rule), []).append((role, look.rule))
    rules = (
        f"{first[0]}{f' and {len(others)} more' if others else ''}: {first[1]}"
        for first, *others in alike.values()
    )
    return None, "; ".join(rules)


def _advice(inspection: Inspection) -> list[str]:
    """What is missing or open, and what to do about it."""
    lines = []
    together: dict[tuple[int, ...], list[str]] = {}
    for role, candidates in inspection.open.items():
        together.setdefault(tuple(map(id, candidates)), []).append(role)
    for roles in together.values():
        candidates = inspection.open[roles[0]]
        sides = {c.guess.side for c in candidates if c.guess is not None}
        if sides == {"left", "right"}:
            todo = "give --side left or --side right, or choose in the mapping"
        elif len(candidates) == 1 and (guess := candidates[0].guess) is not None:
            todo = f"only a guess ({guess.rule}): confirm it in the mapping"
        else:
            todo = "choose in the mapping"
        are = "is" if len(roles) == 1 else "are"
        names = some([c.column for c in candidates])
        lines.append(f"{', '.join(roles)} {are} open: {names}; {todo}")
    for role in inspection.missing:
        if role == "angle":
            lines.append("angle is missing: no recording can be read without it; add its file")
        elif role == "torque":
            lines.append("torque is missing: nothing can be fitted without it; add its file")
    silent = [role for role in inspection.missing if role.startswith("emg_")]
    if silent:
        lines.append(
            f"no channel of {', '.join(silent)}: the mapping fixes their weights at 0, which is "
            "right only while these muscles are silent"
        )
    lines += [
        f"{role}: the unit of {c.column!r} is not known (the file says {c.unit or 'none'}): see "
        "the mapping"
        for role, c in inspection.roles.items()
        if c.known_unit is None
    ]
    lines += [
        sentence
        for c in inspection.roles.values()
        if c.look is not None and inspection.emg is not None
        if (sentence := contradiction(repr(c.column), c.look, inspection.emg))
    ]
    if inspection.emg is None and inspection.emg_rule:
        lines.append(
            f"whether the EMG is raw is unclear ({inspection.emg_rule}): write it in the mapping"
        )
    if "angle" in inspection.roles or "torque" in inspection.roles:
        lines.append(
            "we can’t tell which direction of angle and torque is positive: check sign in the "
            "mapping "
            "(dorsiflexion positive; torque positive when the triceps pulls)"
        )
    if inspection.direction:
        lines.append(inspection.direction)
    return lines
