"""Browsers kept apart: each has its own draft, uploads and history, found by a secret cookie."""

import json
import secrets
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from hashlib import sha256
from typing import Any, NamedTuple

from pydantic import TypeAdapter
from typing_extensions import TypedDict  # as pydantic asks before Python 3.12

from surae.base.errors import SuraeError
from surae_workbench.web.draft import Draft, changed, empty_draft, shown, upgraded
from surae_workbench.web.events import Events
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.places import plural
from surae_workbench.web.project import KEPT, Project
from surae_workbench.web.rows import plain

#: Steps that can be undone.
_STEPS = 200
#: `seen` is written no more often than this [s].
_SEEN = 600.0


@dataclass(frozen=True, slots=True)
class BrowserSession:
    """One browser: `key`, which names it on disk but opens nothing, and its CSRF token."""

    key: str
    csrf: str

    @classmethod
    def new(cls) -> "tuple[BrowserSession, str]":
        """A new session, and the cookie that opens it, which is kept nowhere here."""
        cookie = secrets.token_urlsafe(32)
        return cls(key_of(cookie), secrets.token_urlsafe(32)), cookie


def key_of(cookie: str) -> str:
    """The key of the session that a cookie opens."""
    return sha256(cookie.encode("utf-8", "surrogateescape")).hexdigest()


class _Step(NamedTuple):
    """A step, and what was before and after it."""

    id: int
    label: str
    kind: str
    before: dict[str, Any]
    after: dict[str, Any]


class _Deleted(TypedDict):
    kind: str
    id: str


class _Described(TypedDict):
    rows: dict[str, dict[str, Any]]


#: What is kept of the time before and after a step, by its kind.
_STATES: dict[str, TypeAdapter[Any]] = {
    "draft": TypeAdapter(dict[str, Any]),
    "deleted": TypeAdapter(_Deleted),
    "described": TypeAdapter(_Described),
}


class BrowserSessions:
    """All sessions of a project."""

    def __init__(self, project: Project, events: Events) -> None:
        self._project = project
        self._database = project.database
        self._events = events
        self.project_id = project.id  #: Names it among others on the same computer.
        # Those that did nothing will not be missed.
        idle = "DELETE FROM session WHERE revision = 0 AND seen < ?"
        self._database.write(idle, time.time() - KEPT)

    def open(self, cookies: Sequence[str]) -> BrowserSession | None:
        """The session of the first cookie that has one; None where none has."""
        for cookie in cookies:
            key = key_of(cookie)
            row = self._database.row("SELECT csrf, seen FROM session WHERE key = ?", key)
            if row is None or not isinstance(row[0], str):
                continue
            if not isinstance(row[1], float) or not 0 <= time.time() - row[1] <= _SEEN:
                with suppress(SuraeError):  # another program holds the file: reading goes on
                    self._database.write(
                        "UPDATE session SET seen = ? WHERE key = ?", time.time(), key
                    )
            return BrowserSession(key, row[0])
        return None

    def make(self) -> tuple[BrowserSession, str]:
        """A new session, and the cookie that opens it, which is kept nowhere here."""
        session, cookie = BrowserSession.new()
        self._database.write(
            "INSERT INTO session VALUES (?, ?, ?, 0, ?)",
            session.key,
            session.csrf,
            json.dumps(empty_draft()),
            time.time(),
        )
        return session, cookie

    def draft(self, session: BrowserSession) -> Draft:
        """What the session is working on."""
        return self._read(session)[0]

    def state(self, session: BrowserSession) -> dict[str, Any]:
        """The draft, its revision, and what undo and redo would do."""
        draft, revision = self._read(session)
        steps = {"undo": self._next(session, done=True), "redo": self._next(session, done=False)}
        labels = {name: None if step is None else step.label for name, step in steps.items()}
        return {"revision": revision, **labels, "draft": shown(draft)}

    def change(
        self,
        session: BrowserSession,
        change: Mapping[str, Any],
        label: str,
        *,
        merge: bool = False,
    ) -> None:
        """Change the draft: a step that can be undone, or more of the last one (`merge`)."""
        with self._database.transaction():
            draft, now = self._read(session)
            after_change = changed(draft, change)
            keys = [key for key in after_change if after_change[key] != draft.get(key)]
            if not keys:
                return
            before = {key: draft[key] for key in keys}
            after = {key: after_change[key] for key in keys}
            last = self._next(session, done=True)
            if merge and last is not None and (last.label, last.kind) == (label, "draft"):
                before |= last.before
                after = {key: after_change[key] for key in before}
                self._database.write("DELETE FROM step WHERE id = ?", last.id)
            self._record(session, label, "draft", before, after)
            self._write(session, after_change, now + 1)
        self._tell(session, now + 1)

    def delete(self, session: BrowserSession, kind: str, id_: str, label: str) -> None:
        """Delete an entry, so that undo brings it back."""
        with self._changed(session) as draft:
            self._mark(session, kind, id_, deleted=True)
            reference = {"kind": kind, "id": id_}
            self._record(session, label, "deleted", reference, reference)
            if kind == "recording":
                draft["recordings"] = [other for other in draft["recordings"] if other != id_]

    def describe(
        self,
        session: BrowserSession,
        before: Mapping[str, Mapping[str, Any]],
        after: Mapping[str, Mapping[str, Any]],
        firsts: Mapping[str, Mapping[str, Any]],
        label: str,
    ) -> None:
        """Give recordings, by id, other descriptions, as one step that can be undone.

        It is refused where one has meanwhile been described by somebody else.
        """
        with self._changed(session):
            if not self._switch(before, after):
                raise RefusedError(
                    409, "somebody else has described it meanwhile; load the page again and repeat"
                )
            for id_, first in firsts.items():
                self._database.update("recording", id_, {"first": first})
            self._record(session, label, "described", {"rows": before}, {"rows": after})

    def next_version(self, id_: str) -> int:
        """A number that no other description of a recording has, whoever asks at the same time."""
        with self._database.transaction():
            row = self._database.get("recording", id_) or {}
            number = int(row.get("latest", 0)) + 1
            self._database.update("recording", id_, {"latest": number})
        return number

    def _switch(self, now: Mapping[str, Any], then: Mapping[str, Any]) -> bool:
        """Let recordings be as they are `then`, if all are as they are `now`; whether it did."""
        for id_, fields in now.items():
            row = self._database.get("recording", id_)
            if row is None or row.get("version", 0) != (fields.get("version") or 0):
                return False
        for id_, fields in then.items():
            version = fields.get("version") or 0
            self._database.update("recording", id_, {**fields, "version": version})
        return True

    def move(self, session: BrowserSession, *, back: bool) -> None:
        """Take the last step back, or do the one again that was taken back last."""
        with self._database.transaction():
            step = self._next(session, done=back)
            if step is None:
                raise RefusedError(409, f"there is nothing to {'undo' if back else 'redo'}")
            draft, now = self._read(session)
            here, there = (step.after, step.before) if back else (step.before, step.after)
            moved = True
            if step.kind == "draft":
                for key, value in there.items():
                    if key in draft and upgraded({key: value})[key] == value:
                        draft[key] = value
            elif step.kind == "described":
                moved = self._switch(here["rows"], there["rows"])
            else:
                moved = self._mark(session, there["kind"], there["id"], deleted=not back)
            if moved:
                query = "UPDATE step SET done = ? WHERE id = ?"
                self._database.write(query, not back, step.id)
                self._write(session, draft, now + 1)
            else:  # it is in the way of the steps before it
                self._database.write("DELETE FROM step WHERE id = ?", step.id)
        if not moved:
            raise RefusedError(
                409,
                "somebody else has deleted it, brought it back or described it meanwhile: it stays "
                "so, and this step is left out",
            )
        if step.kind != "draft":
            kind = "recording" if step.kind == "described" else there["kind"]
            self._events.changed(plural(kind))
        self._tell(session, now + 1)

    def _mark(self, session: BrowserSession, kind: str, id_: str, *, deleted: bool) -> bool:
        """Delete an entry again, or bring it back if this session deleted it; whether it did."""
        row = self._database.get(kind, id_, deleted=True)
        if row is None or (not deleted and row.get("deleted_by", session.key) != session.key):
            return False
        marked = self._database.mark(kind, id_, deleted=deleted)
        if marked and deleted:
            self._database.update(kind, id_, {"deleted_by": session.key})
        return marked

    def _record(
        self,
        session: BrowserSession,
        label: str,
        kind: str,
        before: Mapping[str, Any],
        after: Mapping[str, Any],
    ) -> None:
        """Add a step, drop those that were taken back, and the oldest."""
        key = session.key
        self._database.write("DELETE FROM step WHERE session = ? AND done = 0", key)
        self._database.write(
            "INSERT INTO step (session, done, label, kind, before, after) "
            "VALUES (?, 1, ?, ?, ?, ?)",
            key,
            label,
            kind,
            json.dumps(before),
            json.dumps(after),
        )
        self._database.write(
            "DELETE FROM step WHERE session = ? AND id <= "
            "(SELECT id FROM step WHERE session = ? ORDER BY id DESC LIMIT 1 OFFSET ?)",
            key,
            key,
            _STEPS,
        )

    def _next(self, session: BrowserSession, *, done: bool) -> _Step | None:
        """The step to take back (done) or to do again; damaged ones are passed over."""
        order = "DESC" if done else "ASC"
        for row in self._database.rows(
            "SELECT id, label, kind, before, after FROM step WHERE session = ? AND done = ? "
            f"ORDER BY id {order} LIMIT {_STEPS}",
            session.key,
            done,
        ):
            with suppress(ValueError, KeyError):
                state = _STATES[row[2]].validate_python
                return _Step(*row[:3], *(state(plain(text)) for text in row[3:]))
        return None

    @contextmanager
    def _changed(self, session: BrowserSession) -> Iterator[Draft]:
        """The draft, to be changed within; all of it is kept, and its browser told, or nothing."""
        with self._database.transaction():
            draft, revision = self._read(session)
            yield draft
            self._write(session, draft, revision + 1)
        self._tell(session, revision + 1)

    def _read(self, session: BrowserSession) -> tuple[Draft, int]:
        """The draft and its revision; keys of it that make no sense are as in a new one."""
        row = self._database.row("SELECT draft, revision FROM session WHERE key = ?", session.key)
        if row is None:
            raise RefusedError(403, "this session has ended; load the page again")
        saved: Any = None
        with suppress(ValueError):
            saved = plain(row[0])
        revision = row[1] if isinstance(row[1], int) and 0 <= row[1] < 2**53 else 0
        return upgraded(saved), revision

    def _write(self, session: BrowserSession, draft: Draft, revision: int) -> None:
        self._database.write(
            "UPDATE session SET draft = ?, revision = ? WHERE key = ?",
            json.dumps(draft, allow_nan=False),
            revision,
            session.key,
        )

    def _tell(self, session: BrowserSession, revision: int) -> None:
        self._events.tell(f"session:{session.key}", "draft", {"revision": revision})
