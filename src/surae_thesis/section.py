"""What a section of the reproduction is given and returns, and the sections that there are."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from surae import InputError
from surae.files import shown
from surae_thesis.claims import Finding

if TYPE_CHECKING:  # matplotlib is imported by what draws
    from matplotlib.figure import Figure

#: Told what is being computed, how many parts of it are there, and how many there are.
Progress = Callable[[str, int, int], None]
#: A cell of a table: None where there is no number, and the table says why.
Cell = str | float | int | None

#: Name → module with its `SECTION`, in the order of the page; imported only when it is run.
SECTIONS = {
    "protocols": "surae_thesis.movements",
    "tendons": "surae_thesis.tendons",
    "simulation": "surae_thesis.simulation",
    "subjects": "surae_thesis.cohort",
    "beyond": "surae_thesis.cohort.beyond",
    "appendix": "surae_thesis.appendix",
}


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
        E.g. ``"Figure 11: SEM against the chirp's factor"``.
    caption : str
        What is drawn, in sentences.
    alt : str
        What it shows, for those who do not see it.
    figure : matplotlib.figure.Figure
        In the style of `surae.report.figures`: units, readable in grey.
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
    insights : tuple of str
        What we find about the thesis, with numbers, in a sentence or two each: above the claims.
    figures, tables : tuple of Drawing, tuple of Table
        Its figures and tables.
    notes : tuple of str
        What was done, with which settings and limits: paragraphs above the findings.
    """

    findings: tuple[Finding, ...]
    insights: tuple[str, ...] = ()
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


def sections(only: Sequence[str] = ()) -> list[Section]:
    """The sections asked for, all of them by default, in the order of the page.

    Raises
    ------
    InputError
        A name is not known.
    """
    for name in only:
        if name not in SECTIONS:
            raise InputError(f"no section {name!r}; use one of: {', '.join(SECTIONS)}")
    chosen: list[Section] = [
        import_module(module).SECTION
        for name, module in SECTIONS.items()
        if not only or name in only
    ]
    return chosen


def reproduce(
    context: Context,
    chosen: Sequence[Section],
    started: Callable[[Section], None] | None = None,
) -> list[Path]:
    """Run sections and write the page after each, so that what is finished is there.

    Parameters
    ----------
    context : Context
        Settings; its folder is made where it is not there.
    chosen : sequence of Section
        Which; the page also shows the others that have run in the folder with these settings.
    started : callable, optional
        Told of each section before it runs.

    Returns
    -------
    list of Path
        What was written, the page first.

    Raises
    ------
    InputError, ComputationError
        A section cannot go on, or something cannot be written; what is finished is kept.
    """
    from surae_thesis.kept import keep
    from surae_thesis.writers import write

    written: list[Path] = []
    for section in chosen:
        if started is not None:
            started(section)
        keep(context, section, section.run(context))
        written = write(context)
    return written


def make_folder(path: Path) -> None:
    """Make the output folder.

    Raises
    ------
    InputError
        It cannot be made, or cannot be written into.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        probe = path / ".surae-probe"
        probe.touch()
        probe.unlink()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"cannot write into the folder {shown(path)}: {reason.lower()}") from None
