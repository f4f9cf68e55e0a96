"""What files call a record's fields, stated above its ``@dataclass`` (`surae.base.records`)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Form:
    """How files have a record, where that is not by its fields alone; see `filed`."""

    without: frozenset[str] = frozenset()
    sparse: frozenset[str] = frozenset()
    types: str = ""
    strict: bool = False
    merged: str = ""
    names: Mapping[str, str] = field(default_factory=dict)


#: Of those that need one.
FORMS: dict[type, Form] = {}


def filed(
    *without: str,
    sparse: tuple[str, ...] = (),
    types: str = "",
    strict: bool = False,
    merged: str = "",
    **names: str,
) -> Callable[[type[T]], type[T]]:
    """Say how files have a record.

    Fields `without` are not written, and read as their default or None; `sparse` ones are written
    only where they are not their default; `names` are what files call a field, or a property that
    is written too. `types` is the module of types that are imported for type checkers alone. Of a
    `strict` one other keys are refused. The fields of the record that is `merged` stand among its
    own; its type is what the class method `type_of_merged` says of the plain data.
    """

    def noted(kind: Any) -> Any:
        FORMS[kind] = Form(frozenset(without), frozenset(sparse), types, strict, merged, names)
        return kind

    return noted
