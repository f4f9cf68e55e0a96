"""The folder of a reproduction: the page, its PDF, and the verdicts as Markdown."""

from collections.abc import Sequence
from dataclasses import asdict
from itertools import starmap
from pathlib import Path

from surae import __version__
from surae.base.files import read_bytes, write_atomic
from surae.report import has_typst
from surae.report.block import (
    Block,
    Cell,
    Document,
    Grid,
    KeyFigures,
    Picture,
    Points,
    Row,
    Text,
    columns,
    paragraphs,
    rows,
)
from surae.report.block import Section as Shown
from surae_thesis.claims import JudgedClaim
from surae_thesis.section import Cell as Value
from surae_thesis.section import (
    Chapters,
    Context,
    Result,
    Section,
    causes,
    chapters,
    counts,
    keep,
)
from surae_thesis.verdicts import TITLE, causes_said, judged_by, markdown, number_in

#: Names of what is written, beside a PDF where there is typst.
PAGE = "reproduction.html"
PDF = "reproduction.pdf"
MARKDOWN = "verdicts.md"
#: Classes of the verdicts in the style sheet.
CLASSES = {
    "holds": "holds",
    "holds under a reading": "partly",
    "differs": "differs",
    "holds with the thesis's integrator": "partly",
    "same direction, smaller": "partly",
    "calibrated": "unchecked",
    "not tested by this": "unchecked",
    "cannot be checked": "unchecked",
}


def write(context: Context) -> list[Path]:
    """Write the page, the verdicts, and a PDF where typst is installed; what was written.

    Raises
    ------
    InputError
        Something cannot be written.
    """
    there = chapters(context)
    texts = {PAGE: page(context, there), MARKDOWN: markdown(there), PDF: pdf(context, there)}
    written = {context.folder / name: text for name, text in texts.items() if text is not None}
    for path, text in written.items():
        write_atomic(path, text)
    return list(written)


def document(context: Context, there: Chapters) -> Document:
    """The sections as a page or paper shows them."""
    quick = ", quick: a part of the fits" if context.quick else ""
    contents = [f"{s.title} ({s.source}): {len(result.findings)} claims" for s, result in there]
    summary: tuple[Block, ...] = (
        KeyFigures(tuple((verdict, str(n), "") for verdict, n in counts(there).items())),
        *paragraphs(filter(None, [causes_said(causes(there))])),
        Text(
            "Each claim has the thesis's sentence and a numeric rule for when it holds, printed "
            "with it. The first column that it is judged in is how we read the thesis, and "
            "decides; the others show, ✓ where it holds, what another reading or the thesis's "
            "integrator changes. What could not have come out otherwise, or what chance decides, "
            "is not tested by this, and counts for nothing. What is random has one seed, which was "
            "not chosen for its results."
        ),
        Points("", tuple(contents), links=tuple(section.name for section, _ in there)),
    )
    return Document(
        kicker="Reproduction",
        heading=TITLE,
        under="Estimating ankle muscle parameters (van de Poll, 2015), every claim beside ours. "
        f"surae {__version__}, seed {context.seed}{quick}.",
        title=TITLE,
        blocks=(Shown("Summary", summary, "summary"), *starmap(_chapter, there)),
        footer="Made by surae for research. SEM: equation (34); IPDE: equation (35) as the root of "
        "the sum of squares over the upper triangle of the normalised covariance; VAF: equation "
        "(31).",
    )


def _chapter(section: Section, result: Result) -> Shown:
    """A section of the thesis: what we say of it, its claims, figures and tables."""
    under = [f"Thesis: {section.source}"] if section.source else []
    under += [f"computed on {result.made}"] if result.made else []
    blocks: list[Block] = [Text("; ".join(under), "under")] if under else []
    blocks += [Text("", lead=text) for text in result.insights]
    blocks += paragraphs(result.notes)
    if result.findings:
        heads = columns(
            "In the thesis",
            "Claim",
            "Thesis",
            *(name or "Ours" for name in result.views),
            "Verdict",
            wide=range(1, 3 + len(result.views)),
            looks={0: "where", 3 + len(result.views): "judged"},
        )
        claims = [row for f in result.findings for row in _claim_rows(f, result.views)]
        blocks.append(Grid("Claims of the thesis and ours", heads, rows(claims), "claims"))
    for drawing in result.figures:
        picture = Picture(drawing.name, drawing.alt, drawing.caption, "here", width=100)
        blocks.append(Shown(drawing.title, (picture,), drawing.name))
    for table in result.tables:
        if table.long:
            blocks.append(Text(f"{table.title}: tables/{table.name}.csv", "note"))
            continue
        numbers = [
            k
            for k in range(len(table.columns))
            if k and all(isinstance(row[k], float | int | None) for row in table.rows)
        ]
        cells = (tuple(map(cell_text, row)) for row in table.rows)
        shown = Grid(table.title, columns(*table.columns, numbers=numbers), rows(cells))
        blocks.append(Shown(table.title, (shown,)))
    return Shown(section.title, tuple(blocks), section.name, "page")


def _claim_rows(finding: JudgedClaim, views: Sequence[str]) -> tuple[Row, Row]:
    """A claim beside ours in every view, and below it its sentence, when it holds, and why."""
    badge = (f"verdict {CLASSES[finding.verdict]}", finding.said)
    return (
        (
            Cell(finding.source, under=finding.id),
            finding.statement,
            finding.number,
            *(number_in(finding, name) for name in views),
            Cell(badge=badge),
        ),
        (Cell(meaning=judged_by(finding), why=finding.reason),),
    )


def write_result(folder: Path, kicker: str, heading: str, result: Result) -> Path:
    """Write a result that no claim is judged by: figures, tables, and the page that shows them."""
    from surae.report.output import page_of

    context = Context(folder=folder)
    section = Section(name=kicker, title=heading, source="", run=lambda _: result)
    keep(context, section, result)
    there = [(section, result)]
    images = _figures(context, there, "png")
    document = Document(
        kicker, heading, f"surae {__version__}", heading, tuple(starmap(_chapter, there))
    )
    path = folder / f"{kicker}.html"
    write_atomic(path, page_of(document, {name: _url(data) for name, data in images.items()}))
    return path


def page(context: Context, there: Chapters) -> str:
    """The page of these sections, its figures embedded; it asks nothing of the outside."""
    from surae.report.output import page_of

    images = {name: _url(data) for name, data in _figures(context, there, "png").items()}
    return page_of(document(context, there), images)


def _url(png: bytes) -> str:
    from surae.report.figures import data_url

    return data_url(png, "png")


def pdf(context: Context, there: Chapters) -> bytes | None:
    """The sections as PDF; None without typst (``surae[pdf]``)."""
    from surae.report.output import paper_of

    if not has_typst():
        return None
    return paper_of(asdict(document(context, there)), _figures(context, there, "svg"))


def _figures(context: Context, there: Chapters, ending: str) -> dict[str, bytes]:
    """The figures by name, as they were kept."""
    return {
        drawing.name: read_bytes(context.folder / "figures" / f"{drawing.name}.{ending}")
        for _, result in there
        for drawing in result.figures
    }


def cell_text(cell: Value) -> str:
    """A cell of a table as text: four digits of a number at most."""
    if cell is None:
        return "–"
    if isinstance(cell, float):
        return f"{cell:.2f}" if 10.0 <= abs(cell) < 1e4 else f"{cell:.3g}"
    return str(cell)
