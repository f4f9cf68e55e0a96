"""A SQLite file of ours: opened, recognised, copied, locked.

A file may be a stranger's: links, tables and programs in it that are not ours are refused.
"""

import shutil
import sqlite3
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from surae.base.errors import ComputationError, InputError

#: Beside a file, these are SQLite's and ours.
BESIDE = ("-wal", "-shm", "-journal", ".lock")
#: How long somebody may look at a lock, which keeps it from being taken [s].
_LOOKED_AT = 1.0
#: How long to wait for another program that writes [s].
_PATIENCE = 30.0
_NOT_OURS = "{name} is not {what}; give another, or restore a backup"


@dataclass(frozen=True, slots=True, kw_only=True)
class Format:
    """A kind of file."""

    application: int  #: SQLite's mark of whose file it is.
    what: str  #: What messages call it.
    tables: str  #: The statements that make its tables.
    version: int  #: Of the tables; a file of another is refused.
    #: What to do where there is no room ({name} is the file's), or the file is damaged.
    full: str
    damaged: str


class UnavailableError(ComputationError):
    """The file cannot be used now; the same may well work a little later."""


@contextmanager
def sqlite_errors(name: str, kind: Format) -> Iterator[None]:
    """SQLite's errors in words, `name` being the file's.

    A file that is no database is an InputError, one that is full or held by another program an
    UnavailableError, else one that cannot be read or written a ComputationError.
    """
    try:
        yield
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if code == sqlite3.SQLITE_NOTADB:
            raise InputError(_NOT_OURS.format(name=name, what=kind.what)) from error
        if code == sqlite3.SQLITE_FULL:
            raise UnavailableError(kind.full.format(name=name)) from error
        if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            raise UnavailableError(
                f"another program holds {name}; close it there and try again: nothing is lost"
            ) from error
        advice = {
            sqlite3.SQLITE_IOERR: kind.full.removeprefix("{name}: "),
            sqlite3.SQLITE_CORRUPT: kind.damaged,
        }.get(code)
        raise ComputationError(f"{name}: {error}" + (f"; {advice}" if advice else "")) from error


def lock(path: Path) -> sqlite3.Connection | None:
    """The lock of the one who writes, held until closed or the process ends; None if taken."""
    refuse_links(path)
    # SQLite's own lock on an empty file: the system lets go of it, whatever ends the process
    held = sqlite3.connect(
        _lock_of(path), timeout=_LOOKED_AT, isolation_level=None, check_same_thread=False
    )
    try:
        held.execute("BEGIN EXCLUSIVE")
    except sqlite3.OperationalError as error:
        held.close()
        if error.sqlite_errorcode != sqlite3.SQLITE_BUSY:
            raise
        return None
    return held


def is_locked(path: Path) -> bool:
    """Whether somebody is writing to it."""
    if not _lock_of(path).exists():
        return False
    look = sqlite3.connect(f"{_lock_of(path).as_uri()}?mode=ro", uri=True, timeout=0.0)
    try:
        look.execute("SELECT 1 FROM sqlite_master").fetchall()
    except sqlite3.OperationalError as error:
        return error.sqlite_errorcode == sqlite3.SQLITE_BUSY
    finally:
        look.close()
    return False


def refuse_links(path: Path) -> None:
    """Refuse a file that would be written somewhere else than where it lies."""
    for beside in (path, *(path.with_name(path.name + end) for end in BESIDE)):
        if beside.is_symlink():
            raise InputError(f"{beside.name} is a link; put the file itself there")


def open_to_write(
    path: Path, name: str, kind: Format, patience: float = _PATIENCE
) -> sqlite3.Connection:
    """The file, made where it is missing; the caller has its lock."""
    file = connected(path, "rwc", patience)
    try:
        # Looked at before anything of a file that may not be ours is changed.
        (application,) = file.execute("PRAGMA application_id").fetchone()
        (known,) = file.execute("SELECT count(*) FROM sqlite_master").fetchone()
        if known or application:
            _recognise(file, name, kind)
        file.execute("PRAGMA journal_mode = WAL")
        file.execute("PRAGMA synchronous = FULL")  # what is there outlives a power cut too
        file.execute("PRAGMA fullfsync = ON")  # on macOS too
        if not (known or application):
            file.executescript(
                f"BEGIN; PRAGMA application_id = {kind.application}; "
                f"PRAGMA user_version = {kind.version};{kind.tables} COMMIT;"
            )
    except BaseException:
        file.close()
        raise
    return file


def open_to_read(
    path: Path, name: str, kind: Format, patience: float = _PATIENCE
) -> sqlite3.Connection:
    """The file, also while another process writes, and on a medium that is read-only."""
    refuse_links(path)
    try:
        return _reading(connected(path, "rw", patience), name, kind)
    except sqlite3.OperationalError as error:
        blocked = (
            sqlite3.SQLITE_CANTOPEN,
            sqlite3.SQLITE_READONLY,
            sqlite3.SQLITE_FULL,
            sqlite3.SQLITE_IOERR,
        )
        if error.sqlite_errorcode & 0xFF not in blocked:
            raise
    log = path.with_name(f"{path.name}-wal")
    if log.exists() and log.stat().st_size:
        return open_in_memory(path, name, kind)
    return _reading(connected(path, "ro&immutable=1", patience), name, kind)


def open_in_memory(path: Path, name: str, kind: Format) -> sqlite3.Connection:
    """What the file holds, in memory: where nothing can be written beside it.

    What was written last may still lie in the log beside it, which is read in a copy elsewhere.
    """
    refuse_links(path)
    with tempfile.TemporaryDirectory(prefix="surae-project-") as folder:
        place = Path(folder) / path.name
        mode = "rw"
        try:
            for each in (path, path.with_name(f"{path.name}-wal")):
                if each.exists():
                    shutil.copyfile(each, Path(folder) / each.name)
        except OSError:  # there is no room elsewhere either: what is in the file itself is read
            place = path
            mode = "ro&immutable=1"
        with closing(_reading(connected(place, mode), name, kind)) as file:
            memory = sqlite3.connect(":memory:", isolation_level=None, check_same_thread=False)
            memory.execute("PRAGMA trusted_schema = OFF")
            file.backup(memory)
    return memory


def _reading(file: sqlite3.Connection, name: str, kind: Format) -> sqlite3.Connection:
    """A connection that only reads, to a file of this kind."""
    try:
        file.execute("PRAGMA query_only = ON")
        _recognise(file, name, kind)
    except BaseException:
        file.close()
        raise
    return file


def copy(file: sqlite3.Connection, to: Path) -> None:
    """Copy a file as it is at one moment, also while another process writes to it."""
    with closing(sqlite3.connect(to, isolation_level=None)) as target:
        file.backup(target)
        target.execute("PRAGMA journal_mode = DELETE")  # one file, and whole


@contextmanager
def transaction(file: sqlite3.Connection) -> Iterator[None]:
    """All of what is written within, or nothing."""
    file.execute("BEGIN IMMEDIATE")
    try:
        yield
        file.execute("COMMIT")
    except BaseException:
        with suppress(sqlite3.Error):
            if file.in_transaction:
                file.execute("ROLLBACK")
        raise


def damage(file: sqlite3.Connection, *, quick: bool = False) -> list[str]:
    """What SQLite finds wrong with a file, a line each; `quick` looks at its tables alone."""
    try:
        rows = file.execute("PRAGMA quick_check(1)" if quick else "PRAGMA integrity_check")
        lines = [" ".join(str(row[0]).split()) for row in rows]
    except sqlite3.DatabaseError as error:
        return [str(error)]
    return [] if lines == ["ok"] else lines


def _lock_of(path: Path) -> Path:
    return path.with_name(f"{path.name}.lock")


def connected(path: Path, mode: str, patience: float = _PATIENCE) -> sqlite3.Connection:
    """A connection that trusts nothing in the file: no function runs because its schema says so."""
    file = sqlite3.connect(
        f"{path.absolute().as_uri()}?mode={mode}",
        uri=True,
        timeout=patience,
        isolation_level=None,
        check_same_thread=False,
    )
    file.execute("PRAGMA trusted_schema = OFF")
    file.execute("PRAGMA cell_size_check = ON")
    defensive = getattr(sqlite3, "SQLITE_DBCONFIG_DEFENSIVE", None)
    if defensive is not None:  # from Python 3.12
        file.setconfig(defensive, True)  # type: ignore[attr-defined,unused-ignore]
    return file


def _recognise(file: sqlite3.Connection, name: str, kind: Format) -> None:
    """Refuse a file that is none of ours, of another version, or holds more than ours."""
    if file.execute("PRAGMA application_id").fetchone()[0] != kind.application:
        raise InputError(_NOT_OURS.format(name=name, what=kind.what))
    version = int(file.execute("PRAGMA user_version").fetchone()[0])
    if version > kind.version:
        raise InputError(f"{name} was written by a newer surae; update surae to use it")
    if version < kind.version:
        raise InputError(
            f"{name} was written by an older surae (layout {version}, this one reads "
            f"{kind.version}); use it with the surae that wrote it"
        )
    if _schema(file) != _schema_of(kind.tables):
        raise InputError(
            f"{name} holds tables or programs that are not surae's, or lacks some that are; use "
            "another file, or restore a backup"
        )


def _schema(file: sqlite3.Connection) -> frozenset[tuple[str, str, str]]:
    rows = file.execute("SELECT type, name, sql FROM sqlite_master WHERE sql IS NOT NULL")
    return frozenset((kind, name, " ".join(sql.split())) for kind, name, sql in rows)


@cache
def _schema_of(tables: str) -> frozenset[tuple[str, str, str]]:
    with closing(sqlite3.connect(":memory:")) as file:
        file.executescript(tables)
        return _schema(file)
