"""What a user sees while something takes time: a bar on a terminal, a notice anywhere; stderr."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

_COMPILING = "Compiling the model, once for this installation: some ten seconds …"


class Work:
    """Tells how far a piece of work is; says nothing where there is no terminal."""

    def __init__(self, bar: "Progress | None" = None, task: "TaskID | None" = None) -> None:
        self._bar, self._task = bar, task
        self._first: tuple[int, float] | None = None
        self._named = ""

    def describe(self, what: str) -> None:
        """Say what is being done."""
        if self._bar is not None and self._task is not None:
            shown = what if what.isprintable() else repr(what)
            self._bar.update(self._task, description=shown)

    def starts(self, done: int, total: int, best: float) -> None:
        """Say how many starts of a fit are done; the sum of squares tells a user nothing."""
        del best
        if self._bar is not None and self._task is not None:
            what = f"fitting: start {min(done + 1, total)} of {total}"
            self._bar.update(self._task, completed=done, total=total, description=what)

    def fits(self, done: int, total: int) -> None:
        """Say how many fits of a study are kept, and how fast they come."""
        if self._bar is not None and self._task is not None:
            now = time.monotonic()
            before, began = self._first = self._first or (done, now)
            rate = f", {(done - before) / (now - began):.1f} a second" if done > before else ""
            self._bar.update(
                self._task,
                completed=done - before,
                total=total - before,
                description=f"fits: {done:,} of {total:,}{rate}",
            )

    def parts(self, what: str, done: int, total: int) -> None:
        """Say how many parts of something named are there; each name has its own estimate."""
        if self._bar is not None and self._task is not None:
            if what != self._named:
                self._named, self._first = what, (done, time.monotonic())
                self._bar.reset(self._task)
            before = self._first[0] if self._first else 0
            self._bar.update(
                self._task,
                completed=done - before,
                total=total - before,
                description=f"{what}: {done:,} of {total:,}",
            )


@contextmanager
def work() -> Iterator[Work]:
    """A bar that goes when the work is done."""
    if not sys.stderr.isatty():
        yield Work()
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=20),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        yield Work(bar, bar.add_task("", total=None))


@contextmanager
def compilation_notice() -> Iterator[None]:
    """Say why the first run is slow, when and only when the model really is compiled."""
    from surae.api import on_compilation

    with on_compilation(lambda: click.echo(_COMPILING, err=True)):
        yield
