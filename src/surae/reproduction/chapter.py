"""What a section of the reproduction is given, and what it returns.

A section is a module with one `SECTION`, named in one line of `surae.reproduction.registry`.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from surae.reproduction.claims import Finding

if TYPE_CHECKING:  # matplotlib is imported by what draws
    from matplotlib.figure import Figure

#: Told what is being computed, how many parts of it are there, and how many there are.
Progress = Callable[[str, int, int], None]
#: A cell of a table: None where there is no number, and the table says why.
Cell = str | float | int | None


def silent(what: str, done: int, total: int) -> None:
    """Progress that nobody follows."""
    del what, done, total


@dataclass(frozen=True, slots=True, kw_only=True)
class Context:
    """What a section is given.

    Attributes
    ----------
    folder : Path
        The output; a section writes into it only by `store` and by what it returns.
    seed : int
        Of everything random; never chosen for its results.
    quick : bool
        Minutes over all sections: fewer cells, subjects or repeats by the same code.
    workers : int
        Processes at a time.
    progress : callable
        To be called with what is computed, how much of it is done and how much there is.
    """

    folder: Path
    seed: int = 1
    quick: bool = False
    workers: int = 1
    progress: Progress = silent

    def store(self, name: str) -> Path:
        """Where a section keeps what it computes, so that a stopped run goes on."""
        folder = self.folder / "stores"
        folder.mkdir(parents=True, exist_ok=True)
        return folder / name


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """A figure of a section.

    Attributes
    ----------
    name : str
        File name without its ending, unique over all sections, e.g. ``"figure-11"``.
    title : str
        E.g. ``"Figure 11: SEM against the chirp's rate"``.
    caption : str
        What is drawn, in sentences.
    alt : str
        What it shows, for those who do not see it.
    figure : matplotlib.figure.Figure
        In the style of `surae.report.figures.style`: units, readable in grey.
    """

    name: str
    title: str
    caption: str
    alt: str
    figure: "Figure"


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table of a section.

    Attributes
    ----------
    name : str
        File name without its ending, unique over all sections.
    title : str
        What it holds.
    columns : tuple of str
        Headings, with units.
    rows : tuple of tuple
        As many cells as columns each.
    long : bool
        Written as a CSV file only: too long for the page.
    """

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    long: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """What a section returns; everything on the page in the order given here.

    Attributes
    ----------
    findings : tuple of Finding
        Each claim's verdict.
    figures : tuple of Drawing
        Its figures.
    tables : tuple of Table
        Its tables.
    notes : tuple of str
        What was done, with which settings and limits: paragraphs above the findings.
    """

    findings: tuple[Finding, ...]
    figures: tuple[Drawing, ...] = ()
    tables: tuple[Table, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A part of the thesis that is reproduced.

    Attributes
    ----------
    name : str
        For ``--only``.
    title : str
        Heading on the page.
    source : str
        Sections and figures of the thesis.
    run : callable
        Computes it. Pure but for its stores: the same seed gives the same result.
    """

    name: str
    title: str
    source: str
    run: Callable[[Context], Result]


def cores() -> int:
    """Processes that this computer takes at a time."""
    from joblib import cpu_count

    return int(cpu_count()) or os.cpu_count() or 1
