"""Trials side by side: groups of columns, sheets and structures that each hold a recording.

A group's columns share what stands before their names (``run 1: Angle``, ``trial(2).angle``), or a
number in them (``Angle 1``, ``Torque 1``, ``Angle 2``; ``angle.1`` as pandas names a second one).
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from surae.base.errors import InputError
from surae.recording.roles import guess_role
from surae.recording.table import Column, Table, some
from surae.recording.times import is_time, timed_by

#: What may stand between a group's name and a column's.
_BETWEEN = (": ", "/", ".")
#: A number in a column's name that is no part of a word, with what joins it.
_NUMBERED = re.compile(r"(?P<before>.*?\D)?(?:[ _#(-]|\b)(?P<number>\d{1,3})\)?(?P<behind>\D.*)?")
#: What is left of ``angle(:,1)`` and ``angle(1,:)``.
_OF_A_MATRIX = re.compile(r"(?:\(:,|,:\))$")
_AGAIN = re.compile(r"(?P<before>.*\D)\.(?P<number>\d{1,3})")


def groups_of(names: Sequence[str]) -> Mapping[str, Mapping[str, str]]:
    """Groups of columns that each hold the same recording: a column's name by its name in it.

    A recording is an angle, and a torque or an EMG; of groups that a number alone tells apart all
    three. Empty where there are none.
    """
    for between in _BETWEEN:
        groups: dict[str, dict[str, str]] = {}
        for name in names:
            group, _, member = name.rpartition(between)
            if group:
                groups.setdefault(group, {}).setdefault(member, name)
        if alike := _alike(groups):
            return alike
    return _numbered(names)


def _alike(groups: Mapping[str, Mapping[str, str]]) -> dict[str, Mapping[str, str]]:
    """Those of the groups that hold the same recording."""
    alike: dict[tuple[str, ...], list[str]] = {}
    for group, members in groups.items():
        alike.setdefault(tuple(sorted(members)), []).append(group)
    for held, several in alike.items():
        roles = _roles(held)
        if len(several) > 1 and "angle" in roles and len(roles) > 1:
            return {group: groups[group] for group in several}
    return {}


def _numbered(names: Sequence[str]) -> dict[str, Mapping[str, str]]:
    """Groups that a number in every name tells apart, counted from 0 or 1 without a gap."""
    if any(_AGAIN.fullmatch(name) for name in names):
        matches = {name: _AGAIN.fullmatch(name) for name in names}
        first = {name for name, match in matches.items() if match is None}
    else:
        matches = {name: _NUMBERED.fullmatch(name) for name in names}
        first = set()
    groups: dict[str, dict[str, str]] = {}
    for name, match in matches.items():
        if match is not None:
            parts = match.groupdict()
            bare = f"{parts['before'] or ''}{parts.get('behind') or ''}".strip(" _-")
            bare = _OF_A_MATRIX.sub("", bare)
            groups.setdefault(str(int(match["number"])), {})[bare] = name
        elif name in first:
            groups.setdefault("0", {})[name] = name
    counted = sorted(map(int, groups))
    if counted not in ([*range(len(counted))], [*range(1, len(counted) + 1)]):
        return {}
    alike = _alike(groups)
    whole = len(alike) == len(groups) > 1
    roles = _roles(next(iter(alike.values()), ()))
    return alike if whole and "torque" in roles and len(roles) > 2 else {}


def _roles(names: Sequence[str] | Mapping[str, str]) -> set[str]:
    """Which of angle, torque and EMG names say."""
    guessed = {str(guess.role) for name in names if (guess := guess_role(name)) is not None}
    kinds = {"emg" if role.startswith("emg_") else role for role in guessed}
    return kinds & {"angle", "torque", "emg"}


def of_group(table: Table, group: str, where: str) -> Table:
    """The columns of one group, sheet or structure, by their names in it.

    Raises
    ------
    InputError
        There is no such group.
    """
    members = groups_of(table.names).get(group, {})
    for between in _BETWEEN:
        start = group + between
        members = members or {n.removeprefix(start): n for n in table.names if n.startswith(start)}
    if not members:
        groups = [*groups_of(table.names)]
        has = f"it holds: {some(groups)}" if groups else "its columns are in no groups"
        raise InputError(f"{where}: trial: {table.file} has no group {group!r}; {has}")
    time = next((full for name, full in members.items() if is_time(name)), "")
    if time and time in table.names:  # each group has times of its own
        table = timed_by(table, time, None, where)
        members = {name: full for name, full in members.items() if full != time}

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        loaded = table.load([members[name] for name in wanted])
        return {name: replace(loaded[members[name]], name=name) for name in wanted}

    def mine(said: Mapping[str, str]) -> dict[str, str]:
        return {name: said[full] for name, full in members.items() if full in said}

    return replace(
        table,
        names=tuple(members),
        load=load,
        units=mine(table.units),
        remarks=mine(table.remarks),
        descriptions=mine(table.descriptions),
        offered=None,
        retimed=None,
        cells=None,
    )
