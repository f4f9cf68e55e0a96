"""What a user sees while something takes time: a bar on a terminal, a notice anywhere; stderr."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from surae import api
from surae.base.errors import SuraeError

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

#: What commands of other distributions are made of.
__all__ = ["StoppedError", "compilation_notice", "work"]

#: What `compilation_notice` says.
COMPILING = "Compiling the model, once for this installation: some ten seconds …"


class StoppedError(SuraeError):
    """The user stopped it, and what was complete is kept: the message says what. Exit 130."""


class Work:
    """Shows how far a piece of work is; nothing where there is no terminal."""

    def __init__(self, bar: "Progress | None" = None, task: "TaskID | None" = None) -> None:
        self._bar = bar
        self._task = task
        self._first = 0
        self._begun = 0.0
        self._named = ""

    def describe(self, what: str, done: int | None = None, total: int | None = None) -> None:
        """Say what is being done, and with `done` and `total` how far it is."""
        if self._bar is not None and self._task is not None:
            shown = what if what.isprintable() else repr(what)
            self._bar.update(self._task, description=shown, completed=done, total=total)

    def starts(self, done: int, total: int, best: float) -> None:
        """Say how many starts of a fit are done; users need no sum of squares."""
        del best
        self.describe(f"fitting: start {min(done + 1, total)} of {total}", done, total)

    def judging(self) -> None:
        """Say that the search is over and the fit is judged: how long that takes nobody knows."""
        if self._bar is not None and self._task is not None:
            self._bar.reset(self._task, total=None)
        self.describe("judging what the fit is worth")

    def parts(self, what: str, done: int, total: int) -> None:
        """Say how many parts of something named are there, and how fast they come.

        What was there at first took no time now: it does not count in what is left.
        """
        if what != self._named:
            self._named, self._first, self._begun = what, done, time.monotonic()
            if self._bar is not None and self._task is not None:
                self._bar.reset(self._task)
        made = done - self._first
        rate = f", {made / (time.monotonic() - self._begun):.1f} a second" if made else ""
        self.describe(f"{what}: {done:,} of {total:,}{rate}", made, total - self._first)


@contextmanager
def work() -> Iterator[Work]:
    """A bar that goes when the work is done."""
    if not sys.stderr.isatty():
        yield Work()
        return
    from rich import progress
    from rich.console import Console

    columns = (
        progress.TextColumn("{task.description}", markup=False),
        progress.BarColumn(bar_width=20),
        progress.TimeElapsedColumn(),
        progress.TextColumn("left"),
        progress.TimeRemainingColumn(),
    )
    with progress.Progress(
        *columns, console=Console(stderr=True), transient=True, speed_estimate_period=600.0
    ) as bar:
        yield Work(bar, bar.add_task("", total=None))


@contextmanager
def compilation_notice() -> Iterator[None]:
    """Say why the first run is slow, when and only when the model really is compiled."""
    with api.on_compilation(lambda: click.echo(COMPILING, err=True)):
        yield
