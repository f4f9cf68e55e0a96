"""What sections have found, kept in the folder: figures, tables, and the rest as plain data."""

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from surae import InputError, __version__
from surae.files import read_bytes, shown, write_atomic, write_json
from surae_thesis.claims import VERDICTS, Finding, Verdict
from surae_thesis.section import SECTIONS, Cell, Context, Result, Section, Table


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """A figure that is drawn: a `section.Drawing` with its file in place of the figure."""

    name: str
    title: str
    caption: str
    alt: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Chapter:
    """A section that has run, plain data: what the page is made of.

    Attributes
    ----------
    name, title, source : str
        Of the section.
    findings : tuple of Finding
        Its verdicts.
    insights : tuple of str
        What we find about the thesis.
    pictures : tuple of Picture
        Its figures, in the folder ``figures``.
    tables : tuple of Table
        Its tables; of a long one no rows, they are in the folder ``tables``.
    notes : tuple of str
        Paragraphs.
    """

    name: str
    title: str
    source: str
    findings: tuple[Finding, ...]
    insights: tuple[str, ...]
    pictures: tuple[Picture, ...]
    tables: tuple[Table, ...]
    notes: tuple[str, ...]

    @property
    def views(self) -> tuple[str, ...]:
        """Views under which its claims are judged, a column each."""
        return tuple(dict.fromkeys(name for f in self.findings for name in f.ours))


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
            path = _folder(context, "figures") / f"{drawing.name}.{ending}"
            write_atomic(path, draw(drawing.figure))
    for table in result.tables:
        path = _folder(context, "tables") / f"{table.name}.csv"
        write_atomic(path, csv_text(table.columns, table.rows))
    write_json(
        _folder(context, "sections") / f"{section.name}.json",
        {
            "settings": _settings(context),
            "name": section.name,
            "title": section.title,
            "source": section.source,
            "findings": [finding.plain() for finding in result.findings],
            "insights": list(result.insights),
            "pictures": [
                {key: getattr(drawing, key) for key in ("name", "title", "caption", "alt")}
                for drawing in result.figures
            ],
            "tables": [
                asdict(table) | {"rows": [] if table.long else [list(row) for row in table.rows]}
                for table in result.tables
            ],
            "notes": list(result.notes),
        },
    )


def chapters(context: Context) -> list[Chapter]:
    """The sections that have run in the folder with these settings, in the order of the page.

    Raises
    ------
    InputError
        What a section wrote cannot be read.
    """
    there = []
    for name in SECTIONS:
        path = context.folder / "sections" / f"{name}.json"
        if not path.is_file():
            continue
        try:
            data = json.loads(read_bytes(path))
            if data["settings"] == _settings(context):
                there.append(_chapter(data))
        except (ValueError, KeyError, TypeError):
            raise InputError(
                f"{shown(path)} is not what a section writes; remove it and run the section again"
            ) from None
    return there


def _settings(context: Context) -> dict[str, Any]:
    """What sections on one page have in common."""
    return {"surae": __version__, "seed": context.seed, "quick": context.quick}


def _chapter(data: dict[str, Any]) -> Chapter:
    return Chapter(
        name=data["name"],
        title=data["title"],
        source=data["source"],
        findings=tuple(Finding.of(finding) for finding in data["findings"]),
        insights=tuple(data["insights"]),
        pictures=tuple(Picture(**picture) for picture in data["pictures"]),
        tables=tuple(
            Table(
                name=table["name"],
                title=table["title"],
                columns=tuple(table["columns"]),
                rows=tuple(tuple(row) for row in table["rows"]),
                long=table["long"],
            )
            for table in data["tables"]
        ),
        notes=tuple(data["notes"]),
    )


def counts(chapters: Sequence[Chapter]) -> dict[Verdict, int]:
    """How many claims have each verdict."""
    every = [finding.verdict for chapter in chapters for finding in chapter.findings]
    return {verdict: every.count(verdict) for verdict in VERDICTS}


def csv_text(columns: Sequence[str], rows: Sequence[Sequence[Cell]]) -> str:
    """A table as CSV, None as an empty cell."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(["" if cell is None else cell for cell in row] for row in rows)
    return text.getvalue()


def _folder(context: Context, name: str) -> Path:
    folder = context.folder / name
    folder.mkdir(parents=True, exist_ok=True)
    return folder
