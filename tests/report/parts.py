"""What a report's document says, for tests to look up."""

from collections.abc import Iterator

from surae.report.document import (
    AdequacyWords,
    Block,
    Document,
    FactsBlock,
    KeyFigures,
    SectionBlock,
    TableBlock,
    TableCell,
    TextBlock,
)


def blocks(of: Document | SectionBlock) -> Iterator[Block]:
    """Every block, those of inner sections too."""
    for block in of.blocks:
        yield block
        if isinstance(block, SectionBlock):
            yield from blocks(block)


def section(document: Document, title: str) -> SectionBlock:
    """The section with this title, or one that begins so."""
    return next(
        b for b in blocks(document) if isinstance(b, SectionBlock) and b.title.startswith(title)
    )


def text(of: Document | SectionBlock) -> str:
    """All paragraphs."""
    return " ".join(b.text for b in blocks(of) if isinstance(b, TextBlock))


def rows(of: Document | SectionBlock, number: int = 0) -> dict[str, dict[str, TableCell]]:
    """The rows of a table by their first cell, and their cells by the headings."""
    table = [b for b in blocks(of) if isinstance(b, TableBlock)][number]
    heads = [column.head for column in table.columns]
    every = [
        [cell if isinstance(cell, TableCell) else TableCell(cell) for cell in row]
        for _, group in table.groups
        for row in group
    ]
    return {row[0].text: dict(zip(heads, row, strict=True)) for row in every}


def facts(of: Document | SectionBlock) -> dict[str, str]:
    """Labels and what they say."""
    return {
        label: " ".join(texts)
        for b in blocks(of)
        if isinstance(b, FactsBlock)
        for label, texts in b.facts
    }


def key(document: Document) -> tuple[tuple[str, str, str], ...]:
    """The numbers to see first."""
    return next(b for b in blocks(document) if isinstance(b, KeyFigures)).figures


def adequacy(document: Document) -> AdequacyWords:
    """What the fit is worth."""
    return next(b for b in blocks(document) if isinstance(b, AdequacyWords))
