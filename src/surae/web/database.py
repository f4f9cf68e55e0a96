"""project.db: what a project knows, in SQLite (write-ahead), safe from a kill at any time.

Everything the users make is a *thing*: an id, a kind, and its content as JSON. Sessions and their
steps (undo) have tables of their own. One connection writes, another reads, so that a program that
holds the file from outside keeps nobody from looking.
"""

import json
import secrets
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from surae.database import Format, make_tables, recognise, transaction
from surae.errors import ComputationError, InputError
from surae.files import shown
from surae.processes import NO_ROOM
from surae.web.http_errors import RefusedError
from surae.web.rows import KINDS, Thing, thing

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
FORMAT = Format(0x73727762, "a surae project", {1: _TABLES})
#: The state of a job whose row can be read.
_STATE = "CASE WHEN json_valid(data) THEN json_extract(data, '$.state') END"


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
        with sqlite_errors(self._name):
            self._file = connected(path)
            try:
                self._prepare()
                self._reader = connected(path)
                self._reader.execute("PRAGMA query_only = ON")
            except BaseException:
                self._file.close()
                raise

    def _prepare(self) -> None:
        """Recognise the file before anything of it is changed; make its tables where it is new."""
        known = recognised(self._file, self._name)
        self._file.execute("PRAGMA journal_mode = WAL")
        self._file.execute("PRAGMA synchronous = FULL")
        self._file.execute("PRAGMA fullfsync = ON")  # macOS: to the disk, not to its cache
        if not known:
            make_tables(self._file, FORMAT)

    def close(self) -> None:
        """Let go of the file."""
        for lock, file in ((self._reading, self._reader), (self._writing, self._file)):
            with lock, suppress(sqlite3.Error):
                file.close()

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """All of what is written within, or nothing; others wait."""
        with self._writing, sqlite_errors(self._name):
            if self._file.in_transaction:
                yield
                return
            with transaction(self._file):
                self._still_ours()
                self._writer.here = True
                try:
                    yield
                finally:
                    self._writer.here = False

    def rows(self, query: str, *values: object) -> list[tuple[Any, ...]]:
        """All rows of a query; within a transaction, as it sees them."""
        inside = getattr(self._writer, "here", False)
        with self._writing if inside else self._reading, sqlite_errors(self._name):
            file = self._file if inside else self._reader
            return file.execute(query, values).fetchall()

    def row(self, query: str, *values: object) -> tuple[Any, ...] | None:
        """Give the first row of an answer; None where there is none."""
        return next(iter(self.rows(query, *values)), None)

    def write(self, query: str, *values: object) -> int:
        """Change something; how many rows were."""
        with self.transaction():
            return self._file.execute(query, values).rowcount

    def add(self, kind: str, data: Mapping[str, Any], id_: str | None = None) -> str:
        """Keep a new thing; its id."""
        key = id_ or new_id()
        text = json.dumps(data, allow_nan=False)
        self.write("INSERT INTO thing VALUES (?, ?, ?, 0, ?)", key, kind, time.time(), text)
        return key

    def get(self, kind: str, id_: str, *, deleted: bool = False) -> Thing | None:
        """A thing with its `id` and `created`; None where there is none, or it was deleted.

        A damaged row is refused.
        """
        row = self.row(
            "SELECT id, created, data FROM thing WHERE id = ? AND kind = ? AND deleted <= ?",
            id_, kind, _EVER if deleted else 0,
        )  # fmt: skip
        try:
            return None if row is None else thing(kind, *row)
        except ValueError as error:
            raise RefusedError(
                409, f"this {kind} is damaged ({error}); `surae project repair` sets it aside"
            ) from None

    def all(self, kind: str) -> list[Thing]:
        """All things of a kind that are whole and not deleted, the oldest first."""
        return [whole for whole, _ in self._read(kind) if whole is not None]

    def damaged(self) -> list[dict[str, str]]:
        """Rows that are not as they should be: `kind`, `id`, and the `problem`."""
        return [problem for kind in KINDS for _, problem in self._read(kind) if problem]

    def _read(self, kind: str, which: str = "1") -> Iterator[tuple[Thing | None, dict[str, str]]]:
        """Things of a kind; for each that is damaged None, and what is wrong with it."""
        for row in self.rows(
            f"SELECT id, created, data FROM thing WHERE kind = ? AND deleted = 0 AND {which} "
            "ORDER BY created, id",
            kind,
        ):
            try:
                yield thing(kind, *row), {}
            except ValueError as error:
                yield None, {"kind": kind, "id": shown(str(row[0])[:40]), "problem": str(error)}

    def update(self, kind: str, id_: str, changes: Mapping[str, Any]) -> Thing | None:
        """Change some of a thing's content; what it is now."""
        with self.transaction():
            changed = self.get(kind, id_, deleted=True)
            if changed is None:
                return None
            changed |= changes
            content = {k: v for k, v in changed.items() if k not in ("id", "created")}
            text = json.dumps(content, allow_nan=False)
            self.write("UPDATE thing SET data = ? WHERE id = ? AND kind = ?", text, id_, kind)
        return changed

    def mark(self, kind: str, id_: str, *, deleted: bool) -> bool:
        """Delete a thing, or bring it back; whether that changed it."""
        return self.write(
            "UPDATE thing SET deleted = ? WHERE id = ? AND kind = ? AND (deleted > 0) = ?",
            int(time.time()) if deleted else 0, id_, kind, not deleted,
        ) > 0  # fmt: skip

    def active(self) -> list[Thing]:
        """Jobs that wait or are at work, the oldest first."""
        read = self._read("job", f"{_STATE} IN ('queued', 'running')")
        return [job for job, _ in read if job is not None]

    def forget_jobs(self, most: int) -> None:
        """Remove the oldest of the jobs that are finished."""
        self.write(
            "DELETE FROM thing WHERE kind = 'job' AND id IN (SELECT id FROM thing WHERE "
            f"kind = 'job' AND {_STATE} NOT IN ('queued', 'running') "
            "ORDER BY created DESC LIMIT -1 OFFSET ?)",
            most,
        )


def connected(path: Path, mode: str = "rw") -> sqlite3.Connection:
    """A connection that trusts nothing in the file: no function runs because its schema says so."""
    file = sqlite3.connect(
        f"{path.absolute().as_uri()}?mode={mode}",
        uri=True,
        timeout=_PATIENCE,
        isolation_level=None,
        check_same_thread=False,
    )
    file.execute("PRAGMA trusted_schema = OFF")
    file.execute("PRAGMA cell_size_check = ON")
    defensive = getattr(sqlite3, "SQLITE_DBCONFIG_DEFENSIVE", None)
    if defensive is not None:  # from Python 3.12
        file.setconfig(defensive, True)  # type: ignore[attr-defined,unused-ignore]
    return file


def recognised(file: sqlite3.Connection, name: str) -> bool:
    """Whether a file has content, which is a project's, whole, and nothing else.

    Somebody else's file, a newer surae's, and one that holds what we did not put there, is refused.
    """
    (application,) = file.execute("PRAGMA application_id").fetchone()
    (known,) = file.execute("SELECT count(*) FROM sqlite_master").fetchone()
    if not known and not application:
        return False
    recognise(file, name, FORMAT)
    (verdict,) = file.execute("PRAGMA quick_check(1)").fetchone()
    if verdict != "ok":
        raise ComputationError(f"{name} is damaged: {' '.join(str(verdict).split())}{_ADVICE}")
    return True


_ADVICE = "; recordings and fits beside it are whole: `surae project repair`, or restore a backup"


@contextmanager
def sqlite_errors(name: str) -> Iterator[None]:
    """SQLite's errors in words, `name` being the file's."""
    try:
        yield
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if code == sqlite3.SQLITE_FULL:
            raise RefusedError(503, NO_ROOM) from error
        if code == sqlite3.SQLITE_NOTADB:
            raise InputError(f"{name} is no surae project; give another folder") from error
        if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            raise RefusedError(
                503, f"another program holds {name}; close it there and try again: nothing is lost"
            ) from error
        advice = _ADVICE if code == sqlite3.SQLITE_CORRUPT else ""
        raise ComputationError(f"{name}: {error}{advice}") from error


def new_id() -> str:
    """An id that nobody guesses or has."""
    return secrets.token_hex(8)
