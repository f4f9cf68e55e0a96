"""An answer as a table: plain text in a console, HTML in a notebook's cell."""

from dataclasses import dataclass
from html import escape

from surae.base.words import JUDGEMENTS

#: Colours of words that judge, which can be told on white and on black.
_COLOURS = {"good": "#1f8f4d", "weak": "#a86e00", "bad": "#c0392b", "quiet": "inherit"}


@dataclass(frozen=True, slots=True)
class TextTable:
    """Texts in rows, with lines above and below them."""

    heads: tuple[str, ...]  #: Of the columns.
    rows: tuple[tuple[str, ...], ...]  #: As many cells each.
    above: tuple[str, ...] = ()  #: Lines before the table, a title first.
    below: tuple[str, ...] = ()  #: Lines after it.
    numbers: tuple[str, ...] = ()  #: Heads of the columns that are written to the right.

    def text(self) -> str:
        """The table as lines of text."""
        rows = [self.heads, *self.rows] if self.rows else []
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = [
            "  ".join(
                cell.rjust(width) if head in self.numbers else cell.ljust(width)
                for head, cell, width in zip(self.heads, row, widths, strict=True)
            ).rstrip()
            for row in rows
        ]
        parts = ("\n".join(part) for part in (self.above, lines, self.below) if part)
        return "\n\n".join(parts)

    def html(self) -> str:
        """The table as HTML, which asks nothing of the outside."""
        first, *above = self.above or ("",)
        body = "".join(f"<tr>{''.join(map(self._cell, self.heads, row))}</tr>" for row in self.rows)
        head = "".join(f"<th style='text-align:left'>{escape(text)}</th>" for text in self.heads)
        whole = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        lines = "<br>".join(map(escape, above))
        below = "<br>".join(map(escape, self.below))
        return (
            f"<div><strong>{escape(first)}</strong><br>{lines}"
            f"{whole if self.rows else ''}<small>{below}</small></div>"
        )

    def _cell(self, head: str, cell: str) -> str:
        side = "right" if head in self.numbers else "left"
        colour = _COLOURS[JUDGEMENTS[cell].role] if cell in JUDGEMENTS else "inherit"
        return f"<td style='text-align:{side};color:{colour}'>{escape(cell)}</td>"


class Tabular:
    """Plain data that shows itself as a table."""

    __slots__ = ()

    def as_table(self) -> TextTable:
        """The table, as texts."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return self.as_table().text()

    def _repr_html_(self) -> str:
        return self.as_table().html()
