"""Which stream is which, for good: after a restart too, whichever program began first.

A stream is known by its name, source, type, channels and computer. As long as no other of its name
was there at the same time it is called by its name alone; from then on, in this folder, each of
them by its name and what tells it from the others: "Amp (A17)".
"""

import json
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from surae.base.cleaning import cleaned
from surae.base.errors import SuraeError
from surae.base.files import read_bytes, sha256, write_atomic
from surae.base.words import N_

#: The file of a folder of trials that says which streams were there together.
STREAMS = "streams.json"
#: Letters of what tells a stream from others, and of a file of them.
_MARK = 40
_MOST = 2**20
#: Streams of one name that are remembered.
_TWINS = 64

#: What keeps a trial from being begun.
ALIKE = N_(
    "Two streams are called {stream}, and nothing tells them apart: give one another source "
    "(source_id), or end it."
)
WHICH = N_("Several streams are called {stream}: say in the mapping which is meant, as {names}.")
TWICE = N_(
    "Two channels say that they are the same signal ({role}): {names}. Say in a --mapping which it "
    "is, or end the other stream."
)


@dataclass(frozen=True, slots=True)
class Identity:
    """What a stream is known by."""

    name: str
    source: str  #: As its program says; empty where it says none.
    kind: str
    labels: tuple[str, ...]  #: Of its channels.
    host: str

    @property
    def marks(self) -> tuple[str, ...]:
        """What may tell it from others of its name, the surest first."""
        channels = f"{len(self.labels)} channels, {', '.join(self.labels)}"
        return tuple(cleaned(text, _MARK) for text in (self.source, self.kind, channels, self.host))

    def called_as(self, mark: str) -> str:
        """Its name with what tells it from others."""
        return f"{self.name} ({mark})"

    def told_from(self, others: Iterable["Identity"]) -> str:
        """Its name with the surest mark that none of the others has, whichever came first."""
        others = tuple(others)
        for place, mark in enumerate(self.marks):
            if mark and all(other.marks[place] != mark for other in others):
                return self.called_as(mark)
        return self.numbered

    @property
    def numbered(self) -> str:
        """Its name with a number that is made of all that it is known by."""
        return self.called_as(sha256(json.dumps(asdict(self)).encode())[:8])


class Identities:
    """Streams that were there together, in a folder's file; `columns` are those of its mapping."""

    def __init__(self, file: Path | None = None, columns: Sequence[str] = ()) -> None:
        self._file = file
        self.columns = tuple(columns)
        #: By name: those that were there at the same time.
        self._together: dict[str, list[Identity]] = {}
        if file is not None:
            with suppress(OSError, ValueError, TypeError, AttributeError, KeyError, RecursionError):
                self._read(json.loads(read_bytes(file, _MOST)))

    def meet(self, one: Identity, beside: Iterable[Identity]) -> bool:
        """Know a stream with those that are there beside it; whether names change by it."""
        known = self._together.get(one.name, [])
        others = [each for each in beside if each.name == one.name and each != one]
        fresh = [each for each in (*others, one) if each not in known]
        if not others or not fresh:
            return False
        self._together[one.name] = [*known, *fresh][-_TWINS:]
        if self._file is not None:
            with suppress(OSError, SuraeError):  # on a full disk it is known in memory
                write_atomic(self._file, json.dumps(self._plain(), indent=1))
        return True

    def called(self, one: Identity) -> str:
        """What a stream is called in files, on the screen and in mappings."""
        forms = {one.called_as(mark) for mark in one.marks if mark}
        others = [each for each in self._together.get(one.name, ()) if each != one]
        taken = {each.called_as(mark) for each in others for mark in each.marks if mark}
        asked = [f for f in sorted(forms - taken) if self._is_asked(f)]
        if len(asked) == 1:
            return asked[0]
        if not others:
            return one.name
        called = one.told_from(others)
        return one.numbered if called in taken else called

    def ambiguous(self) -> dict[str, list[str]]:
        """Names in the mapping that several streams have, with what each of them is called."""
        return {
            name: sorted(self.called(each) for each in twins)
            for name, twins in self._together.items()
            if self._is_asked(name)
        }

    def _is_asked(self, called: str) -> bool:
        return any(column.startswith(f"{called}: ") for column in self.columns)

    def _plain(self) -> dict[str, list[dict[str, object]]]:
        return {name: [asdict(each) for each in twins] for name, twins in self._together.items()}

    def _read(self, data: dict[str, list[dict[str, Any]]]) -> None:
        for name, twins in data.items():
            every = [_identity(each) for each in twins[:_TWINS]]
            self._together[name] = [each for each in every if each.name == name]


def _identity(plain: dict[str, Any]) -> Identity:
    """What a file says of a stream, which may be damaged."""
    name, source, kind, host = (
        cleaned(str(plain[key])) for key in ("name", "source", "kind", "host")
    )
    return Identity(name, source, kind, tuple(cleaned(str(e)) for e in plain["labels"]), host)
