"""A report as plain blocks, which the page and the paper show alike: nothing is worded twice.

Each block names its `kind`, by which ``page.html.j2`` and ``paper.typ`` know how to show it.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

__all__ = [
    "AdequacyWords",
    "AnyCell",
    "Block",
    "Cell",
    "Document",
    "Explorer",
    "Facts",
    "Grid",
    "Group",
    "Heading",
    "IntervalBar",
    "KeyFigures",
    "Picture",
    "Points",
    "Row",
    "Section",
    "Text",
    "columns",
    "facts",
    "paragraphs",
    "rows",
    "verdict",
]


@dataclass(frozen=True, slots=True)
class IntervalBar:
    """An estimate and its interval between the bounds, as parts from 0 to 1."""

    value: float  #: The estimate.
    #: `low`, `high`: ends of the interval, cut off at the bounds; None without an interval.
    low: float | None
    high: float | None
    #: `beyond_low`, `beyond_high`: whether the interval was cut off at that end.
    beyond_low: bool
    beyond_high: bool
    #: Lower end, median and upper end of the prior, cut off at the bounds.
    prior: tuple[float, float, float] | None
    alt: str  #: The bar in words.


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell of a table: its text and what stands with it; empty where there is nothing."""

    text: str = ""
    under: str = ""  #: A smaller line below.
    kind: str = ""  #: How the text is shown: a verdict, a grade, ``own``, ``code``.
    #: Class and word of a badge before the text, such as ``("verdict weak", "weak")``.
    badge: tuple[str, str] | None = None
    link: str = ""  #: The section that the badge leads to.
    why: str = ""  #: Words behind the text.
    meaning: str = ""  #: What a name stands for.
    bar: IntervalBar | None = None  #: An interval, drawn before all else.
    pairs: tuple[tuple[str, str], ...] = ()  #: Names, each with its value.


@dataclass(frozen=True, slots=True)
class Heading:
    """The heading of a column, and how its cells are shown."""

    head: str
    look: str = ""  #: Classes of the style sheet; numbers stand at the right.
    wide: bool = False  #: Whether it takes what others leave, on paper.


AnyCell: TypeAlias = str | Cell
Row: TypeAlias = Sequence[AnyCell]
#: Rows of a table under their title.
Group: TypeAlias = tuple[str, tuple[Row, ...]]


@dataclass(frozen=True, slots=True)
class Grid:
    """A table; the first cell of each row is its heading."""

    caption: str
    columns: tuple[Heading, ...]
    #: Rows by the title that stands above them, empty where there is but one group; the only cell
    #: of a row spans all columns.
    groups: tuple[Group, ...]
    look: str = ""  #: Classes of the style sheet.
    titled: bool = False  #: Whether the caption is shown to those who see.
    repeated: int = 0  #: First columns that stand again where a wide table goes on below, on paper.
    kind: str = field(default="table", init=False)


@dataclass(frozen=True, slots=True)
class Text:
    """Text: plain, a ``note``, a ``warning``, ``say`` (an answer), ``choose`` (on screen alone)."""

    text: str
    look: str = ""
    lead: str = ""  #: Bold words before it.
    kind: str = field(default="paragraph", init=False)


@dataclass(frozen=True, slots=True)
class Points:
    """A list of sentences under a title, which links may lead to by `anchor`."""

    title: str
    texts: tuple[str, ...]
    anchor: str = ""
    links: tuple[str, ...] = ()  #: The sections that the texts lead to, where they do.
    kind: str = field(default="points", init=False)


@dataclass(frozen=True, slots=True)
class Facts:
    """Labels and what they say: side by side, or as ``settings`` below each other."""

    facts: tuple[tuple[str, tuple[str, ...]], ...]  #: Label, and one text or several.
    look: str = "facts"
    kind: str = field(default="facts", init=False)


@dataclass(frozen=True, slots=True)
class KeyFigures:
    """The few numbers to see first: label, value, and how to read it."""

    figures: tuple[tuple[str, str, str], ...]
    kind: str = field(default="key", init=False)


@dataclass(frozen=True, slots=True)
class AdequacyWords:
    """The grade of a fit in words: its mark, one sentence, and the reasons for it."""

    grade: str
    mark: str
    sentence: str
    reasons: tuple[str, ...]
    kind: str = field(default="judged", init=False)


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure of the report, by its name; left out where it was not drawn.

    `look` has the style sheet's classes; on paper it stays ``here``, or goes where there is room.
    """

    name: str
    alt: str
    caption: str = ""
    look: str = ""
    width: int = 92  #: On paper, in per cent of the text's.
    kind: str = field(default="picture", init=False)


@dataclass(frozen=True, slots=True)
class Explorer:
    """The signals of the recording of this number, to zoom into; on paper there is nothing."""

    number: int
    label: str
    note: str = ""
    summary: str = ""  #: What a reader opens to see them; empty where they lie open.
    kind: str = field(default="signals", init=False)


@dataclass(frozen=True, slots=True)
class Section:
    """Blocks under a heading; `look` has the style sheet's classes, ``page`` begins a new one."""

    title: str
    blocks: "tuple[Block, ...]"
    anchor: str = ""
    look: str = ""
    kind: str = field(default="section", init=False)


Block: TypeAlias = (
    Grid | Text | Points | Facts | KeyFigures | AdequacyWords | Picture | Explorer | Section
)


@dataclass(frozen=True, slots=True)
class Document:
    """A whole report."""

    kicker: str  #: The line above the heading.
    heading: str  #: Whose report it is.
    under: str  #: The line below the heading.
    title: str  #: The window's, or the file's.
    blocks: tuple[Block, ...]
    footer: str = ""
    language: str = "en"


def columns(
    *heads: str,
    numbers: Collection[int] = (),
    wide: Collection[int] = (),
    looks: Mapping[int, str] | None = None,
) -> tuple[Heading, ...]:
    """Columns of these headings; by place, which hold numbers, are wide, or have other looks."""
    return tuple(
        Heading(head, (looks or {}).get(k, "number" if k in numbers else ""), k in wide)
        for k, head in enumerate(heads)
    )


def rows(rows: Iterable[Row]) -> tuple[Group]:
    """The rows of a table that is not grouped."""
    return (("", tuple(map(tuple, rows))),)


def facts(facts: Iterable[tuple[str, str]], look: str = "facts") -> Facts:
    """Facts of one text each."""
    return Facts(tuple((label, (text,)) for label, text in facts), look)


def paragraphs(texts: Iterable[str], look: str = "") -> tuple[Text, ...]:
    """A paragraph of each text."""
    return tuple(Text(text, look) for text in texts)


def verdict(name: str, *, why: str = "", link: str = "") -> Cell:
    """A verdict as a badge, with the reason behind it."""
    return Cell(badge=(f"verdict {name}", name.replace("-", " ")), why=why, link=link)
