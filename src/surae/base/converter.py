"""The one converter of records: its hooks, by the declared type of what they read or write."""

import types
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
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np

from surae.base.file_form import FORMS, Form
from surae.base.formatting import nearest
from surae.base.frozen import FrozenDict, read_only
from surae.base.packed import brief, decode, encode, finite, real
from surae.base.units import FloatArray

if TYPE_CHECKING:
    from cattrs import Converter


def _array(value: Any, _: object) -> FloatArray:
    if isinstance(value, Mapping):
        return decode(value)
    array = np.array(value)
    if not isinstance(value, np.ndarray | list) or (array.size and array.dtype.kind not in "fiu"):
        raise ValueError(f"{brief(value)} is no list of numbers")
    return read_only(array)


@cache
def converter() -> "Converter":
    """The one converter; its hooks are by the declared type of what they read or write."""
    from cattrs import Converter

    made = Converter(structure_fallback_factory=lambda _: _as_it_is)
    for kind in (str, int, bool):
        made.register_structure_hook(kind, _exactly)
    made.register_structure_hook(float, lambda value, _: real(value))
    made.register_unstructure_hook(float, finite)
    for text in (str, StrEnum):
        made.register_unstructure_hook(text, str)
    hooks: tuple[tuple[Callable[[Any], bool], Any, Any], ...] = (
        (_is(object), lambda _: _as_it_is, lambda _: made.unstructure),
        (_is(np.generic), None, lambda _: lambda number: made.unstructure(number.item())),
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


_SORTS: Mapping[Any, str] = {
    str: "a text",
    int: "a whole number",
    bool: "true or false",
    float: "a number",
    tuple: "a list",
}


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

    read: Any = make_mapping_structure_fn(kind, converter(), FrozenDict)

    def structure(value: Any, _: object) -> Any:
        if not isinstance(value, Mapping):
            raise ValueError(f"{brief(value)} is no table of names and values")
        return read(value, kind)

    return structure


def _mapping_out(kind: Any) -> Any:
    write = converter().get_unstructure_hook((*get_args(kind), Any, Any)[1])
    return lambda entries: {key: write(entry) for key, entry in entries.items()}


def _tuple_in(kind: Any) -> Any:
    from cattrs.cols import list_structure_factory

    named = getattr(kind, "_fields", None)
    parts = tuple(get_type_hints(kind).values()) if named else get_args(kind)
    several = list_structure_factory(kind, converter())

    def structure(value: Any, _: object) -> Any:
        if not isinstance(value, list | tuple):
            raise ValueError(f"{brief(value)} is no list")
        if len(parts) == 2 and parts[1] is Ellipsis:
            return tuple(several(value, kind))
        if len(parts) != len(value):
            raise ValueError(f"{brief(value)} are {len(value)} values, not {len(parts)}")
        made = [converter().structure(v, part) for v, part in zip(value, parts, strict=True)]
        return kind(*made) if named else tuple(made)

    return structure


def _tuple_out(kind: Any) -> Any:
    made = converter()
    parts = get_args(kind)
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
                return converter().structure(value, part)
        if len(kinds) > 1 and all((get_origin(part) or part) in _SORTS for part in kinds):
            try:
                return converter().structure(value, kinds[-1])
            except Exception:
                sorts = dict.fromkeys(_SORTS[get_origin(part) or part] for part in kinds)
                raise ValueError(f"{brief(value)} is none of: {', '.join(sorts)}") from None
        return converter().structure(value, kinds[-1])

    return structure


def _annotated_in(kind: Any) -> Any:
    inner, mark = get_args(kind)[:2]
    read = converter().get_structure_hook(inner)
    if isinstance(mark, float):
        return lambda value, _: mark if value is None else read(value, inner)
    if isinstance(mark, tuple):
        return lambda value, _: read(
            [value[name] for name in mark] if isinstance(value, Mapping) else value, inner
        )
    return lambda value, _: read(value, inner)


def _annotated_out(kind: Any) -> Any:
    inner, mark = get_args(kind)[:2]
    write = converter().get_unstructure_hook(inner)
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

    form, names = _form(kind)
    absent = {f.name for f in fields(kind) if f.default is f.default_factory is MISSING}

    @cache
    def read() -> Any:  # made when first used: parts that are there already need no reading
        named: Any = {
            name: override(rename=file) for name, file in form.names.items() if name in names
        }
        return make_dict_structure_fn(kind, converter(), **named)

    def structure(value: Any, _: object) -> Any:
        if isinstance(value, kind):
            return value
        if not isinstance(value, Mapping):
            raise ValueError(f"{brief(value)} is no table of names and values")
        known = [form.names.get(field.name, field.name) for field in fields(kind)]
        if form.strict and (other := next((key for key in value if key not in known), None)):
            near = nearest(str(other), known)
            raise ValueError(f"key {brief(other)} is not known{near}; use: {', '.join(known)}")
        if form.merged:
            inner = kind.type_of_merged(value)
            value = {**value, form.merged: converter().structure(value, inner)}
        return read()({**dict.fromkeys(form.without & absent), **value}, kind)

    return structure


def _record_out(kind: Any) -> Any:
    from cattrs.gen import make_dict_unstructure_fn, override

    form, names = _form(kind)
    named: Any = {
        name: override(
            rename=form.names.get(name),
            omit=name in form.without,
            omit_if_default=name in form.sparse,
        )
        for name in names
    }
    write = make_dict_unstructure_fn(kind, converter(), **named)
    derived = {name: file for name, file in form.names.items() if name not in names}

    def plain(record: Any) -> dict[str, Any]:
        made = write(record)
        for name, file in derived.items():
            made[file] = converter().unstructure(getattr(record, name))
        inner = made.pop(form.merged) if form.merged else {}
        return {**made, **inner}

    return plain
