"""The file that keeps a study: its plan, and every outcome from the moment it is there.

SQLite in write-ahead mode: an outcome is on disk before it counts, whatever ends the program, and
others can read meanwhile. One run at a time writes; its lock goes with its process.
"""

import json
import os
import platform
import sqlite3
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from surae.errors import InputError, SuraeError
from surae.files import PathLike, require_writable, shown
from surae.studies.database import (
    is_locked,
    lock,
    open_to_read,
    open_to_write,
    told,
    transaction,
)
from surae.studies.study import Study, Value
from surae.studies.tasks import Estimate, Outcome, Task, planned

_TABLES = """
CREATE TABLE study (name TEXT NOT NULL, text TEXT NOT NULL);
CREATE TABLE plan (row INTEGER PRIMARY KEY, key TEXT NOT NULL, factors TEXT NOT NULL);
CREATE TABLE outcome (
    key TEXT PRIMARY KEY, status TEXT NOT NULL, message TEXT NOT NULL, vaf REAL, ipde REAL,
    estimates TEXT NOT NULL, seconds REAL NOT NULL, finished REAL NOT NULL
) WITHOUT ROWID;
CREATE TABLE run (
    id INTEGER PRIMARY KEY, started REAL NOT NULL, ended REAL, how TEXT, process INTEGER NOT NULL,
    host TEXT NOT NULL
);
"""


@dataclass(frozen=True, slots=True)
class Running:
    """A run at work: its process and host, the outcomes it has added and for how long [s]."""

    process: int
    host: str
    added: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Status:
    """How far a study is.

    Attributes
    ----------
    name : str
        The study.
    rows, fits : int
        Rows of its table, and the distinct fits behind them.
    done : int
        Fits whose outcome is there.
    reasons : mapping of str to int
        Why fits failed, and how many; the most frequent first.
    running : Running or None
        The run at work; None where there is none.
    last : str
        How the last run ended; empty while one is at work, or before the first.
    """

    name: str
    rows: int
    fits: int
    done: int
    reasons: Mapping[str, int]
    running: Running | None
    last: str


class Store:
    """A study's file, open; a context manager.

    Parameters
    ----------
    path : path
        The file.
    write : bool
        For the one run that adds to it, and makes it where it is missing; else only to read.

    Raises
    ------
    InputError
        The file is missing, no store, of a newer surae, or in the hands of another run.
    ComputationError
        The file cannot be read or written; of all methods too.
    """

    def __init__(self, path: PathLike, *, write: bool = False) -> None:
        self._path, self._run = Path(os.path.realpath(path)), 0
        self._name, self._lock = shown(path), None
        if not write:
            if not self._path.is_file():
                raise InputError(f"cannot read {self._name}: there is no such file")
            with told(self._name):
                self._file = open_to_read(self._path, self._name)
            return
        require_writable(path)
        with told(self._name):
            self._lock = lock(self._path)
            if self._lock is None:
                raise InputError(
                    f"{self._name} is in use by another run{self._owner()}; wait for it, or stop "
                    "it and run again"
                )
            try:
                self._file = open_to_write(self._path, self._name, _TABLES)
            except BaseException:
                self._lock.close()
                raise

    def __enter__(self) -> Self:
        """Open already."""
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

    def _owner(self) -> str:
        """Who runs the study."""
        with suppress(SuraeError), Store(self._path) as store:
            row = store._row("SELECT process, host FROM run ORDER BY id DESC LIMIT 1")
            return f" (process {row[0]} on {row[1]})" if row else ""
        return ""

    def plan(self, study: Study) -> dict[str, Task]:
        """Keep the study's plan; its tasks without outcome, by key, in the order of the table.

        Raises
        ------
        InputError
            The store holds another study.
        """
        with told(self._name), transaction(self._file):
            held = self._row("SELECT name FROM study")
            if held and held[0] != study.name:
                raise InputError(
                    f"{self._name} holds the study {held[0]!r}, not {study.name!r}; give another "
                    "store, or the study its name"
                )
            self._file.execute("DELETE FROM study")
            self._file.execute("DELETE FROM plan")
            self._file.execute("INSERT INTO study VALUES (?, ?)", (study.name, study.text))
            tasks: dict[str, Task] = {}
            keys: dict[Task, str] = {}

            def rows() -> Iterator[tuple[int, str, str]]:
                for row, (combination, task) in enumerate(planned(study)):
                    if task not in keys:
                        keys[task] = task.key
                        tasks[keys[task]] = task
                    yield row, keys[task], json.dumps(combination)

            self._file.executemany("INSERT INTO plan VALUES (?, ?, ?)", rows())
            done = self._file.execute("SELECT key FROM outcome").fetchall()
        for (key,) in done:
            tasks.pop(key, None)
        return tasks

    def forget_failed(self) -> int:
        """Drop the outcomes of tasks that gave no fit, so that they run again; how many."""
        with told(self._name):
            return self._file.execute("DELETE FROM outcome WHERE vaf IS NULL").rowcount

    def begin(self) -> None:
        """Note that a run begins."""
        with told(self._name):
            cursor = self._file.execute(
                "INSERT INTO run (started, process, host) VALUES (?, ?, ?)",
                (time.time(), os.getpid(), platform.node()),
            )
            self._run = cursor.lastrowid or 0

    def end(self, how: str) -> None:
        """Note how the run ended; where even that cannot be written, the lock tells."""
        with suppress(sqlite3.Error):
            self._file.execute(
                "UPDATE run SET ended = ?, how = ? WHERE id = ?", (time.time(), how, self._run)
            )

    def add(self, outcomes: Iterable[tuple[str, Outcome]]) -> None:
        """Put outcomes on disk, all of them or none, by their tasks' keys."""
        now = time.time()
        rows = [
            (key, o.status, o.message, o.vaf, o.ipde, _estimates(o.estimates), o.seconds, now)
            for key, o in outcomes
        ]
        with told(self._name), transaction(self._file):
            self._file.executemany("INSERT INTO outcome VALUES (?, ?, ?, ?, ?, ?, ?, ?)", rows)

    def text(self) -> str:
        """The STUDY.toml that the plan was made from."""
        with told(self._name):
            row = self._row("SELECT text FROM study")
        if not row:
            raise InputError(f"{self._name} holds no study yet; start it with `surae study run`")
        return str(row[0])

    def rows(self) -> Iterator[tuple[dict[str, Value], Outcome]]:
        """The rows of the table whose outcome is there, in its order."""
        with told(self._name):
            found = self._file.execute(
                "SELECT factors, status, message, vaf, ipde, estimates, seconds "
                "FROM plan JOIN outcome USING (key) ORDER BY row"
            )
            for factors, status, message, vaf, ipde, estimates, seconds in found:
                yield (
                    json.loads(factors),
                    Outcome(
                        status,
                        message,
                        vaf,
                        ipde,
                        tuple(Estimate(*one) for one in json.loads(estimates)),
                        seconds,
                    ),
                )

    def status(self) -> Status:
        """How far the study is."""
        self.text()
        with told(self._name):
            (name,) = self._row("SELECT name FROM study")
            rows, fits = self._row("SELECT count(*), count(DISTINCT key) FROM plan")
            here = "FROM outcome WHERE key IN (SELECT key FROM plan)"
            (done,) = self._row(f"SELECT count(*) {here}")
            reasons = self._file.execute(
                f"SELECT message, count(*) {here} AND status = 'failed' GROUP BY message "
                "ORDER BY count(*) DESC, message"
            ).fetchall()
            run = self._row("SELECT started, how, process, host FROM run ORDER BY id DESC LIMIT 1")
            running, last = None, ""
            if run and is_locked(self._path):
                (added,) = self._row("SELECT count(*) FROM outcome WHERE finished >= ?", (run[0],))
                running = Running(run[2], run[3], added, time.time() - run[0])
            elif run:
                last = run[1] or "stopped without a word: killed, or the system went down"
        return Status(name, rows, fits, done, dict(reasons), running, last)

    def _row(self, query: str, values: Sequence[object] = ()) -> tuple[Any, ...]:
        """The first row of a query; an empty one where there is none."""
        return tuple(self._file.execute(query, values).fetchone() or ())


def _estimates(estimates: Iterable[Estimate]) -> str:
    return json.dumps([[e.name, e.value, e.sem, e.true] for e in estimates])
