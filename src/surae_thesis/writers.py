"""The folder of a reproduction: the page, its PDF, and the verdicts as CSV and Markdown."""

from collections.abc import Sequence
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path

from surae import __version__
from surae.files import csv_row, read_bytes, template, write_atomic
from surae.report import has_typst, typeset
from surae_thesis.claims import Finding
from surae_thesis.section import Cell, Chapters, Context, causes, chapters, counts

#: Names of what is written, beside a PDF where there is typst.
PAGE, PDF, CSV, MARKDOWN = "reproduction.html", "reproduction.pdf", "verdicts.csv", "verdicts.md"
#: Classes of the verdicts in the style sheet.
CLASSES = {
    "holds": "holds", "holds under a reading": "partly", "differs": "differs",
    "holds with the thesis's integrator": "partly", "cannot be checked": "unchecked",
}  # fmt: skip
_COLUMNS = (
    "section", "claim", "source", "text", "thesis", "ours", "verdict", "reason", "rule", "figure",
)  # fmt: skip


def write(context: Context) -> list[Path]:
    """Write the page, the verdicts, and a PDF where typst is installed; what was written.

    Raises
    ------
    InputError
        Something cannot be written.
    """
    there = chapters(context)
    texts: dict[str, str | bytes | None] = {
        PAGE: page(context, there),
        CSV: verdicts_csv(there),
        MARKDOWN: markdown(there),
        PDF: pdf(context, there),
    }
    written = []
    for name, text in texts.items():
        if text is not None:
            write_atomic(context.folder / name, text)
            written.append(context.folder / name)
    return written


def page(context: Context, there: Chapters) -> str:
    """The page of these sections, its figures embedded; it asks nothing of the outside."""
    from surae.report.figures import data_url

    images = {
        drawing.name: data_url(
            read_bytes(context.folder / "figures" / f"{drawing.name}.png"), "png"
        )
        for _, result in there
        for drawing in result.figures
    }
    return template("reproduction.html.j2", "surae_thesis", "surae.report").render(
        chapters=there,
        counts=counts(there),
        causes=_causes(there),
        images=images,
        classes=CLASSES,
        cell=cell_text,
        seed=context.seed,
        quick=context.quick,
        version=__version__,
    )


def pdf(context: Context, there: Chapters) -> bytes | None:
    """The sections as PDF, texts as data, never as markup; None without typst (``surae[pdf]``)."""
    if not has_typst():
        return None
    content = {
        "version": __version__,
        "seed": context.seed,
        "quick": context.quick,
        "counts": counts(there),
        "causes": _causes(there),
        "chapters": [
            {"title": section.title, "source": section.source}
            | asdict(result)
            | {
                "tables": [
                    asdict(table) | {"rows": [[cell_text(cell) for cell in r] for r in table.rows]}
                    for table in result.tables
                ]
            }
            for section, result in there
        ],
    }
    markup = files("surae_thesis").joinpath("templates", "reproduction.typ").read_bytes()
    return typeset(markup, context.folder.resolve(), content)


def verdicts_csv(there: Chapters) -> str:
    """All findings as CSV."""
    rows = [
        (
            section.name, f.id, f.source, f.statement, f.number, _ours(f), f.said, f.reason,
            f.rule, f.figure,
        )
        for section, result in there
        for f in result.findings
    ]  # fmt: skip
    return "".join(map(csv_row, (_COLUMNS, *rows)))


def markdown(there: Chapters) -> str:
    """All findings as Markdown: a table for each section, a column for each view, reasons below."""
    total = ", ".join(f"{number} {verdict}" for verdict, number in counts(there).items())
    lines = [
        "# The thesis’s results, computed again",
        "",
        f"Verdicts: {total}.",
        _causes(there),
        "",
    ]
    for section, result in there:
        lines += [f"## {_plain(section.title)}", "", f"Thesis: {_plain(section.source)}.", ""]
        lines += [f"**{_plain(insight)}**\n" for insight in result.insights]
        lines += [f"{_plain(note)}\n" for note in result.notes]
        views = result.views
        heads = ["claim", "thesis", *(name or "ours" for name in views), "verdict"]
        lines += [_row([_plain(head) for head in heads]), "|" + "---|" * len(heads)]
        for f in result.findings:
            cells = [f"{f.statement} ({f.source})", f.number]
            cells += [_view(f, name) for name in views]
            lines.append(_row([*map(_plain, cells), f"**{_plain(f.said)}**"]))
        told = [f for f in result.findings if f.reason]
        lines += ["", *(f"- *{_plain(f.statement)}* {_plain(f.reason)}" for f in told), ""]
    return "\n".join(lines).rstrip() + "\n"


def _causes(there: Chapters) -> str:
    """What a second look at the claims that differ found, in a sentence; empty where none does."""
    told = ", ".join(f"{number} by {cause}" for cause, number in causes(there).items() if number)
    told = told.replace("by not published", "because what decides it is not published")
    return f"Of those that differ, {told}." if told else ""


def _view(finding: Finding, name: str) -> str:
    """Our number in one view, marked where the claim holds there."""
    if name not in finding.ours:
        return "–"
    holds, text = finding.ours[name]
    return f"✓ {text}" if holds else text


def _ours(finding: Finding) -> str:
    """All our numbers in a line."""
    return "; ".join(f"{n}: {text}" if n else text for n, (_, text) in finding.ours.items())


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _plain(text: str) -> str:
    """Text that is no markup, on one line, in a cell of a table or outside one."""
    for mark in "\\`|<[_*":
        text = text.replace(mark, f"\\{mark}")
    return " ".join(text.split())


def cell_text(cell: Cell) -> str:
    """A cell of a table as text: four digits of a number at most."""
    if cell is None:
        return "–"
    if isinstance(cell, float):
        return f"{cell:.2f}" if 10.0 <= abs(cell) < 1e4 else f"{cell:.3g}"
    return str(cell)
