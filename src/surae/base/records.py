"""Frozen records as plain JSON data, and back: what every file of surae is made of.

A file has every field of a record by its name, so a new field with a default needs nothing here,
and files without it are still read. Where a file has another name for a field, or not all of them,
the record says so itself (`surae.base.filed`). What is read is of the declared types, or refused in
one line that names the field.
"""

import base64
import json
import math
import tomllib
import types
import zlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum, StrEnum
from functools import cache
from importlib import import_module
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np

from surae._version import __version__
from surae.base.errors import InputError
from surae.base.filed import FORMS, Form
from surae.base.files import PathLike, read_bytes, shown, write_json
from surae.base.formatting import nearest
from surae.base.frozen import FrozenDict, read_only
from surae.base.units import FloatArray

if TYPE_CHECKING:
    from cattrs import Converter

T = TypeVar("T")

#: Layouts of FIT.json and of a session's index; raised when an older surae could not read them.
FORMAT, SESSION_FORMAT = 2, 1
#: Bytes of a TOML file, and how deep it may be nested: ours are three deep.
_TOML, _NESTED = 16 * 2**20, 32
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
    return _converter().unstructure(record)


def from_plain(kind: type[T], data: Any) -> T:
    """The record that `to_plain` made plain; an error begins with the place in it."""
    try:
        return _converter().structure(data, kind)
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
        where, text = (where if where.endswith(f".{key}") else f"{where}.{key}"), "it is missing"
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
    try:
        return from_plain(kind, plain)
    except InputError as error:
        raise InputError(f"{shown(path)}: {error}") from None


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


class Saved:
    """What is saved as a JSON file of its plain data."""

    __slots__ = ()

    def as_dict(self) -> dict[str, Any]:
        """Give everything as plain data, as it is saved."""
        return {"surae": __version__, **to_plain(self)}

    def save(self, path: PathLike) -> None:
        """Write all of it to the file `path`, or nothing; InputError where that cannot be done."""
        write_json(path, self.as_dict())


def real(value: object) -> float:
    """A finite number; text, true and false are none."""
    with suppress(OverflowError, ValueError, TypeError):
        if isinstance(value, int | float) and math.isfinite(value) and not isinstance(value, bool):
            return float(value)
    raise ValueError(f"{brief(value)} is not a finite number")


def brief(value: object) -> str:
    """A value as it appears in a message."""
    try:
        text = repr(value)
    except ValueError:
        return "a number of thousands of digits"
    return text if len(text) <= 60 else f"{text[:57]}..."


def finite(value: float) -> float | None:
    """A number as JSON has it: None where it is not finite."""
    value = value.item() if isinstance(value, np.generic) else value
    return value if math.isfinite(value) else None


_ENCODING = "float64 little-endian, zlib, base64"
#: A file's arrays hold so many times the bytes that they are packed in at most.
_PACKS = 100


def encode(array: FloatArray) -> dict[str, Any]:
    """An array as plain JSON data: its shape, how it is packed, and the packed bytes."""
    packed = zlib.compress(np.ascontiguousarray(array, dtype="<f8").tobytes(), 6)
    return {
        "shape": list(array.shape),
        "encoding": _ENCODING,
        "data": base64.b64encode(packed).decode("ascii"),
    }


def bound_arrays(data: Any) -> None:
    """Refuse packed arrays that claim far more numbers than what was measured packs into.

    Noise, which each measured signal and each residual is, packs to three quarters; a file of
    traces of which most are zero to a twelfth.
    """
    claimed, packed, open_ = 0, 0, [data]
    while open_:
        part = open_.pop()
        if isinstance(part, Mapping) and {"shape", "encoding", "data"} <= part.keys():
            sizes = part["shape"] if isinstance(part["shape"], list) else []
            if all(type(n) is int and n >= 0 for n in sizes):
                claimed += 8 * math.prod(sizes)
            packed += len(part["data"]) if isinstance(part["data"], str) else 0
        elif isinstance(part, Mapping | list):
            open_ += part.values() if isinstance(part, Mapping) else part
    if claimed > _PACKS * packed + 2**20:
        raise InputError(f"its arrays claim {claimed / 2**20:.3g} MiB in {packed / 2**20:.2g} MiB")


def decode(packed: Mapping[str, Any]) -> FloatArray:
    """The array that `encode` packed, else ValueError; in no more memory than its shape takes."""
    shape = packed["shape"]
    if packed["encoding"] != _ENCODING or not all(type(n) is int and n >= 0 for n in shape):
        raise ValueError(f"an array is packed as {brief(packed['encoding'])}, {brief(shape)}")
    size = 8 * math.prod(shape)
    unpacker = zlib.decompressobj()
    try:
        data = unpacker.decompress(base64.b64decode(packed["data"], validate=True), size + 1)
    except (zlib.error, OverflowError) as error:
        raise ValueError(str(error)) from None
    if len(data) != size:
        raise ValueError(f"an array holds {len(data)} bytes, expected {size}")
    return read_only(np.frombuffer(data, dtype="<f8").reshape(shape))


def _array(value: Any, _: object) -> FloatArray:
    if isinstance(value, Mapping):
        return decode(value)
    array = np.array(value)
    if not isinstance(value, np.ndarray | list) or (array.size and array.dtype.kind not in "fiu"):
        raise ValueError(f"{brief(value)} is no list of numbers")
    return read_only(array)


@cache
def _converter() -> "Converter":
    """The one converter; its hooks are by the declared type of what they read or write."""
    from cattrs import Converter

    made = Converter(structure_fallback_factory=lambda _: _as_it_is)
    for kind in (str, int, bool):
        made.register_structure_hook(kind, _exactly)
    made.register_structure_hook(float, lambda value, _: real(value))
    made.register_unstructure_hook(float, finite)
    made.register_unstructure_hook(StrEnum, str)
    hooks: tuple[tuple[Callable[[Any], bool], Any, Any], ...] = (
        (_is(object), lambda _: _as_it_is, lambda _: to_plain),
        (_is(np.generic), None, lambda _: lambda number: to_plain(number.item())),
        (_is(Mapping), _mapping_in, _mapping_out),
        (_is(tuple, list), _tuple_in, _tuple_out),
        (_is(np.ndarray), lambda _: _array, lambda _: encode),
        (lambda kind: get_origin(kind) in (Union, types.UnionType), _union_in, None),
        (lambda kind: get_origin(kind) is Annotated, _annotated_in, _annotated_out),
        (lambda kind: get_origin(kind) is Literal, _word_in, None),
        (lambda kind: isinstance(kind, type) and is_dataclass(kind), _record_in, _record_out),
    )
    for holds, structure, unstructure in hooks:
        if structure is not None:
            made.register_structure_hook_factory(holds, structure)
        if unstructure is not None:
            made.register_unstructure_hook_factory(holds, unstructure)
    return made


def _is(*wanted: type) -> Callable[[Any], bool]:
    """Whether a type is one of these, or made of one; a record of several fields is not."""

    def holds(kind: Any) -> bool:
        kind = get_origin(kind) or kind
        if kind is object or object in wanted:
            return kind is object and object in wanted
        return isinstance(kind, type) and issubclass(kind, wanted) and not is_dataclass(kind)

    return holds


def _as_it_is(value: Any, kind: Any) -> Any:
    """What is there already, and not read from a file."""
    if isinstance(kind, type) and not isinstance(value, kind):
        raise ValueError(f"{brief(value)} is no {kind.__name__}")
    return value


_SORTS: Mapping[Any, str] = {str: "a text", int: "a whole number", bool: "true or false",
                             float: "a number", tuple: "a list"}  # fmt: skip


def _exactly(value: Any, kind: type) -> Any:
    if issubclass(kind, Enum):
        return kind(_one_of(value, list(kind)))
    if type(value) is not kind:
        raise ValueError(f"{brief(value)} is not {_SORTS[kind]}")
    return value


def _word_in(kind: Any) -> Any:
    return lambda value, _: _one_of(value, get_args(kind))


def _one_of(value: Any, words: Sequence[str]) -> Any:
    for word in words:
        if word == value and not isinstance(value, bool):
            return word
    raise ValueError(f"{brief(value)} is none of: {', '.join(map(str, words))}")


def _mapping_in(kind: Any) -> Any:
    from cattrs.gen import make_mapping_structure_fn

    read: Any = make_mapping_structure_fn(kind, _converter(), FrozenDict)

    def structure(value: Any, _: object) -> Any:
        if not isinstance(value, Mapping):
            raise ValueError(f"{brief(value)} is no table of names and values")
        return read(value, kind)

    return structure


def _mapping_out(kind: Any) -> Any:
    write = _converter().get_unstructure_hook((*get_args(kind), Any, Any)[1])
    return lambda entries: {key: write(entry) for key, entry in entries.items()}


def _tuple_in(kind: Any) -> Any:
    from cattrs.cols import list_structure_factory

    named = getattr(kind, "_fields", None)
    parts = tuple(get_type_hints(kind).values()) if named else get_args(kind)
    several = list_structure_factory(kind, _converter())

    def structure(value: Any, _: object) -> Any:
        if not isinstance(value, list | tuple):
            raise ValueError(f"{brief(value)} is no list")
        if len(parts) == 2 and parts[1] is Ellipsis:
            return tuple(several(value, kind))
        if len(parts) != len(value):
            raise ValueError(f"{brief(value)} are {len(value)} values, not {len(parts)}")
        made = [_converter().structure(v, part) for v, part in zip(value, parts, strict=True)]
        return kind(*made) if named else tuple(made)

    return structure


def _tuple_out(kind: Any) -> Any:
    made, parts = _converter(), get_args(kind)
    if not parts or parts[-1] is Ellipsis:
        write = made.get_unstructure_hook(parts[0] if parts else Any)
        return lambda values: [write(value) for value in values]
    hooks = [made.get_unstructure_hook(part) for part in parts]
    return lambda values: [hook(value) for hook, value in zip(hooks, values, strict=True)]


def _union_in(kind: Any) -> Any:
    """The first of several types that fits; what is wrong is said of the last."""
    kinds = [part for part in get_args(kind) if part is not type(None)]

    def structure(value: Any, _: object) -> Any:
        if value is None and len(kinds) < len(get_args(kind)):
            return None
        for part in kinds[:-1]:
            with suppress(Exception):
                return _converter().structure(value, part)
        if len(kinds) > 1 and all((get_origin(part) or part) in _SORTS for part in kinds):
            try:
                return _converter().structure(value, kinds[-1])
            except Exception:
                sorts = dict.fromkeys(_SORTS[get_origin(part) or part] for part in kinds)
                raise ValueError(f"{brief(value)} is none of: {', '.join(sorts)}") from None
        return _converter().structure(value, kinds[-1])

    return structure


def _annotated_in(kind: Any) -> Any:
    inner, mark = get_args(kind)[:2]
    read = _converter().get_structure_hook(inner)
    if isinstance(mark, float):
        return lambda value, _: mark if value is None else read(value, inner)
    if isinstance(mark, tuple):
        return lambda value, _: read(
            [value[name] for name in mark] if isinstance(value, Mapping) else value, inner
        )
    return lambda value, _: read(value, inner)


def _annotated_out(kind: Any) -> Any:
    inner, mark = get_args(kind)[:2]
    write = _converter().get_unstructure_hook(inner)
    if isinstance(mark, tuple):
        return lambda values: dict(zip(mark, write(values), strict=True))
    if mark == "name":
        return lambda path: str(path).replace("\\", "/").rsplit("/", 1)[-1]
    return (lambda array: array.tolist()) if mark == "listed" else write


def _form(kind: Any) -> tuple[Form, set[str]]:
    """How files have a record, and its fields, whose types are settled."""
    form = FORMS.get(kind, Form())
    if form.types:
        hints = get_type_hints(kind, localns=vars(import_module(form.types)), include_extras=True)
        for field in fields(kind):
            field.type = hints[field.name]
    return form, {field.name for field in fields(kind)}


def _record_in(kind: Any) -> Any:
    from cattrs.gen import make_dict_structure_fn, override

    form, own = _form(kind)
    absent = {f.name for f in fields(kind) if f.default is f.default_factory is MISSING}

    @cache
    def read() -> Any:  # made when first used: parts that are there already need no reading
        named: Any = {
            name: override(rename=file) for name, file in form.names.items() if name in own
        }
        return make_dict_structure_fn(kind, _converter(), **named)

    def structure(value: Any, _: object) -> Any:
        if isinstance(value, kind):
            return value
        if not isinstance(value, Mapping):
            raise ValueError(f"{brief(value)} is no table of names and values")
        known = [form.names.get(field.name, field.name) for field in fields(kind)]
        if form.strict and (other := next((key for key in value if key not in known), None)):
            near = nearest(str(other), known)
            raise ValueError(f"key {brief(other)} is not known{near}; use: {', '.join(known)}")
        return read()({**dict.fromkeys(form.without & absent), **value}, kind)

    return structure


def _record_out(kind: Any) -> Any:
    from cattrs.gen import make_dict_unstructure_fn, override

    form, own = _form(kind)
    named: Any = {
        name: override(
            rename=form.names.get(name),
            omit=name in form.without,
            omit_if_default=name in form.sparse,
        )
        for name in own
    }
    write = make_dict_unstructure_fn(kind, _converter(), **named)
    derived = {name: file for name, file in form.names.items() if name not in own}
    return lambda record: {
        **write(record),
        **{file: to_plain(getattr(record, name)) for name, file in derived.items()},
    }
