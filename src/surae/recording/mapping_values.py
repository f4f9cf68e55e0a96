"""Values of a TOML mapping: each is of its type, or one line says where it is not."""

import datetime
import math
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any, cast

from surae.errors import InputError
from surae.recording.source import Source


def parsed(source: Source) -> dict[str, Any]:
    """Parse the TOML's content."""
    source.require_text()
    try:
        return tomllib.loads("".join(source.lines()))
    except ValueError as error:
        # Beside tomllib's own error: Python's, of a number with thousands of digits.
        raise InputError(f"{source.shown}: not valid TOML: {error}") from None
    except RecursionError:
        raise InputError(f"{source.shown}: not valid TOML: nested too deeply") from None


def refuse_unknown(table: Mapping[str, Any], allowed: Sequence[str], where: str) -> None:
    """Refuse keys that aren't in `allowed`."""
    for key in table:
        if key not in allowed:
            raise InputError(f"{where}: key {brief(key)} is not known; use: {', '.join(allowed)}")


def table_in(table: Mapping[str, Any], key: str, where: str) -> dict[str, Any]:
    """A table within a table, empty where it is left out."""
    value = table.get(key, {})
    if not isinstance(value, dict):
        raise InputError(f"{where}: {key} must be a table of names and values")
    return value


def text_in(table: Mapping[str, Any], key: str, where: str) -> str | None:
    """A string, None where it is left out."""
    value = table.get(key)
    if value is not None and not isinstance(value, str):
        raise InputError(f"{where}: {key} is {brief(value)}; it must be a text in quotes")
    return value


def day_in(table: Mapping[str, Any], key: str, where: str) -> str | None:
    """A date as ISO text, None where it is left out; TOML's own dates need no quotes."""
    value = table.get(key)
    if isinstance(value, datetime.date):
        return value.isoformat()
    return text_in(table, key, where)


def yes_in(table: Mapping[str, Any], key: str, where: str) -> bool:
    """A truth value, True where it is left out."""
    value = table.get(key, True)
    if not isinstance(value, bool):
        raise InputError(f"{where}: {key} is {brief(value)}; it must be true or false")
    return value


def choice_in(table: Mapping[str, Any], key: str, allowed: Sequence[str], where: str) -> str | None:
    """One of a few words, None where it is left out."""
    value = table.get(key)
    if value is not None and value not in allowed:
        raise InputError(f"{where}: {key} is {brief(value)}; use one of: {', '.join(allowed)}")
    return cast("str | None", value)


def finite(value: Any, where: str) -> float:
    """Check that a value is a finite number, and give it."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{where} is {brief(value)}; it must be a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InputError(f"{where} is {brief(value)}; it must be a finite number")
    return number


def settings_in(toml: Mapping[str, Any], key: str, where: str) -> dict[str, Any]:
    """A table of plain values, which whoever uses them knows by name."""
    return {
        name: plain(value, f"{where}: {key}.{brief(name)}")
        for name, value in table_in(toml, key, where).items()
    }


def plain(value: Any, where: str) -> Any:
    """A text, number or truth value, or a tuple of them."""
    if isinstance(value, list):
        return tuple(plain(item, where) for item in value)
    if isinstance(value, float):
        return finite(value, where)
    if not isinstance(value, str | int):
        raise InputError(f"{where} must be a text, a number, true, false, or a list of these")
    return value


def brief(value: Any) -> str:
    """A value as it appears in a message."""
    try:
        shown = repr(value)
    except ValueError:
        return "a number with thousands of digits"
    return shown if len(shown) <= 60 else shown[:57] + "..."
