"""project.db: what a project knows, in SQLite (write-ahead), safe from a kill at any time.

Everything the users make is an *entry*: an id, a kind, and its content as JSON. Sessions and their
steps (undo) have tables of their own. One connection writes, another reads, so that a program that
holds the file from outside keeps nobody from looking. Entries that are listed are kept in memory,
and read again where they were written: nobody else writes.
"""

import json
import math
import secrets
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path
from typing import Any

from surae.database import Format, damage, open_to_read, open_to_write, sqlite_errors, transaction
from surae.errors import ComputationError
from surae.files import shown
from surae.processes import NO_ROOM
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.rows import KINDS, Entry, entry

#: Jobs that wait or are at work.
ACTIVE = ("queued", "running")
#: Later than any time of deletion.
_EVER = 2**62
#: How long to wait for a program that holds the file [s].
_PATIENCE = 2.0

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

#: The file of a project; "srwb" as a number is SQLite's mark of it.
FORMAT = Format(
    application=0x73727762,
    version=1,
    what="a surae project",
    tables=_TABLES,
    full=NO_ROOM,
    damaged="recordings and fits beside it are whole; restore a backup",
)
#: A row as it is kept: when it was made, its entry, and what is wrong with one that is damaged.
_Kept = tuple[Any, Entry | None, dict[str, str]]


class Database:
    """The file, open, for all of the server's threads.

    Parameters
    ----------
    path : Path
        The file; made where it is missing.
    still_ours : callable
        Raises where nothing may be written any more: somebody else has taken the project.

    Raises
    ------
    InputError
        It is none of ours, of a newer surae, or holds more than our tables.
    ComputationError
        It cannot be read or written; of all methods too.
    """

    def __init__(self, path: Path, still_ours: Callable[[], None] = lambda: None) -> None:
        self._name, self._still_ours = shown(path), still_ours
        self._writing, self._reading = threading.RLock(), threading.Lock()
        self._writer = threading.local()
        self._keeping = threading.Lock()
        #: Things by kind and id; those that have been written since; those of this transaction.
        self._kept: dict[str, dict[object, _Kept]] = {}
        self._stale: dict[str, set[object]] = {}
        self._touched: dict[str, set[object]] = {}
        with sqlite_errors(self._name, FORMAT):
            self._file = open_to_write(path, self._name, FORMAT, _PATIENCE)
            try:
                refuse_damage(self._file, self._name)
                self._reader = open_to_read(path, self._name, FORMAT, _PATIENCE)
            except BaseException:
                self._file.close()
                raise

    def close(self) -> None:
        """Let go of the file."""
        for lock, file in ((self._reading, self._reader), (self._writing, self._file)):
            with lock, suppress(sqlite3.Error):
                file.close()

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """All of what is written within, or nothing; others wait."""
        with self._writing, sqlite_errors(self._name, FORMAT):
            if self._file.in_transaction:
                yield
                return
            try:
                with transaction(self._file):
                    self._still_ours()
                    self._writer.here = True
                    yield
            finally:
                self._writer.here = False
                with self._keeping:
                    for kind, ids in self._touched.items():
                        self._stale.setdefault(kind, set()).update(ids)
                self._touched = {}

    def rows(self, query: str, *values: object) -> list[tuple[Any, ...]]:
        """All rows of a query; within a transaction, as it sees them."""
        inside = getattr(self._writer, "here", False)
        with self._writing if inside else self._reading, sqlite_errors(self._name, FORMAT):
            file = self._file if inside else self._reader
            return file.execute(query, values).fetchall()

    def row(self, query: str, *values: object) -> tuple[Any, ...] | None:
        """Give the first row of an answer; None where there is none."""
        return next(iter(self.rows(query, *values)), None)

    def write(self, query: str, *values: object) -> int:
        """Change something but entries; how many rows were."""
        with self.transaction():
            return self._file.execute(query, values).rowcount

    def change(self, kind: str, id_: object, query: str, *values: object) -> int:
        """Change the row of an entry; how many were."""
        with self.transaction():
            self._touched.setdefault(kind, set()).add(id_)
            return self._file.execute(query, values).rowcount

    def add(self, kind: str, data: Mapping[str, Any], id_: str | None = None) -> str:
        """Keep a new entry; its id."""
        key = id_ or new_id()
        row = (key, kind, time.time(), json.dumps(data, allow_nan=False))
        self.change(kind, key, "INSERT INTO thing VALUES (?, ?, ?, 0, ?)", *row)
        return key

    def get(self, kind: str, id_: str, *, deleted: bool = False) -> Entry | None:
        """An entry with its `id` and `created`; None where there is none, or it was deleted.

        A damaged row is refused.
        """
        row = self.row(
            "SELECT id, created, data FROM thing WHERE id = ? AND kind = ? AND deleted <= ?",
            id_, kind, _EVER if deleted else 0,
        )  # fmt: skip
        try:
            return None if row is None else entry(kind, *row)
        except ValueError as error:
            raise RefusedError(
                409, f"this {kind} is damaged ({error}); a backup may have it whole"
            ) from None

    def all(self, kind: str) -> list[Entry]:
        """All entries of a kind that are whole and not deleted, the oldest first.

        They are kept: whoever gets them does not change them.
        """
        return [whole for _, whole, _ in self._read(kind).values() if whole is not None]

    def damaged(self) -> list[dict[str, str]]:
        """Rows that are not as they should be: `kind`, `id`, and the `problem`."""
        return [problem for kind in KINDS for *_, problem in self._read(kind).values() if problem]

    def _read(self, kind: str) -> dict[object, _Kept]:
        """Things of a kind by id, the oldest first; within a transaction, as it sees them."""
        with self._keeping:
            stale, kept = self._stale.pop(kind, set()), self._kept.pop(kind, None)
            if kept is None or stale:
                ids = None if kept is None else stale
                fetched = self._fetched(self._reader, self._reading, kind, ids)
                kept = _renewed(kept or {}, fetched)
            self._kept[kind] = kept
        if getattr(self._writer, "here", False) and (touched := self._touched.get(kind)):
            return _renewed(kept, self._fetched(self._file, self._writing, kind, touched))
        return kept

    def _fetched(
        self,
        file: sqlite3.Connection,
        lock: AbstractContextManager[object],
        kind: str,
        ids: set[object] | None,
    ) -> dict[object, _Kept | None]:
        """Things of a kind, of these ids or all; None where there is none of an id."""
        query = "SELECT id, created, data FROM thing WHERE kind = ? AND deleted = 0"
        fetched: dict[object, _Kept | None] = dict.fromkeys(ids or ())
        with lock, sqlite_errors(self._name, FORMAT):
            if ids is None:
                rows = file.execute(query, (kind,)).fetchall()
            else:
                one = f"{query} AND id = ?"
                rows = [row for id_ in ids for row in file.execute(one, (kind, id_))]
        for row in rows:
            try:
                fetched[row[0]] = (row[1], entry(kind, *row), {})
            except ValueError as error:
                told_of = {"kind": kind, "id": shown(str(row[0])[:40]), "problem": str(error)}
                fetched[row[0]] = (row[1], None, told_of)
        return fetched

    def update(self, kind: str, id_: str, changes: Mapping[str, Any]) -> Entry | None:
        """Change some of an entry's content; what it is now."""
        with self.transaction():
            changed = self.get(kind, id_, deleted=True)
            if changed is None:
                return None
            changed |= changes
            content = {k: v for k, v in changed.items() if k not in ("id", "created")}
            text = json.dumps(content, allow_nan=False)
            query = "UPDATE thing SET data = ? WHERE id = ? AND kind = ?"
            self.change(kind, id_, query, text, id_, kind)
        return changed

    def mark(self, kind: str, id_: str, *, deleted: bool) -> bool:
        """Delete an entry, or bring it back; whether that changed it."""
        query = "UPDATE thing SET deleted = ? WHERE id = ? AND kind = ? AND (deleted > 0) = ?"
        now = int(time.time()) if deleted else 0
        return self.change(kind, id_, query, now, id_, kind, not deleted) > 0

    def active(self) -> list[Entry]:
        """Jobs that wait or are at work, the oldest first."""
        return [job for job in self.all("job") if job["state"] in ACTIVE]

    def forget_jobs(self, most: int) -> None:
        """Remove the oldest of the jobs that are finished."""
        with self.transaction():
            finished = [job["id"] for job in self.all("job") if job["state"] not in ACTIVE]
            for id_ in finished[: max(len(finished) - most, 0)]:
                self.remove("job", id_)

    def remove(self, kind: str, id_: object) -> None:
        """Remove the row of an entry."""
        self.change(kind, id_, "DELETE FROM thing WHERE kind = ? AND id = ?", kind, id_)


def _renewed(
    kept: Mapping[object, _Kept], fetched: Mapping[object, _Kept | None]
) -> dict[object, _Kept]:
    """What is kept, with some of it as it is now, the oldest first."""
    now = {**kept, **fetched}
    rows = [(id_, row) for id_, row in now.items() if row is not None]
    return dict(sorted(rows, key=lambda pair: (_time(pair[1][0]), str(pair[0]))))


def _time(created: object) -> float:
    return created if isinstance(created, float) else math.inf


def refuse_damage(file: sqlite3.Connection, name: str) -> None:
    """Refuse a file whose tables SQLite finds damaged."""
    for line in damage(file, quick=True):
        raise ComputationError(f"{name} is damaged: {line}; {FORMAT.damaged}")


def new_id() -> str:
    """An id that nobody guesses or has."""
    return secrets.token_hex(8)
