"""One file that keeps what many calls give, from the moment it is there.

SQLite in write-ahead mode: a result is on disk before it counts, whatever ends the program, and
others can read meanwhile. One run at a time writes. Its lock goes with its process; where somebody
removes the lock's file all the same, the run that begins later takes over, and the earlier stops.
"""

import json
import os
import platform
import sqlite3
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing, suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from surae.base import database
from surae.base.database import Format, sqlite_errors, transaction
from surae.base.errors import ComputationError, InputError, SuraeError
from surae.base.files import PathLike, require_writable, shown
from surae.processes import Plain
from surae.processes.runner import Batch, Died

FORMAT = Format(
    application=0x73726165,  # "srae"
    version=2,
    what="a store of surae",
    tables="""
CREATE TABLE about (kind TEXT NOT NULL, name TEXT NOT NULL, text TEXT NOT NULL);
CREATE TABLE plan (row INTEGER PRIMARY KEY, key TEXT NOT NULL, label TEXT NOT NULL);
CREATE TABLE result (
    key TEXT PRIMARY KEY, value TEXT NOT NULL, failed TEXT, finished REAL NOT NULL
) WITHOUT ROWID;
CREATE TABLE run (
    id INTEGER PRIMARY KEY, started REAL NOT NULL, ended REAL, how TEXT, process INTEGER NOT NULL,
    host TEXT NOT NULL
);
""",
    full="{name}: make room on its disk and run the same command again: what is finished is kept",
    damaged="restore it from a copy, or run again with a new file",
)


#: What reading a damaged result raises.
_DAMAGE = (ValueError, TypeError, LookupError, RecursionError)


@dataclass(frozen=True, slots=True)
class Running:
    """A run at work: its process and host, the results it has added and for how long [s]."""

    process: int
    host: str
    added: int
    seconds: float


@dataclass(frozen=True, slots=True)
class LedgerStatus:
    """How far a plan is."""

    name: str  #: What it is of.
    #: `rows`, `calls`: rows of the plan, and the distinct calls behind them.
    rows: int
    calls: int
    done: int  #: Calls whose result is there.
    reasons: Mapping[str, int]  #: Why calls failed, and how many; the most frequent first.
    running: Running | None  #: The run at work; None where there is none.
    last: str  #: How the last run ended; empty while one is at work, or before the first.


class Ledger:
    """The file, open, a context manager; `write` is for the one run that adds to it."""

    #: What is said of a file that nothing was planned in.
    _NOTHING = "nothing yet"

    def __init__(self, path: PathLike, *, write: bool = False) -> None:
        self._run = 0
        self._lock = None
        self._path, self._name = Path(os.path.realpath(path)), shown(path)
        if not write:
            if not self._path.is_file():
                raise InputError(f"cannot read {self._name}: there is no such file")
            with self._errors():
                self._file = database.open_to_read(self._path, self._name, FORMAT)
            return
        require_writable(path)
        with self._errors():
            self._lock = database.lock(self._path)
            if self._lock is None:
                raise _in_use(self._path, self._name)
            try:
                self._file = database.open_to_write(self._path, self._name, FORMAT)
            except BaseException:
                self._lock.close()
                raise

    def __enter__(self) -> Self:
        """Give the ledger, which is open already."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Let go of the file, then of its lock."""
        with suppress(sqlite3.Error):
            self._file.close()
        if self._lock is not None:
            self._lock.close()

    def about(self) -> tuple[str, str, str] | None:
        """What is planned: kind, name and text; None before the first plan."""
        with self._errors():
            row = self._row("SELECT kind, name, text FROM about")
        return (str(row[0]), str(row[1]), str(row[2])) if row else None

    def begin(self, kind: str, name: str, text: str, rows: Iterable[tuple[str, Plain]]) -> set[str]:
        """Begin a run: keep its plan, keys with labels; the keys whose result is whole."""
        held = self.about()
        if held is not None and held[:2] != (kind, name):
            raise InputError(
                f"{self._name} holds the {held[0]} {held[1]!r}, not {name!r}; give another store, "
                f"or the {kind} its name"
            )
        with self._errors(), transaction(self._file):
            self._file.execute("DELETE FROM about")
            self._file.execute("DELETE FROM plan")
            self._file.execute("INSERT INTO about VALUES (?, ?, ?)", (kind, name, text))
            self._file.executemany(
                "INSERT INTO plan VALUES (?, ?, ?)",
                ((row, key, json.dumps(label)) for row, (key, label) in enumerate(rows)),
            )
            kept = self._file.execute("SELECT key, value, failed FROM result")
            damaged = []
            for key, value, failed in kept:
                try:
                    self._result(value, failed)
                except _DAMAGE:
                    damaged.append((key,))
            self._file.executemany("DELETE FROM result WHERE key = ?", damaged)
            cursor = self._file.execute(
                "INSERT INTO run (started, process, host) VALUES (?, ?, ?)",
                (time.time(), os.getpid(), platform.node()),
            )
            self._run = cursor.lastrowid or 0
            done = self._file.execute("SELECT key FROM result").fetchall()
        return {key for (key,) in done}

    def keep(
        self, batches: Generator[Batch], progress: Callable[[int, int], None] | None = None
    ) -> int:
        """Keep results as they come, telling `progress` how many of the plan; how many came."""
        status = self.status()
        added = 0
        how = "stopped by an error"
        try:
            with closing(batches):
                if progress is not None:
                    progress(status.done, status.calls)
                for batch in batches:
                    self.add(batch)
                    added += len(batch)
                    if progress is not None:
                        progress(status.done + added, status.calls)
            how = "finished"
        except KeyboardInterrupt:
            how = "stopped by the user"
            raise
        finally:
            self.end(how)
        return added

    def end(self, how: str) -> None:
        """Note how the run ended; where even that cannot be written, the lock tells."""
        with suppress(sqlite3.Error):
            self._file.execute(
                "UPDATE run SET ended = ?, how = ? WHERE id = ?", (time.time(), how, self._run)
            )

    def add(self, batch: Batch) -> None:
        """Put results on disk by their keys, all or none; none once another run took over."""
        now = time.time()
        rows = [
            (key, "null", value.message, now)
            if isinstance(value, Died)
            else (key, json.dumps(value, allow_nan=False), self._reason(value), now)
            for key, value in batch
        ]
        with self._errors(), transaction(self._file):
            if self._row("SELECT max(id) FROM run")[0] != self._run:
                raise ComputationError(
                    f"{self._name} was taken over by another run, as its .lock was removed; this "
                    "one stops, what it has finished is kept"
                )
            self._file.executemany("INSERT INTO result VALUES (?, ?, ?, ?)", rows)

    def _reason(self, value: Plain) -> str | None:
        """Why a call failed that has a result all the same; None where it did not."""
        del value
        return None

    def results(self) -> Iterator[tuple[Plain, Any]]:
        """The plan's labels whose result is there and whole, in its order, with it or `Died`."""
        with self._errors():
            rows = self._file.execute(
                "SELECT label, value, failed FROM plan JOIN result USING (key) ORDER BY row"
            )
            for label, value, failed in rows:
                try:
                    yield json.loads(label), self._result(value, failed)
                except _DAMAGE:
                    continue  # damaged: the next run computes it again

    def status(self) -> LedgerStatus:
        """How far the plan is."""
        held = self.about()
        if held is None:
            raise InputError(f"{self._name} holds {self._NOTHING}")
        with self._errors():
            rows, calls = self._row("SELECT count(*), count(DISTINCT key) FROM plan")
            here = "FROM result WHERE key IN (SELECT key FROM plan)"
            (done,) = self._row(f"SELECT count(*) {here}")
            reasons = self._file.execute(
                f"SELECT failed, count(*) {here} AND failed IS NOT NULL GROUP BY failed "
                "ORDER BY count(*) DESC, failed"
            ).fetchall()
            run = self._row("SELECT started, how, process, host FROM run ORDER BY id DESC LIMIT 1")
            running = None
            last = ""
            if run and database.is_locked(self._path):
                (added,) = self._row("SELECT count(*) FROM result WHERE finished >= ?", (run[0],))
                running = Running(run[2], run[3], added, time.time() - run[0])
            elif run:
                last = run[1] or "stopped without a word: killed, or the system went down"
        return LedgerStatus(held[1], rows, calls, done, dict(reasons), running, last)

    def _result(self, value: Any, failed: Any) -> object:
        plain = json.loads(value)
        return Died(str(failed)) if plain is None and failed else self._read(plain)

    def _read(self, value: Plain) -> object:
        """What a result means; it is damaged where that cannot be told."""
        return value

    def _errors(self) -> AbstractContextManager[None]:
        return sqlite_errors(self._name, FORMAT)

    def _row(self, query: str, values: Sequence[object] = ()) -> tuple[Any, ...]:
        """The first row of a query; an empty one where there is none."""
        return tuple(self._file.execute(query, values).fetchone() or ())


def _in_use(path: Path, name: str) -> InputError:
    owner = ""
    with suppress(SuraeError), Ledger(path) as ledger:
        row = ledger._row("SELECT process, host FROM run ORDER BY id DESC LIMIT 1")
        owner = f" (process {row[0]} on {row[1]})" if row else ""
    return InputError(
        f"{name} is in use by another run{owner}; wait for it, or stop it and run again"
    )
