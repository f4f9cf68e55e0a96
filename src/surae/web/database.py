"""project.db: what a project knows, in SQLite (write-ahead), safe from a kill at any time.

Everything the users make is a *thing*: an id, a kind, and its content as JSON. Sessions and their
steps (undo) have tables of their own.
"""

import json
import secrets
import sqlite3
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from typing import Any

from surae.errors import ComputationError, InputError
from surae.files import shown
from surae.processes import NO_ROOM
from surae.studies.database import transaction
from surae.web.http_errors import RefusedError

#: "srwb" as a number: SQLite's mark of whose file it is.
_APPLICATION = 0x73727762
#: Of the tables; raised when an older surae could not read them.
VERSION = 1
#: Later than any time of deletion.
_EVER = 2**62

_TABLES = """
CREATE TABLE thing (
    id TEXT NOT NULL, kind TEXT NOT NULL, created REAL NOT NULL,
    deleted INTEGER NOT NULL,  -- when [s], 0 where it is not
    data TEXT NOT NULL, PRIMARY KEY (id, kind)
) WITHOUT ROWID;
CREATE INDEX thing_kind ON thing (kind, created);
CREATE TABLE session (
    key TEXT PRIMARY KEY, csrf TEXT NOT NULL, draft TEXT NOT NULL, revision INTEGER NOT NULL,
    seen REAL NOT NULL
) WITHOUT ROWID;
CREATE TABLE step (
    id INTEGER PRIMARY KEY AUTOINCREMENT, session TEXT NOT NULL, done INTEGER NOT NULL,
    label TEXT NOT NULL, kind TEXT NOT NULL, before TEXT NOT NULL, after TEXT NOT NULL
);
CREATE INDEX step_session ON step (session, id);
"""

Thing = dict[str, Any]


class Database:
    """The file, open; one connection that the server's threads share.

    Parameters
    ----------
    path : Path
        The file; made where it is missing.

    Raises
    ------
    InputError
        It is none of ours, or of a newer surae.
    ComputationError
        It cannot be read or written; of all methods too.
    """

    def __init__(self, path: Path) -> None:
        self._name, self._lock = shown(path), threading.RLock()
        with _told(self._name):
            self._file = sqlite3.connect(
                path, timeout=30.0, isolation_level=None, check_same_thread=False
            )
            try:
                self._prepare()
            except BaseException:
                self._file.close()
                raise

    def _prepare(self) -> None:
        """Recognise the file before anything of it is changed; make its tables where it is new."""
        (application,) = self._file.execute("PRAGMA application_id").fetchone()
        (version,) = self._file.execute("PRAGMA user_version").fetchone()
        (known,) = self._file.execute("SELECT count(*) FROM sqlite_master").fetchone()
        if known or application:
            if application != _APPLICATION:
                raise InputError(f"{self._name} is no surae project; give another folder")
            if version > VERSION:
                raise InputError(
                    f"{self._name} was written by a newer surae (layout {version}, this one knows "
                    f"{VERSION}); update surae to open this project"
                )
        self._file.execute("PRAGMA journal_mode = WAL")
        self._file.execute("PRAGMA synchronous = FULL")
        if not known:
            self._file.executescript(
                f"BEGIN; PRAGMA application_id = {_APPLICATION}; PRAGMA user_version = {VERSION};"
                f"{_TABLES} COMMIT;"
            )

    def close(self) -> None:
        """Let go of the file."""
        with self._lock, suppress(sqlite3.Error):
            self._file.close()

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """All of what is written within, or nothing; others wait."""
        with self._lock, _told(self._name):
            nested = self._file.in_transaction
            with nullcontext() if nested else transaction(self._file):
                yield

    def rows(self, query: str, *values: object) -> list[tuple[Any, ...]]:
        """All rows of a query."""
        with self._lock, _told(self._name):
            return self._file.execute(query, values).fetchall()

    def row(self, query: str, *values: object) -> tuple[Any, ...] | None:
        """Its first row; None where there is none."""
        with self._lock, _told(self._name):
            found: tuple[Any, ...] | None = self._file.execute(query, values).fetchone()
        return found

    def write(self, query: str, *values: object) -> int:
        """Change something; how many rows were."""
        with self._lock, _told(self._name):
            return self._file.execute(query, values).rowcount

    def add(self, kind: str, data: Mapping[str, Any], id_: str | None = None) -> str:
        """Keep a new thing; its id."""
        key = id_ or new_id()
        text = json.dumps(data, allow_nan=False)
        self.write("INSERT INTO thing VALUES (?, ?, ?, 0, ?)", key, kind, time.time(), text)
        return key

    def get(self, kind: str, id_: str, *, deleted: bool = False) -> Thing | None:
        """A thing with its `id` and `created`; None where there is none, or it was deleted."""
        found = self.row(
            "SELECT id, created, data FROM thing WHERE id = ? AND kind = ? AND deleted <= ?",
            id_, kind, _EVER if deleted else 0,
        )  # fmt: skip
        return None if found is None else _thing(found)

    def all(self, kind: str) -> list[Thing]:
        """All things of a kind that are not deleted, the oldest first."""
        found = self.rows(
            "SELECT id, created, data FROM thing WHERE kind = ? AND deleted = 0 "
            "ORDER BY created, id",
            kind,
        )
        return [_thing(row) for row in found]

    def update(self, kind: str, id_: str, changes: Mapping[str, Any]) -> Thing | None:
        """Change some of a thing's content; what it is now."""
        with self.transaction():
            thing = self.get(kind, id_, deleted=True)
            if thing is None:
                return None
            thing |= changes
            content = {k: v for k, v in thing.items() if k not in ("id", "created")}
            text = json.dumps(content, allow_nan=False)
            self.write("UPDATE thing SET data = ? WHERE id = ? AND kind = ?", text, id_, kind)
        return thing

    def mark(self, kind: str, id_: str, *, deleted: bool) -> bool:
        """Delete a thing, or bring it back; whether there is one."""
        when = int(time.time()) if deleted else 0
        found = self.write(
            "UPDATE thing SET deleted = ? WHERE id = ? AND kind = ?", when, id_, kind
        )
        return found > 0

    def active(self) -> list[Thing]:
        """Jobs that wait or are at work, the oldest first."""
        found = self.rows(
            "SELECT id, created, data FROM thing WHERE kind = 'job' AND deleted = 0 "
            "AND json_extract(data, '$.state') IN ('queued', 'running') ORDER BY created, id"
        )
        return [_thing(row) for row in found]


@contextmanager
def _told(name: str) -> Iterator[None]:
    """SQLite's errors in words, `name` being the file's."""
    try:
        yield
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if code == sqlite3.SQLITE_FULL:
            raise RefusedError(503, NO_ROOM) from error
        if code == sqlite3.SQLITE_NOTADB:
            raise InputError(f"{name} is no surae project; give another folder") from error
        advice = ""
        if code == sqlite3.SQLITE_CORRUPT:
            advice = "; recordings and fits beside it are whole, restore it from a copy"
        raise ComputationError(f"{name}: {error}{advice}") from error


def new_id() -> str:
    """An id that nobody guesses or has."""
    return secrets.token_hex(8)


def _thing(row: tuple[Any, ...]) -> Thing:
    return {**json.loads(row[2]), "id": row[0], "created": row[1]}
