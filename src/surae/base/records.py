"""Frozen records as plain JSON data, and back: what every file of surae is made of.

A file has every field of a record by its name, so a new field with a default needs nothing here,
and files without it are still read. Where a file has another name for a field, or not all of them,
the record says so itself (`surae.base.file_form`). What is read is of the declared types, or
refused in one line that names the field.
"""

import json
import math
import tomllib
from collections.abc import Mapping
from typing import Annotated, Any, TypeVar

from surae._version import __version__
from surae.base.converter import converter
from surae.base.errors import InputError, within
from surae.base.file_form import FORMS, Form
from surae.base.files import PathLike, read_bytes, shown, write_json
from surae.base.packed import brief
from surae.base.units import FloatArray

T = TypeVar("T")

#: Layouts of FIT.json and of a session's index; raised when an older surae could not read them.
FORMAT = 2
SESSION_FORMAT = 1
#: Bytes of a TOML file, and how deep it may be nested: ours are three deep.
_TOML = 16 * 2**20
_NESTED = 32
#: Numbers that a file has as null where there is none.
OrNaN = Annotated[float, math.nan]
OrInfinite = Annotated[float, math.inf]
OrMinusInfinite = Annotated[float, -math.inf]
#: An array that a file has as lists of numbers; others are packed. Of a tuple annotated with names
#: a file has a table by them.
Listed = Annotated[FloatArray, "listed"]
#: A path of which a file has only the name: folders may be named after patients.
FileName = Annotated[str, "name"]


def to_plain(record: Any) -> Any:
    """A record, or a container of some, as plain data for JSON: numbers that are none are None."""
    return converter().unstructure(record)


def from_plain(kind: type[T], data: Any) -> T:
    """The record that `to_plain` made plain; an error begins with the place in it."""
    try:
        return converter().structure(data, kind)
    except Exception as error:
        raise InputError(_reason(error)) from None


def _reason(error: BaseException) -> str:
    """The first thing that is wrong: where it is in the file, and what it is."""
    where = ""
    while isinstance(error, BaseExceptionGroup):
        form = FORMS.get(getattr(error, "cl", type(None)), Form())
        error = error.exceptions[0]
        for note in getattr(error, "__notes__", ()):
            if hasattr(note, "name"):
                where += f".{form.names.get(note.name, note.name)}"
            elif hasattr(note, "index"):
                key = note.index
                where += f"[{key}]" if isinstance(key, int) else f".{shown(str(key)[:60])}"
    text = " ".join(str(error).split()) or type(error).__name__
    if isinstance(error, KeyError):
        key = str(error.args[0])
        where = where if where.endswith(f".{key}") else f"{where}.{key}"
        text = "it is missing"
    where = where.lstrip(".")
    return f"{where}: {text}" if where else text


def read_json(path: PathLike) -> dict[str, Any]:
    """A JSON object from a file."""
    content = read_bytes(path)
    try:
        data = json.loads(content.decode("utf-8"))
    except UnicodeDecodeError:
        raise InputError(f"{shown(path)}: not a text file, expected JSON") from None
    except RecursionError:
        raise InputError(f"{shown(path)}: nested too deeply, expected JSON of a fit") from None
    except json.JSONDecodeError as error:
        raise InputError(
            f"{shown(path)}: not JSON (line {error.lineno}, column {error.colno}: {error.msg})"
        ) from None
    except ValueError:
        raise InputError(f"{shown(path)}: a number in it has thousands of digits") from None
    if not isinstance(data, dict):
        raise InputError(
            f'{shown(path)}: expected a JSON object {{"…": …}}, found a {type(data).__name__}'
        )
    return data


def read_toml(path: PathLike) -> dict[str, Any]:
    """What a TOML file has; see `parse_toml`."""
    try:
        return parse_toml(read_bytes(path, _TOML).decode("utf-8"))
    except ValueError as error:
        reason = error.reason if isinstance(error, UnicodeDecodeError) else error
        raise InputError(f"{shown(path)}: {reason}") from None


def parse_toml(text: str) -> dict[str, Any]:
    """What a text of TOML says; InputError for what is none, or nested, or numbers, without end."""
    try:
        data = tomllib.loads(text)
    except RecursionError:
        raise InputError("not valid TOML: nested too deeply") from None
    except ValueError as error:  # also of a number with thousands of digits
        raise InputError(f"not valid TOML: {error}") from None
    open_: list[tuple[tuple[str, ...], Any]] = [((), data)]
    while open_:
        keys, part = open_.pop()
        if len(keys) > _NESTED:
            raise InputError("not valid TOML: nested too deeply")
        if isinstance(part, int) and abs(part) >= 2**63:
            where = shown(".".join(keys)[:60])
            raise InputError(f"not valid TOML: {where}: a whole number of more than 64 bits")
        inner = dict(enumerate(part)) if isinstance(part, list) else part
        if isinstance(inner, dict):
            open_ += (((*keys, str(key)), each) for key, each in inner.items())
    return data


def from_file(kind: type[T], path: PathLike, plain: Mapping[str, Any]) -> T:
    """The record that a file has as plain data; what is wrong is said of the file."""
    with within(shown(path)):
        return from_plain(kind, plain)


def check_format(data: Mapping[str, Any], path: PathLike) -> None:
    """Refuse a file whose layout a newer surae made: it may mean what this one does not know."""
    layout = data.get("format", FORMAT)
    if isinstance(layout, bool) or not isinstance(layout, int):
        raise InputError(f"{shown(path)}: format: {brief(layout)} is not a whole number; fit again")
    if layout > FORMAT:
        raise InputError(
            f"{shown(path)}: written by surae {data.get('surae', '?')} in format {layout}, newer "
            f"than this one reads ({__version__}, format {FORMAT}); upgrade surae"
        )


class Plain:
    """What is given as plain data."""

    __slots__ = ()

    def to_json(self) -> dict[str, Any]:
        """Give all of it as plain data."""
        return dict(to_plain(self))


class Saved:
    """What is saved as a JSON file of its plain data."""

    __slots__ = ()

    def as_dict(self) -> dict[str, Any]:
        """Give everything as plain data, as it is saved."""
        return {"surae": __version__, **to_plain(self)}

    def save(self, path: PathLike) -> None:
        """Write all of it to the file `path`, or nothing; InputError where that cannot be done."""
        write_json(path, self.as_dict())
