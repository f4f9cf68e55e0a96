"""The numbers of a text table without what programs write between and below them."""

import csv
import re
from collections.abc import Callable
from dataclasses import dataclass, replace

from surae.recording.headings import TableHeading, numeric
from surae.recording.rows import is_clock, split
from surae.recording.source import Source
from surae.recording.table import some

#: So much of a file's end is looked at, and so many lines there may be no numbers.
_TAIL = 2**16
_MOST = 100
_NO_NUMBERS = ("", "nan", "na", "n/a", "null", "none", "inf", "-inf")
_QUOTED_COMMA = re.compile(rb'"([+-]?\d*),(\d+(?:[eE][+-]?\d+)?)"')
_POINT = re.compile(rb'(?:^|,|")[ "]*[+-]?\d*\.\d', re.MULTILINE)
_END = b"\x1a"
_LINE = re.compile(rb"[^\r\n]*(?:\r\n|\r|\n|$)")


@dataclass(frozen=True, slots=True)
class Body:
    """A text with its numbers alone below the heading; its rows keep their places."""

    source: Source
    remark: str = ""  #: What was left out or read otherwise.


def body_of(source: Source, head: TableHeading) -> Body:
    """The text without lines below its numbers, and without headings that are repeated."""
    remarks = []
    commas = head.delimiter == "," and _QUOTED_COMMA.search(source.data)
    if commas and not _POINT.search(source.data):
        source = replace(source, data=_QUOTED_COMMA.sub(rb'"\1.\2"', source.data))
        remarks.append("quoted numbers have decimal commas")
    if source.data.endswith(_END):  # what DOS writes at a file's end
        source = replace(source, data=source.data.rstrip(_END))
    source, again = _without_headings(source, head)
    if again:
        times = "once" if again == 1 else f"{again} times"
        remarks.append(f"the names of the columns are repeated {times}")
    source, said = _without_end(source, head)
    return Body(source, "; ".join(filter(None, (*remarks, said))))


def _is_row(head: TableHeading) -> Callable[[str], bool]:
    """Whether a line is one of the numbers: by the count of its cells, and a number first."""
    count = len(head.names)

    def whole(line: str) -> bool:
        try:
            cells = split(line, head.delimiter)
        except csv.Error:
            return False
        if len(cells) == count + 1 and not cells[-1]:
            cells = cells[:-1]
        if len(cells) != count:
            return False
        pointed = [cell if head.delimiter == "," else cell.replace(",", ".") for cell in cells]
        return any(map(numeric, pointed)) or any(map(is_clock, cells))

    return whole


def _without_end(source: Source, head: TableHeading) -> tuple[Source, str]:
    """The text up to its last row of numbers, and what stands below it."""
    begin = max(len(source.data) - _TAIL, 0)
    tail = source.data[begin:]
    lines = [match for match in _LINE.finditer(tail) if match.end() > match.start()]
    whole = _is_row(head)
    texts = [match[0].decode(errors="replace").strip("\r\n") for match in lines]
    last = len(texts) - 1
    below: list[int] = []
    first_cell = _first_is_number(head, texts)
    while last >= 0 and len(below) < _MOST:
        text = texts[last]
        if text.strip() and not text.lstrip().startswith("#"):
            number = whole(text) and (not first_cell or _number_first(text, head))
            if number and not _is_void(text, head):
                break
            below.append(last)
        last -= 1
    if not below or last < 0 or len(below) == _MOST or not _mostly_rows(texts, last, whole):
        return source, ""
    cut = replace(source, data=source.data[: begin + lines[last].end()])
    row = cut.data.count(b"\n") + 1 if b"\n" in cut.data else cut.data.count(b"\r") + 1
    alone = below == [len(texts) - 1] and not tail.endswith((b"\n", b"\r"))
    if alone and _is_part(texts[-1], head):
        return cut, f"row {row} is incomplete and left out: the file was cut short"
    if not any(text.strip(f' "{head.delimiter or ""}') for text in (texts[k] for k in below)):
        return cut, f"from row {row} on all cells are blank"
    shown = some([texts[k].strip() for k in reversed(below)], 2)
    return cut, f"from row {row} on no numbers: {shown} is not read"


def _mostly_rows(texts: list[str], last: int, whole: Callable[[str], bool]) -> bool:
    """Whether what stands above the end is numbers, so that the end is what differs."""
    above = [t for t in texts[max(last - 20, 1) : last] if t.strip() and not t.startswith("#")]
    return len(above) < 1 or sum(map(whole, above)) > len(above) / 2


def _first_is_number(head: TableHeading, texts: list[str]) -> bool:
    """Whether rows begin with a number or a time of day, as most do."""
    few = [text for text in texts[1:-1] if text.strip()][:20]
    return sum(_number_first(text, head) for text in few) > len(few) / 2


def _number_first(text: str, head: TableHeading) -> bool:
    try:
        cell = split(text, head.delimiter)[0]
    except (csv.Error, IndexError):
        return False
    return numeric(cell if head.delimiter == "," else cell.replace(",", ".")) or is_clock(cell)


def _is_void(text: str, head: TableHeading) -> bool:
    """Whether none of a row's cells holds a number: all are blank or say that they do not."""
    try:
        cells = split(text, head.delimiter)
    except csv.Error:
        return False
    return all(cell.casefold() in _NO_NUMBERS for cell in cells)


def _is_part(text: str, head: TableHeading) -> bool:
    """Whether a line is the beginning of a row of numbers."""
    try:
        cells = split(text, head.delimiter)
    except csv.Error:
        return True
    return len(cells) < len(head.names) and all(
        numeric(c.replace(",", ".")) or is_clock(c) for c in cells[:-1]
    )


def _without_headings(source: Source, head: TableHeading) -> tuple[Source, int]:
    """The text without its heading where it comes again, each line left as a comment.

    What stands right above a heading that comes again, of another number of cells, goes with it.
    """
    lines = _LINE.findall(source.data)
    if head.row > len(lines):
        return source, 0
    heading = lines[head.row - 1].strip()
    if not heading or source.data.count(heading) < 2:
        return source, 0
    whole = _is_row(head)
    again = 0
    for at in range(head.row, len(lines)):
        if lines[at].strip() != heading:
            continue
        again += 1
        above = at
        while above >= head.row and not whole(lines[above].decode(errors="replace").strip()):
            lines[above] = b"#" + lines[above]
            above -= 1
        below = at + 1
        while (
            below < len(lines)
            and lines[below].strip()
            and not whole(lines[below].decode(errors="replace").strip())
        ):
            lines[below] = b"#" + lines[below]
            below += 1
    return (replace(source, data=b"".join(lines)), again) if again else (source, 0)
