"""What other distributions add, as entry points: models, integrators, readers, devices and more.

A plugin is loaded when something is looked for that surae itself does not have. One that is broken
is left out, and one line on stderr says why.
"""

import logging
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from itertools import chain
from typing import Any, TypeVar

V_co = TypeVar("V_co", covariant=True)


@cache
def plugins(group: str, kind: type) -> dict[str, Any]:
    """What installed distributions offer as entry points of the group ``surae.<group>``, by name.

    The group is "models", "integrators", "readers", "devices", "sources", "measures", "checks",
    "integrators" or "commands". Each has to be of a `kind`; its
    `name`, if it has one, is its entry point's.
    """
    from importlib.metadata import entry_points

    found = {}
    for point in entry_points(group=f"surae.{group}"):
        try:
            offered: Any = point.load()
            if not isinstance(offered, kind):
                raise TypeError(f"it is no {kind.__name__}")
            name = getattr(offered, "name", point.name)
            if name != point.name:
                raise ValueError(f"it calls itself {name!r}")
        except Exception as error:
            why = " ".join(f"{type(error).__name__}: {error}".split())
            _log.warning("surae: %s is left out of %s: %s", point.name, point.group, why)
        else:
            found[point.name] = offered
    return found


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
