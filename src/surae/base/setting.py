"""One record for each setting: option, form, schema, keyword and documentation are made from it."""

import math
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass
from functools import wraps
from inspect import Parameter, signature
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import Any, TypeVar, get_args, get_origin

from surae.base.docstrings import docstring
from surae.base.errors import InputError
from surae.base.formatting import nearest
from surae.base.frozen import FrozenDict
from surae.base.names import Names

T = TypeVar("T")
F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """What a field of a request means, and how people and programs give it."""

    meaning: str  #: For documentation, in numpydoc's words.
    type: str = ""  #: What it may be, in the same words, where the annotation does not say it all.
    help: str = ""  #: Of its option; by default `meaning`; none where there is no label either.
    option: str = ""  #: Name of its option, where that is not the field's.
    metavar: str = ""  #: What help writes for its value; of a mapping for that of an entry.
    example: str = ""  #: An entry of a mapping, for the message about one that is misspelt.
    label: str = ""  #: Of its field in a form; none: no field there.
    words: Mapping[str, str] | None = None  #: What a form calls its choices; "": none of them.
    choices: tuple[str, ...] = ()  #: The only values, of text.
    least: float | None = None  #: The smallest number, of all that it holds.
    above: float | None = None  #: All numbers are larger.
    most: float | None = None  #: The largest number.
    #: NAME=VALUE or NAME!=VALUE: a form shows it where another setting has, or has not, this value.
    needs: str = ""
    file: bool = False  #: Whether the path of a file may be given in place of a choice.
    first: bool = False  #: Whether a form shows it at once, not among what few people change.

    @property
    def known(self) -> tuple[str, ...]:
        """The choices that are installed, plugins' too."""
        return self.choices.here() if isinstance(self.choices, Names) else self.choices


def setting(default: Any, meaning: str, **how: Any) -> Any:
    """A field of a request, with its default (a function: what that makes) and its meaning."""
    known: Any = {"default_factory": default} if callable(default) else {"default": default}
    return field(**known, metadata={"setting": Setting(meaning=meaning, **how)})


def settings_of(kind: Any) -> Iterator[tuple["Field[Any]", Setting]]:
    """The fields of a request that are settings, each with its record."""
    return ((f, f.metadata["setting"]) for f in fields(kind) if "setting" in f.metadata)


def default_of(each: "Field[Any]") -> Any:
    """The default of a field."""
    made = each.default_factory
    return each.default if made is MISSING else made()


def kind_of(each: "Field[Any]") -> str:
    """What a field holds, None apart: flag, whole, number, text, names, numbers, range, …."""
    kinds = {bool: "flag", int: "whole", float: "number", str: "text"}
    kind = next(part for part in parts_of(each.type) if part is not NoneType)
    base = get_origin(kind) or kind
    if base is tuple:
        return {(float, ...): "numbers", (float, float): "range"}.get(get_args(kind), "names")
    return kinds.get(base, "mapping" if base is Mapping else "record")


class Request:
    """The settings alone, mappings frozen; a value that one may not have is refused in a line."""

    __slots__ = ()

    def __post_init__(self) -> None:
        """Check each."""
        for each, record in settings_of(type(self)):
            name = each.name
            value = getattr(self, each.name)
            kind = kind_of(each)
            parts = parts_of(each.type)
            if value is None and NoneType in parts:
                continue
            if isinstance(value, Mapping):
                # A pair is a tuple; anything else is refused where it is used.
                value = FrozenDict(
                    (k, tuple(v) if isinstance(v, list) or hasattr(v, "__array__") else v)
                    for k, v in value.items()
                )
            elif kind == "mapping":
                raise InputError(f"{name} is {value!r}; give a mapping of names to values")
            elif kind in ("whole", "number"):
                value = checked(name, value, record, whole=kind == "whole")
            elif (
                record.choices
                and not (record.file and is_dataclass(value))
                and value not in record.choices
            ):
                known = ", ".join(record.choices) + ", or a file's path" * record.file
                known += ", or a mapping" * any(get_origin(part) is Mapping for part in parts)
                near = nearest(str(value), record.choices)
                raise InputError(f"{name} is {value!r}{near}; use one of: {known}")
            object.__setattr__(self, name, value)


def is_number(value: object) -> bool:
    """Whether it is a number, NumPy's too; true, false and NaN are none."""
    return not isinstance(value, bool) and isinstance(value, Real) and not math.isnan(value)


def checked(name: str, value: Any, record: Setting, *, whole: bool) -> Any:
    """A number, of NumPy's too, that a setting may have."""
    kind: Any
    kind, known = (Integral, "a whole number") if whole else (Real, "a number")
    if isinstance(value, bool) or not isinstance(value, kind) or not math.isfinite(value):
        raise InputError(f"{name} is {value!r}; give {known}")
    if record.least is not None and value < record.least:
        raise InputError(f"{name} is {value}; give at least {record.least:g}")
    if record.above is not None and value <= record.above:
        raise InputError(f"{name} is {value}; give more than {record.above:g}")
    if record.most is not None and value > record.most:
        raise InputError(f"{name} is {value}; give at most {record.most:g}")
    return int(value) if whole else float(value)


def parts_of(annotation: Any) -> tuple[Any, ...]:
    """The types of a union, or the one type."""
    return get_args(annotation) if isinstance(annotation, UnionType) else (annotation,)


def _described(kind: Any, *, keywords: bool = False, without: Collection[str] = ()) -> str:
    """The settings of a request as a numpydoc section has them; of keywords with their defaults."""
    from textwrap import wrap

    lines = list[str]()
    inner = " " * 8
    for each, record in settings_of(kind):
        if each.name not in without:
            lines.append(f"    {each.name} : {_type(each, record, keywords)}")
            lines += wrap(record.meaning, 100, initial_indent=inner, subsequent_indent=inner)
    return "\n".join(lines)


def _type(each: "Field[Any]", record: Setting, keyword: bool) -> str:
    """What a setting may be; of a keyword its default too, where that is a plain value."""
    parts = list(map(_name, parts_of(each.type)))
    if record.choices:
        parts[0] = "{" + ", ".join(f'"{choice}"' for choice in record.choices) + "}"
    text = record.type or " or ".join(parts)
    if not keyword:
        return text
    default = default_of(each)
    plain = isinstance(default, bool | int | float | str)
    shown = f"default {default!r}" if plain else "optional"
    return f"{text.removesuffix(' or None').removesuffix(',')}, {shown}"


def _name(part: Any) -> str:
    """A type in numpydoc's words."""
    if get_origin(part) is Mapping:
        return f"mapping of str to {_name(get_args(part)[1])}"
    return {NoneType: "None", Any: "object"}.get(part) or str(getattr(part, "__name__", part))


def documented(kind: type[T]) -> type[T]:
    """Have the docstring of a request describe its settings, where it says ``{settings}``."""
    kind.__doc__ = (kind.__doc__ or "").replace("    {settings}", _described(kind))
    return kind


def takes(*requests: Any, defaults: bool = True) -> Callable[[F], F]:
    """Have the keywords of a function stand for all settings of requests, for help and completion.

    Where its docstring says ``{settings}``, it describes them. Without `defaults` they are None in
    its signature: not given. The signature is without types, which the docstring has in words.
    """

    def decorate(function: F) -> F:
        parameters = [
            p for p in signature(function).parameters.values() if p.kind is not p.VAR_KEYWORD
        ]
        there = {p.name for p in parameters}
        added = [
            Parameter(
                each.name, Parameter.KEYWORD_ONLY, default=default_of(each) if defaults else None
            )
            for request in requests
            for each, _ in settings_of(request)
            if each.name not in there
        ]
        plain = [each.replace(annotation=Parameter.empty) for each in (*parameters, *added)]
        vars(function)["__signature__"] = signature(function).replace(parameters=plain)
        text = "\n".join(_described(each, keywords=True, without=there) for each in requests)
        function.__doc__ = docstring(function).replace("    {settings}", text)
        return function

    return decorate


def renamed(**words: str) -> Callable[[F], F]:
    """Have a function, or a record, take keywords by the names that they had, until surae 0.4."""

    def decorate(what: F) -> F:
        called: Callable[..., Any] = vars(what)["__init__"] if isinstance(what, type) else what

        @wraps(called)
        def either(*args: Any, **keywords: Any) -> Any:
            for old in words.keys() & keywords.keys():
                now = words[old]
                warnings.warn(f"{old} is called {now} now", DeprecationWarning, stacklevel=2)
                keywords[now] = keywords.pop(old)
            return called(*args, **keywords)

        if not isinstance(what, type):
            return either  # type: ignore[return-value]
        type.__setattr__(what, "__init__", either)
        return what

    return decorate
