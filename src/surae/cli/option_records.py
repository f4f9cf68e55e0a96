"""Options that belong together, as one record among a command's arguments."""

import functools
from collections.abc import Callable
from dataclasses import fields
from typing import Any, TypeVar

from surae.base.errors import InputError

#: What commands of other distributions are made of.
__all__ = ["as_record"]

F = TypeVar("F", bound=Callable[..., Any])


def as_record(name: str, record: type[Any], *options: Callable[[F], F]) -> Callable[[F], F]:
    """Let a command have options, by the fields of a dataclass, as one argument `name`."""
    names = [each.name for each in fields(record)]

    def decorated(command: F) -> F:
        @functools.wraps(command)
        def with_record(*args: Any, **others: Any) -> Any:
            made = record(**{each: others.pop(each) for each in names})
            return command(*args, **{name: made}, **others)

        whole: Any = with_record
        for option in reversed(options):
            whole = option(whole)
        return whole  # type: ignore[no-any-return]

    return decorated


def refuse(given: dict[str, object], to: str) -> None:
    """Refuse the first option that was given and has no effect on what is written."""
    for option, value in given.items():
        if value:
            raise InputError(f"{option} has no effect on --to {to}; leave it out")
