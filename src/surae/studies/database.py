"""A SQLite file of ours: opened, recognised, locked by the one who writes, its errors in words."""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from surae.errors import ComputationError, InputError

#: Marks a SQLite file as ours ("srae"), and the version of its tables.
_APPLICATION, _VERSION = 0x73726165, 1


@contextmanager
def told(name: str) -> Iterator[None]:
    """SQLite's errors in words, `name` being the file's.

    Raises
    ------
    InputError
        The file is no database.
    ComputationError
        It cannot be read or written.
    """
    try:
        yield
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if code == sqlite3.SQLITE_NOTADB:
            raise InputError(_not_ours(name)) from error
        advice = ""
        if code in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR):
            advice = (
                "; make room on its disk and run the same command again: what is finished is kept"
            )
        raise ComputationError(f"{name}: {error}{advice}") from error


def _not_ours(name: str) -> str:
    return f"{name} is not a store of surae's studies; give another file"


def lock(path: Path) -> sqlite3.Connection | None:
    """The lock of the one who writes, held until it is closed or the process ends; None if taken.

    SQLite's own exclusive lock on an empty file beside the store: the system lets go of it whatever
    ends the process, and it is the same on every system.
    """
    held = sqlite3.connect(
        _beside(path), timeout=1.0, isolation_level=None, check_same_thread=False
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
    """Whether somebody writes."""
    if not _beside(path).exists():
        return False
    look = sqlite3.connect(f"{_beside(path).as_uri()}?mode=ro", uri=True, timeout=0.0)
    try:
        look.execute("SELECT 1 FROM sqlite_master").fetchall()
    except sqlite3.OperationalError as error:
        return error.sqlite_errorcode == sqlite3.SQLITE_BUSY
    finally:
        look.close()
    return False


def _beside(path: Path) -> Path:
    return path.with_name(f"{path.name}.lock")


def open_to_write(path: Path, name: str, tables: str) -> sqlite3.Connection:
    """The file, made with its tables where it is missing; the caller has its lock.

    Raises
    ------
    InputError
        It is none of ours, or of a newer surae.
    """
    file = sqlite3.connect(path, timeout=30.0, isolation_level=None)
    try:
        # Looked at before anything of a file that may not be ours is changed.
        (application,) = file.execute("PRAGMA application_id").fetchone()
        (known,) = file.execute("SELECT count(*) FROM sqlite_master").fetchone()
        if known or application:
            _recognise(file, name)
        file.execute("PRAGMA journal_mode = WAL")
        file.execute("PRAGMA synchronous = FULL")  # what is there outlives a power cut too
        if not known:
            file.executescript(
                f"BEGIN; PRAGMA application_id = {_APPLICATION}; PRAGMA user_version = {_VERSION};"
                f"{tables} COMMIT;"
            )
    except BaseException:
        file.close()
        raise
    return file


def open_to_read(path: Path, name: str) -> sqlite3.Connection:
    """The file, also while another process writes, and on a medium that is read-only.

    Raises
    ------
    InputError
        It is none of ours, or of a newer surae.
    """
    for mode in ("rw", "ro&immutable=1"):
        file = sqlite3.connect(
            f"{path.as_uri()}?mode={mode}", uri=True, timeout=30.0, isolation_level=None
        )
        try:
            file.execute("PRAGMA query_only = ON")
            _recognise(file, name)
        except sqlite3.OperationalError as error:
            file.close()
            blocked = (sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_READONLY)
            if mode != "rw" or error.sqlite_errorcode & 0xFF not in blocked:
                raise
        except BaseException:
            file.close()
            raise
        else:
            break
    return file


def _recognise(file: sqlite3.Connection, name: str) -> None:
    """Refuse a file that is none of ours, or newer."""
    if file.execute("PRAGMA application_id").fetchone()[0] != _APPLICATION:
        raise InputError(_not_ours(name))
    if file.execute("PRAGMA user_version").fetchone()[0] != _VERSION:
        raise InputError(f"{name} was written by a newer surae; update surae to use it")


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
