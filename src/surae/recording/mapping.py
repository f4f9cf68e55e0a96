"""A TOML mapping: which column of which file is which signal, in which unit and direction."""

import difflib
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, cast

from surae.errors import InputError
from surae.recording.channels import Scaling, channel, settle_unit
from surae.recording.formats import open_table
from surae.recording.recording import ROLES, Channel, Recording
from surae.recording.source import Source, open_source
from surae.recording.table import Column, Table, some

_TOP = ("name", "emg", "fixed", "side", "device", "prepare", "channels")
_ENTRY = ("file", "column", "unit", "sign", "scale", "offset")
_EMG = ("raw", "envelope")
_SIDES = ("left", "right")

#: How the first line of a TOML file begins: a table, or a key with its equals sign.
_FIRST = re.compile(r"\s*(\[|[\w.\"' -]+=)")


@dataclass(frozen=True, slots=True)
class _Entry:
    """One channel's description, checked on its own."""

    role: str
    where: str
    file: str
    column: str
    unit: str | None
    sign: int
    scale: float
    offset: float


def recognises(source: Source) -> bool:
    """Whether the first line that is no comment is one of TOML."""
    lines = (line for line in source.head() if line.strip() and not line.lstrip().startswith("#"))
    return bool(_FIRST.match(next(lines, "")))


def read_mapping(source: Source) -> Recording:
    """The recording that a TOML file describes.

    A channel's values are ``sign * (scale * raw + offset)`` in its `unit`, then brought to SI.
    Each keeps its own times.

    Raises
    ------
    InputError
        The TOML or a file it names is wrong: a key that isn't known, a missing column, a unit
        that contradicts the file's own, a wrong sample.
    """
    toml = _parsed(source)
    where = source.shown
    roles = _roles(toml, where)
    _refuse_unknown(toml, _TOP, where)
    entries = [_entry(role, roles[role], f"{where}: channels.{role}") for role in roles]
    sources: dict[Path, Source] = {}
    tables: dict[Path, Table] = {}
    wanted: dict[Path, list[str]] = {}
    units: dict[str, str] = {}
    for entry in entries:
        path = Path(source.path).parent / entry.file
        if path not in tables:
            sources[path], tables[path] = _opened(path, entry.where)
        _require_column(tables[path], entry)
        units[entry.role] = settle_unit(
            tables[path], entry.role, entry.column, entry.unit, entry.where
        )
        names = wanted.setdefault(path, [])
        if entry.column not in names:
            names.append(entry.column)
    columns: dict[Path, Mapping[str, Column]] = {
        path: tables[path].load(names) for path, names in wanted.items()
    }
    channels: dict[str, Channel] = {}
    for entry in entries:
        path = Path(source.path).parent / entry.file
        scaling = Scaling(units[entry.role], entry.sign, entry.scale, entry.offset)
        channels[entry.role] = channel(
            entry.role, columns[path][entry.column], scaling, tables[path]
        )
    return Recording(
        name=" ".join((_text(toml, "name", where) or "").split()) or source.name,
        channels=channels,
        emg=cast("Literal['raw', 'envelope']", _choice(toml, "emg", _EMG, where) or "raw"),
        fixed={
            name: _finite(value, f"{where}: fixed.{_brief(name)}")
            for name, value in _table(toml, "fixed", where).items()
        },
        prepare=_settings(toml, "prepare", where),
        side=_choice(toml, "side", _SIDES, where),
        device=_settings(toml, "device", where),
        files=(source.file, *(each.file for each in sources.values())),
    )


def _parsed(source: Source) -> dict[str, Any]:
    """The TOML's content."""
    source.require_text()
    try:
        return tomllib.loads("".join(source.lines()))
    except ValueError as error:
        # Beside tomllib's own error: Python's, of a number with thousands of digits.
        raise InputError(f"{source.shown}: not valid TOML: {error}") from None
    except RecursionError:
        raise InputError(f"{source.shown}: not valid TOML: nested too deeply") from None


def _refuse_unknown(table: Mapping[str, Any], allowed: Sequence[str], where: str) -> None:
    """Refuse keys that aren't in `allowed`."""
    for key in table:
        if key not in allowed:
            raise InputError(f"{where}: key {_brief(key)} is not known; use: {', '.join(allowed)}")


def _roles(toml: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The descriptions by role, the angle among them."""
    if "channels" not in toml:
        raise InputError(
            f"{where}: no channels: a recording's TOML has [channels.angle] with file, column and "
            "unit, and likewise torque, emg_ta, ..."
        )
    roles = _table(toml, "channels", where)
    _refuse_unknown(roles, ROLES, f"{where}: channels")
    if "angle" not in roles:
        raise InputError(f"{where}: channels.angle is missing; every recording needs the angle")
    return roles


def _entry(role: str, body: Any, where: str) -> _Entry:
    """One channel's description."""
    if not isinstance(body, dict):
        raise InputError(f"{where}: must be a table with: {', '.join(_ENTRY)}")
    _refuse_unknown(body, _ENTRY, where)
    file, column = _text(body, "file", where), _text(body, "column", where)
    if not file or not column:
        missing = "column" if file else "file"
        raise InputError(f"{where}: {missing} is missing")
    sign = body.get("sign", 1)
    if isinstance(sign, bool) or sign not in (1, -1):
        raise InputError(f"{where}: sign is {_brief(sign)}; use 1 or -1")
    scale = _finite(body.get("scale", 1.0), f"{where}: scale")
    if scale == 0:
        raise InputError(f"{where}: scale is 0, which would erase the signal")
    return _Entry(
        role=role,
        where=where,
        file=file,
        column=column,
        unit=_text(body, "unit", where),
        sign=int(sign),
        scale=scale,
        offset=_finite(body.get("offset", 0.0), f"{where}: offset"),
    )


def _opened(path: Path, where: str) -> tuple[Source, Table]:
    """A data file that the mapping names; errors say where it is named."""
    try:
        source = open_source(path)
        return source, open_table(source)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _require_column(table: Table, entry: _Entry) -> None:
    """Check that the file has the column, once."""
    count = table.names.count(entry.column)
    if count > 1:
        raise InputError(
            f"{entry.where}: {table.file} has {count} columns {some([entry.column])}; rename one"
        )
    if count == 0:
        near = difflib.get_close_matches(entry.column, table.names, n=3, cutoff=0.5)
        has = f"did you mean {some(near)}?" if near else f"it has: {some(table.names)}"
        raise InputError(f"{entry.where}: {table.file} has no column {some([entry.column])}; {has}")


def _table(table: Mapping[str, Any], key: str, where: str) -> dict[str, Any]:
    """A table within a table, empty where it is left out."""
    value = table.get(key, {})
    if not isinstance(value, dict):
        raise InputError(f"{where}: {key} must be a table of names and values")
    return value


def _text(table: Mapping[str, Any], key: str, where: str) -> str | None:
    """A string, None where it is left out."""
    value = table.get(key)
    if value is not None and not isinstance(value, str):
        raise InputError(f"{where}: {key} is {_brief(value)}; it must be a text in quotes")
    return value


def _choice(table: Mapping[str, Any], key: str, allowed: Sequence[str], where: str) -> str | None:
    """One of a few words, None where it is left out."""
    value = table.get(key)
    if value is not None and value not in allowed:
        raise InputError(f"{where}: {key} is {_brief(value)}; use one of: {', '.join(allowed)}")
    return cast("str | None", value)


def _finite(value: Any, where: str) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{where} is {_brief(value)}; it must be a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InputError(f"{where} is {_brief(value)}; it must be a finite number")
    return number


def _settings(toml: Mapping[str, Any], key: str, where: str) -> dict[str, Any]:
    """A table of plain values, which whoever uses them knows by name."""
    return {
        name: _plain(value, f"{where}: {key}.{_brief(name)}")
        for name, value in _table(toml, key, where).items()
    }


def _plain(value: Any, where: str) -> Any:
    """A text, number or truth value, or a tuple of them."""
    if isinstance(value, list):
        return tuple(_plain(item, where) for item in value)
    if isinstance(value, float):
        return _finite(value, where)
    if not isinstance(value, str | int):
        raise InputError(f"{where} must be a text, a number, true, false, or a list of these")
    return value


def _brief(value: Any) -> str:
    """A value as it appears in a message."""
    try:
        text = repr(value)
    except ValueError:
        return "a number with thousands of digits"
    return text if len(text) <= 60 else text[:57] + "..."
