"""What a report's document says, for tests to look up."""

from collections.abc import Iterator

from surae.report.block import (
    AdequacyWords,
    Block,
    Cell,
    Document,
    Facts,
    Grid,
    KeyFigures,
    Section,
    Text,
)


def blocks(of: Document | Section) -> Iterator[Block]:
    """Every block, those of inner sections too."""
    for block in of.blocks:
        yield block
        if isinstance(block, Section):
            yield from blocks(block)


def section(document: Document, title: str) -> Section:
    """The section with this title, or one that begins so."""
    return next(b for b in blocks(document) if isinstance(b, Section) and b.title.startswith(title))


def text(of: Document | Section) -> str:
    """All paragraphs."""
    return " ".join(b.text for b in blocks(of) if isinstance(b, Text))


def rows(of: Document | Section, number: int = 0) -> dict[str, dict[str, Cell]]:
    """The rows of a table by their first cell, and their cells by the headings."""
    table = [b for b in blocks(of) if isinstance(b, Grid)][number]
    heads = [column.head for column in table.columns]
    every = [
        [cell if isinstance(cell, Cell) else Cell(cell) for cell in row]
        for _, group in table.groups
        for row in group
    ]
    return {row[0].text: dict(zip(heads, row, strict=True)) for row in every}


def facts(of: Document | Section) -> dict[str, str]:
    """Labels and what they say."""
    return {
        label: " ".join(texts)
        for b in blocks(of)
        if isinstance(b, Facts)
        for label, texts in b.facts
    }


def key(document: Document) -> tuple[tuple[str, str, str], ...]:
    """The numbers to see first."""
    return next(b for b in blocks(document) if isinstance(b, KeyFigures)).figures


def adequacy(document: Document) -> AdequacyWords:
    """What the fit is worth."""
    return next(b for b in blocks(document) if isinstance(b, AdequacyWords))
