"""Browsers kept apart: each has its own draft, uploads and history, found by a secret cookie."""

import json
import secrets
import time
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from typing import Any

from surae.web.draft import Draft, changed, empty_draft
from surae.web.events import Events
from surae.web.http_errors import RefusedError
from surae.web.project import Project

#: Steps that can be undone.
_STEPS = 200
#: Sessions that did nothing are forgotten after a day, others when unseen for a year [s].
_IDLE, _UNSEEN = 86_400.0, 365 * 86_400.0
#: `seen` is written no more often than this [s].
_SEEN = 600.0


@dataclass(frozen=True, slots=True)
class Session:
    """One browser: `key`, which names it on disk but opens nothing, and its CSRF token."""

    key: str
    csrf: str


class Sessions:
    """All sessions of a project."""

    def __init__(self, project: Project, events: Events) -> None:
        self._project, self._database, self._events = project, project.database, events
        #: Names the project among others on the same computer; takes its place out of messages.
        self.project_id, self.hidden = project.id, project.hidden
        self._forget()

    def open(self, cookie: str | None) -> Session | None:
        """The session of a cookie; None where there is none."""
        if not cookie or len(cookie) > 200:
            return None
        key = sha256(cookie.encode()).hexdigest()
        found = self._database.row("SELECT csrf, seen FROM session WHERE key = ?", key)
        if found is None:
            return None
        if time.time() - found[1] > _SEEN:
            self._database.write("UPDATE session SET seen = ? WHERE key = ?", time.time(), key)
        return Session(key, found[0])

    def make(self) -> tuple[Session, str]:
        """A new session, and the cookie that opens it, which is kept nowhere here."""
        cookie = secrets.token_urlsafe(32)
        made = Session(sha256(cookie.encode()).hexdigest(), secrets.token_urlsafe(32))
        self._database.write(
            "INSERT INTO session VALUES (?, ?, ?, 0, ?)",
            made.key, made.csrf, json.dumps(empty_draft()), time.time(),
        )  # fmt: skip
        return made, cookie

    def draft(self, session: Session) -> Draft:
        """What the session is working on."""
        return self._read(session)[0]

    def state(self, session: Session) -> dict[str, Any]:
        """The draft, its revision, and what undo and redo would do."""
        with self._database.transaction():
            draft, revision = self._read(session)
            undo, redo = self._next(session, done=1), self._next(session, done=0)
        return {
            "revision": revision,
            "undo": None if undo is None else undo[1],
            "redo": None if redo is None else redo[1],
            "draft": draft,
        }

    def change(
        self,
        session: Session,
        change: Mapping[str, Any],
        label: str,
        *,
        revision: int | None = None,
        merge: bool = False,
    ) -> None:
        """Change the draft, as one step that can be undone.

        Raises
        ------
        RefusedError
            Somebody else, another tab, has changed it since `revision`.
        """
        with self._database.transaction():
            draft, now = self._read(session)
            if revision is not None and revision != now:
                raise RefusedError(
                    409, "another tab has changed this work meanwhile; load it again and repeat"
                )
            made = changed(draft, change)
            keys = [key for key in made if made[key] != draft.get(key)]
            if not keys:
                return
            before = {key: draft[key] for key in keys}
            after = {key: made[key] for key in keys}
            last = self._next(session, done=1)
            if merge and last is not None and last[1] == label and last[2] == "draft":
                before |= json.loads(last[3])
                after = {key: made[key] for key in before}
                self._database.write("DELETE FROM step WHERE id = ?", last[0])
            self._record(session, label, "draft", before, after)
            self._write(session, made, now + 1)
        self._tell(session, now + 1)

    def deleted(self, session: Session, kind: str, id_: str, label: str) -> None:
        """Note that the session deleted a thing, so that undo brings it back."""
        with self._database.transaction():
            told = {"kind": kind, "id": id_}
            self._record(session, label, "deleted", told, told)
            draft, now = self._read(session)
            if kind == "recording" and id_ in draft["recordings"]:
                draft["recordings"] = [one for one in draft["recordings"] if one != id_]
            self._write(session, draft, now + 1)
        self._tell(session, now + 1)

    def undo(self, session: Session) -> None:
        """Take the last step back."""
        self._move(session, back=True)

    def redo(self, session: Session) -> None:
        """Do the step again that was taken back last."""
        self._move(session, back=False)

    def _move(self, session: Session, *, back: bool) -> None:
        with self._database.transaction():
            step = self._next(session, done=int(back))
            if step is None:
                raise RefusedError(409, f"there is nothing to {'undo' if back else 'redo'}")
            id_, _, kind, before, after = step
            draft, now = self._read(session)
            told = json.loads(before if back else after)
            if kind == "draft":
                draft |= told
            else:
                self._database.mark(told["kind"], told["id"], deleted=not back)
            self._database.write("UPDATE step SET done = ? WHERE id = ?", int(not back), id_)
            self._write(session, draft, now + 1)
        if kind == "deleted":
            self._events.tell("project", "changed", {"what": f"{told['kind']}s"})
        self._tell(session, now + 1)

    def _record(
        self,
        session: Session,
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
            key, label, kind, json.dumps(before), json.dumps(after),
        )  # fmt: skip
        self._database.write(
            "DELETE FROM step WHERE session = ? AND id <= "
            "(SELECT id FROM step WHERE session = ? ORDER BY id DESC LIMIT 1 OFFSET ?)",
            key, key, _STEPS,
        )  # fmt: skip

    def _next(self, session: Session, *, done: int) -> tuple[int, str, str, str, str] | None:
        """The step to take back (done) or to do again."""
        order = "DESC" if done else "ASC"
        found = self._database.row(
            "SELECT id, label, kind, before, after FROM step WHERE session = ? AND done = ? "
            f"ORDER BY id {order} LIMIT 1",
            session.key, done,
        )  # fmt: skip
        return None if found is None else (found[0], found[1], found[2], found[3], found[4])

    def _read(self, session: Session) -> tuple[Draft, int]:
        found = self._database.row("SELECT draft, revision FROM session WHERE key = ?", session.key)
        if found is None:
            raise RefusedError(403, "this session has ended; load the page again")
        return {**empty_draft(), **json.loads(found[0])}, found[1]

    def _write(self, session: Session, draft: Draft, revision: int) -> None:
        self._database.write(
            "UPDATE session SET draft = ?, revision = ? WHERE key = ?",
            json.dumps(draft, allow_nan=False), revision, session.key,
        )  # fmt: skip

    def _tell(self, session: Session, revision: int) -> None:
        self._events.tell(f"session:{session.key}", "draft", {"revision": revision})

    def _forget(self) -> None:
        """Remove sessions that nobody will miss, and what they had uploaded."""
        now = time.time()
        old = self._database.rows(
            "SELECT key FROM session WHERE seen < ? OR (revision = 0 AND seen < ?)",
            now - _UNSEEN, now - _IDLE,
        )  # fmt: skip
        for (key,) in old:
            self._project.drop_uploads(key)
            with self._database.transaction():
                self._database.write("DELETE FROM step WHERE session = ?", key)
                self._database.write("DELETE FROM session WHERE key = ?", key)
                for upload in self._database.all("upload"):
                    if upload["session"] == key:
                        self._database.write("DELETE FROM thing WHERE id = ?", upload["id"])
