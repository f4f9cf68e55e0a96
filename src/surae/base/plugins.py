"""What other distributions add, as entry points: models, integrators, readers, devices and more.

A plugin is loaded when something is looked for that surae itself does not have. One that is broken
is left out, and one line on stderr says why.
"""

import logging
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from itertools import chain
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

V_co = TypeVar("V_co", covariant=True)


@cache
def plugins(group: str, kind: type) -> dict[str, Any]:
    """What installed distributions offer as entry points of the group ``surae.<group>``, by name.

    The group is "models", "integrators", "readers", "devices", "sources", "measures", "checks",
    "integrators" or "commands". Each has to be of a `kind`; its
    `name`, if it has one, is its entry point's.
    """
    from importlib.metadata import entry_points

    usable: dict[str, Any] = {}
    for point in entry_points(group=f"surae.{group}"):
        _homes.setdefault(point.module.partition(".")[0], _offer(point))
        if point.name in usable:
            _log.warning("surae: %s is left out: there is another of its name", _offer(point))
            continue
        try:
            offered: Any = loaded(point)
            if not isinstance(offered, kind):
                raise TypeError(f"it is no {kind.__name__}")
            name = getattr(offered, "name", point.name)
            if name != point.name:
                raise ValueError(f"it calls itself {name!r}")
        except Exception as error:
            why = " ".join(f"{type(error).__name__}: {error}".split())
            _log.warning("surae: %s is left out of %s: %s", point.name, point.group, why)
        else:
            usable[point.name] = offered
    return usable


def loaded(point: "EntryPoint") -> Any:
    """What an entry point offers; one that ends the program instead is an error.

    Raises
    ------
    ImportError
        It ended the program.
    """
    try:
        return point.load()
    except SystemExit as error:
        raise ImportError(f"it ended the program ({error.code})") from None


def plugin_of(error: BaseException) -> str:
    """Which plugin an error comes from, by where it was raised; empty for none of them.

    What was called there may be surae's: the innermost code of a plugin is named.
    """
    named = ""
    place = error.__traceback__
    while place is not None:
        root = str(place.tb_frame.f_globals.get("__name__", "")).partition(".")[0]
        named = named if root == "surae" else _homes.get(root, named)
        place = place.tb_next
    return named


def _offer(point: "EntryPoint") -> str:
    """A plugin in words: its name, what it is, and whose."""
    whose = f" of {point.dist.name}" if point.dist is not None else ""
    return f"{point.name} ({point.group}{whose})"


#: Plugins in words by the package that they are in; surae's own are none.
_homes: dict[str, str] = {}


class Extended(Mapping[str, V_co]):
    """What surae has by name, and behind it what plugins add: looked up only where need be."""

    __slots__ = ("_more", "_own")

    def __init__(self, own: Mapping[str, V_co], more: Callable[[], Mapping[str, V_co]]) -> None:
        self._own = own
        self._more = more

    def __getitem__(self, name: str) -> V_co:
        return self._own[name] if name in self._own else self._more()[name]

    def __iter__(self) -> Iterator[str]:
        return chain(self._own, (name for name in self._more() if name not in self._own))

    def __len__(self) -> int:
        return len({*self._own, *self._more()})


_log = logging.getLogger("surae.base.plugins")
