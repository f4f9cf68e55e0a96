"""project.db: what a project knows, in SQLite (write-ahead), safe from a kill at any time.

Everything the users make is an *entry*: an id, a kind, and its content as JSON. All of them are
kept in memory, and read again where they are written: nobody else writes. Sessions and their steps
(undo) have tables of their own. One connection writes, another reads, so that a program that holds
the file from outside keeps nobody from looking.
"""

import secrets
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surae.base.database import (
    Format,
    damage,
    open_in_memory,
    open_to_read,
    open_to_write,
    sqlite_errors,
    transaction,
)
from surae.base.errors import ComputationError
from surae.base.files import shown
from surae.processes import NO_ROOM
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.rows import KINDS, Entry, entry, sealed

#: Jobs that wait or are at work.
ACTIVE = ("queued", "running")
#: Finished jobs that are remembered; results are kept whether or not their job is.
_JOBS = 500
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
    full="{name}: " + NO_ROOM.replace("the disk", "the disk that it is on"),
    damaged="recordings and fits beside it are whole; restore a backup",
)
_COLUMNS = "SELECT id, kind, created, deleted, data FROM thing"


@dataclass(frozen=True, slots=True)
class _Kept:
    """A row: its entry, or what is wrong with it."""

    deleted: bool
    entry: Entry | None
    problem: str


class Database:
    """The file, made where it is missing, open for all of the server's threads.

    `still_ours` raises where nothing may be written any more: somebody else has taken the project.
    Where nothing can be kept, which `unkept` says, the file is read, browsers' sessions are in
    memory, and whoever changes an entry is told.
    A file that is none of ours, of a newer surae, or that holds more than our tables is an
    InputError; one that cannot be read or written, now or later, a ComputationError.
    """

    def __init__(
        self, path: Path, still_ours: Callable[[], None] = lambda: None, unkept: str = ""
    ) -> None:
        self._name = path.name
        self.unkept = unkept
        self._still_ours = still_ours
        self._writing = threading.RLock()
        self._reading: threading.Lock | threading.RLock = threading.Lock()
        self._writer: int | None = None  # the thread that is in a transaction
        self._touched: set[tuple[str, object]] = set()  # kind and id of what it has changed
        self._kept: dict[str, dict[object, _Kept]] = {}  # by kind and id, the oldest first
        if unkept:
            with sqlite_errors(self._name, FORMAT):
                self._file = self._reader = open_in_memory(path, self._name, FORMAT)
            self._reading = self._writing  # there is one connection
        else:
            self._open(path)
        project = self.row("SELECT id FROM thing WHERE kind = 'project'")
        self._project = "" if project is None else str(project[0])
        for row in self.rows(f"{_COLUMNS} ORDER BY created, id"):
            self._keep(*row)

    def _open(self, path: Path) -> None:
        """Open the file to write, and a second time to read."""
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
            if self._writer is not None:
                yield
                return
            try:
                with transaction(self._file):
                    self._still_ours()
                    self._writer = threading.get_ident()
                    yield
            except BaseException:
                for kind, id_ in self._touched:
                    self._keep_again(kind, id_)
                raise
            finally:
                self._writer = None
                self._touched.clear()

    def rows(self, query: str, *values: object) -> list[tuple[Any, ...]]:
        """All rows of a query; within a transaction, as it sees them."""
        inside = self._writer == threading.get_ident()
        file, lock = (self._file, self._writing) if inside else (self._reader, self._reading)
        with lock, sqlite_errors(self._name, FORMAT):
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
        if self.unkept:
            raise RefusedError(503, self.unkept)
        with self.transaction():
            count = self.write(query, *values)
            self._touched.add((kind, id_))
            self._keep_again(kind, id_)
        return count

    def add(self, kind: str, data: Mapping[str, Any], id_: str | None = None) -> str:
        """Keep a new entry; its id."""
        key = id_ or new_id()
        if kind == "project":
            self._project = key
        now = time.time()
        text = sealed(self._project, kind, key, now, dict(data))
        self.change(kind, key, "INSERT INTO thing VALUES (?, ?, ?, 0, ?)", key, kind, now, text)
        return key

    def get(self, kind: str, id_: str, *, deleted: bool = False) -> Entry | None:
        """An entry with its `id` and `created`; None where there is none, or it was deleted.

        A damaged one is refused.
        """
        kept = self._kept.get(kind, {}).get(id_)
        if kept is None or (kept.deleted and not deleted):
            return None
        if kept.problem:
            raise RefusedError(
                409, f"this {kind} is damaged ({kept.problem}); a backup may have it whole"
            )
        return kept.entry

    def all(self, kind: str) -> list[Entry]:
        """All entries of a kind that are whole and not deleted, the oldest first.

        They are kept: whoever gets them does not change them.
        """
        kept = list(self._kept.get(kind, {}).values())
        return [each.entry for each in kept if each.entry is not None and not each.deleted]

    def damaged(self) -> list[dict[str, str]]:
        """Rows that are not as they should be: `kind`, `id`, and the `problem`."""
        return [
            {"kind": kind, "id": shown(str(id_)[:40]), "problem": kept.problem}
            for kind in KINDS
            for id_, kept in list(self._kept.get(kind, {}).items())
            if kept.problem and not kept.deleted
        ]

    def update(self, kind: str, id_: str, changes: Mapping[str, Any]) -> Entry | None:
        """Change some of an entry's content; what it is now."""
        with self.transaction():
            before = self.get(kind, id_, deleted=True)
            if before is None:
                return None
            content = {k: v for k, v in before.items() if k not in ("id", "created")}
            created = before["created"]
            text = sealed(self._project, kind, id_, created, {**content, **changes})
            query = "UPDATE thing SET data = ? WHERE id = ? AND kind = ?"
            self.change(kind, id_, query, text, id_, kind)
            return self.get(kind, id_, deleted=True)

    def mark(self, kind: str, id_: str, *, deleted: bool) -> bool:
        """Delete an entry, or bring it back; whether that changed it."""
        query = "UPDATE thing SET deleted = ? WHERE id = ? AND kind = ? AND (deleted > 0) = ?"
        now = int(time.time()) if deleted else 0
        return self.change(kind, id_, query, now, id_, kind, not deleted) > 0

    def active(self) -> list[Entry]:
        """Jobs that wait or are at work, the oldest first."""
        return [job for job in self.all("job") if job["state"] in ACTIVE]

    def forget_jobs(self) -> None:
        """Remove the oldest of the jobs that are finished."""
        with self.transaction():
            finished = [job["id"] for job in self.all("job") if job["state"] not in ACTIVE]
            for id_ in finished[: max(len(finished) - _JOBS, 0)]:
                self.remove("job", id_)

    def remove(self, kind: str, id_: object) -> None:
        """Remove the row of an entry."""
        self.change(kind, id_, "DELETE FROM thing WHERE kind = ? AND id = ?", kind, id_)

    def _keep(self, id_: object, kind: str, created: object, deleted: int, text: object) -> None:
        whole = None
        problem = ""
        try:
            whole = entry(kind, id_, created, text, self._project)
        except ValueError as error:
            problem = str(error)
        self._kept.setdefault(kind, {})[id_] = _Kept(deleted != 0, whole, problem)

    def _keep_again(self, kind: str, id_: object) -> None:
        """Read a row that was written, or whose change was taken back."""
        row = self._file.execute(f"{_COLUMNS} WHERE id = ? AND kind = ?", (id_, kind)).fetchone()
        if row is None:
            self._kept.get(kind, {}).pop(id_, None)
        else:
            self._keep(*row)


def refuse_damage(file: sqlite3.Connection, name: str) -> None:
    """Refuse a file whose tables SQLite finds damaged."""
    for line in damage(file, quick=True):
        raise ComputationError(f"{name} is damaged: {line}; {FORMAT.damaged}")


def new_id() -> str:
    """An id that nobody guesses or has."""
    return secrets.token_hex(8)
