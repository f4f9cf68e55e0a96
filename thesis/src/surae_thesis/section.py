"""A section of the reproduction: what it is given, what it returns, and how that is kept."""

import hashlib
import inspect
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import date
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from surae import InputError, __version__
from surae.base.file_form import filed
from surae.base.files import csv_row, read_bytes, require_writable, shown, write_atomic, write_json
from surae.base.records import from_plain, to_plain
from surae_thesis.claims import CAUSES, VERDICTS, JudgedClaim

#: Told what is being computed, how many parts of it are there, and how many there are.
Progress = Callable[[str, int, int], None]
#: A cell of a table: None where there is no number, and the table says why.
Cell = str | int | float | None
#: Plain data that JSON holds without loss: numbers finite, keys texts.
Plain = Any


def silent(what: str, done: int, total: int) -> None:
    """Progress that nobody follows."""
    del what, done, total


@dataclass(frozen=True, slots=True, kw_only=True)
class Context:
    """What a section is given, and how it keeps what takes long: a stopped run goes on.

    The seed is of everything random and never chosen for its results; quick is minutes over all
    sections, fewer cells and subjects by the same code.
    """

    folder: Path
    seed: int = 1
    quick: bool = False
    workers: int = 1
    progress: Progress = silent

    def store(self, name: str) -> Path:
        """Where what is computed under a name, unique over all sections, is kept."""
        return self.inner("stores") / f"{name}.db"

    def inner(self, name: str) -> Path:
        """A folder of the output, made where it is not there."""
        folder = self.folder / name
        folder.mkdir(parents=True, exist_ok=True)
        return folder

    def calls(
        self,
        name: str,
        function: Callable[..., Plain],
        jobs: Mapping[str, Mapping[str, Plain]],
        *,
        also: tuple[ModuleType, ...] = (),
    ) -> dict[str, Plain]:
        """Call a pure function of a module with each job's keywords; see `kept_calls`.

        A change in the function's module, in those named `also`, or in what fits and simulates,
        computes again.
        """
        from surae.studies import fingerprint
        from surae_thesis.kept import kept_calls

        digest = hashlib.sha256(f"{fingerprint()} {function.__qualname__}".encode())
        for module in (inspect.getmodule(function), *also):
            if module is not None and module.__file__:
                digest.update(Path(module.__file__).read_bytes())
        return kept_calls(
            self.store(name),
            function,
            jobs,
            program=digest.hexdigest(),
            workers=self.workers,
            progress=lambda done, total: self.progress(name, done, total),
        )


@filed("figure")
@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure, None where it is in the file of its name; `alt` is for those who do not see it."""

    name: str
    title: str
    caption: str
    alt: str
    figure: Any = None  # matplotlib's, which is imported by what draws


@dataclass(frozen=True, slots=True)
class Table:
    """A table; a long one is written as a CSV file of its name only."""

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    long: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """What a section returns; everything on the page in the order given here.

    Insights say what we find about the thesis, with numbers; notes what was done and how.
    """

    insights: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    findings: tuple[JudgedClaim, ...]
    figures: tuple[Drawing, ...] = ()
    tables: tuple[Table, ...] = ()
    made: str = ""  # the day, and by which version, once it is kept

    @property
    def views(self) -> tuple[str, ...]:
        """Views under which the claims are judged, a column each."""
        return tuple(dict.fromkeys(name for f in self.findings for name in f.ours))


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A part of the thesis that is reproduced: name for ``--only``, heading and place there."""

    name: str
    title: str
    source: str
    run: Callable[[Context], Result]


def _section(name: str, module: str, title: str, source: str) -> Section:
    """A section whose module is imported only when it is run."""
    return Section(
        name=name,
        title=title,
        source=source,
        run=lambda context: import_module(f"surae_thesis.{module}").run(context),
    )


#: In the order of the page.
SECTIONS = (
    _section(
        "protocols",
        "movements",
        "Movements and efforts",
        "2.1, 2.5, 4.1.5; Figures 2, 3, 6–9, 36–38",
    ),
    _section(
        "tendons",
        "tendons",
        "Models and tendons",
        "2.3, 2.4, 4.4, appendix B; Figures 39, 44 and 45",
    ),
    _section("simulation", "simulation", "Simulation study", "2.5, 3.1, 4.1; Figures 11–16"),
    _section(
        "subjects",
        "cohort.subjects",
        "Subjects: a virtual cohort",
        "3.2, 4.2, 4.4; Figures 17 to 35 and 40",
    ),
    _section("beyond", "cohort.beyond", "Beyond: joint fits of the cohort", "4.4, 4.5"),
    _section(
        "appendix", "appendix", "What a covariance matrix shows", "Appendix A; Figures 42 and 43"
    ),
)


def sections(only: Sequence[str] = ()) -> list[Section]:
    """The sections asked for, all of them by default, in the order of the page.

    Raises
    ------
    InputError
        A name is not known.
    """
    names = [section.name for section in SECTIONS]
    for name in only:
        if name not in names:
            raise InputError(f"no section {name!r}; use one of: {', '.join(names)}")
    return [section for section in SECTIONS if not only or section.name in only]


#: What there is of a reproduction: sections that have run, with what they found.
Chapters = Sequence[tuple[Section, Result]]


def keep(context: Context, section: Section, result: Result) -> None:
    """Write what a section found: figures as PNG and SVG, tables as CSV, the rest as JSON.

    Raises
    ------
    InputError
        Something cannot be written.
    """
    from surae.report.figures import png, svg

    for drawing in result.figures:
        for ending, draw in (("png", png), ("svg", svg)):
            if drawing.figure is not None:
                path = context.inner("figures") / f"{drawing.name}.{ending}"
                write_atomic(path, draw(drawing.figure))
    for table in result.tables:
        path = context.inner("tables") / f"{table.name}.csv"
        write_atomic(path, "".join(map(csv_row, (table.columns, *table.rows))))
    quick = ", a part of the fits" if context.quick else ""
    plain = replace(
        result,
        tables=tuple(replace(t, rows=()) if t.long else t for t in result.tables),
        made=f"{date.today().isoformat()} by surae {__version__}, seed {context.seed}{quick}",
    )
    path = context.inner("sections") / f"{section.name}.json"
    write_json(path, {"settings": _settings(context), **to_plain(plain)})


def chapters(context: Context) -> Chapters:
    """The sections that have run in the folder with these settings, in the order of the page.

    A section that another version computed is there too, and says so.

    Raises
    ------
    InputError
        What a section wrote cannot be read.
    """
    there = []
    ours = _settings(context)
    for section in SECTIONS:
        path = context.folder / "sections" / f"{section.name}.json"
        if not path.is_file():
            continue
        try:
            data = json.loads(read_bytes(path))
            settings = data.pop("settings")
            if {name: settings[name] for name in ours} == ours:
                there.append((section, from_plain(Result, data)))
        except (ValueError, KeyError, TypeError, AttributeError):
            raise InputError(
                f"{shown(path)} is not what a section writes; remove it and run the section again"
            ) from None
    return there


def _settings(context: Context) -> dict[str, Any]:
    """What sections on one page have in common."""
    return {"seed": context.seed, "quick": context.quick}


def counts(chapters: Chapters) -> dict[str, int]:
    """How many claims have each verdict."""
    every = [finding.verdict for _, result in chapters for finding in result.findings]
    return {verdict: every.count(verdict) for verdict in VERDICTS}


def causes(chapters: Chapters) -> dict[str, int]:
    """How many of the claims that differ do so by each cause."""
    every = [finding.said for _, result in chapters for finding in result.findings]
    return {cause: every.count(f"differs: {cause}") for cause in CAUSES}


def make_folder(path: Path) -> None:
    """Make the output folder.

    Raises
    ------
    InputError
        It cannot be made, or cannot be written into.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"cannot write into the folder {shown(path)}: {reason.lower()}") from None
    require_writable(path / "reproduction.html")
