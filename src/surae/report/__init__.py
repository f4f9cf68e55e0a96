"""Reports to read, print and keep; this module imports nothing that computes."""

from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any

from surae.base.files import template
from surae.report.typeset import check_report, has_typst, typeset

#: Images that are in the page; others would be asked for elsewhere.
_IMAGE = "data:image/"

__all__ = ["check_report", "has_typst", "inert_json", "part_of", "style", "typeset"]


def style() -> str:
    """The style sheet of reports, of what stands within an element of class ``report``."""
    text = files("surae.report").joinpath("templates", "report.css").read_text(encoding="utf-8")
    text = text.replace(".live .", ".live & .")  # the class of the whole page, once plots are drawn
    page = "& { background: var(--paper); color: var(--ink); padding: .2rem; }"
    return f".report {{\n{text.replace(':root', '&')}{page}\n}}\n"


def inert_json(text: str) -> str:
    """A text of JSON in which nothing ends the script element that holds it."""
    return text.replace("<", "\\u003c")


def part_of(
    blocks: Sequence[Any],
    images: Mapping[str, str],
    signals: str = "",
    **heading: Any,  # noqa: ARG001
) -> str:
    """Blocks of a report as a part of another page, whose headings begin at the second level.

    All texts are escaped; blocks may be as they were or plain data, `images` are data URLs.
    `signals` is what ``explore.js`` draws to be zoomed into, where the page has that script; a
    `heading` is the other page's own. All of it may be a stranger's: signals are JSON that no text
    in them ends, and images those of data URLs alone.
    """
    macros: Any = template("blocks.html.j2", "surae.report").module
    inert = inert_json(str(signals))
    data = f'<script type="application/json" id="signals">{inert}</script>' if signals else ""
    drawn = {name: url for name, url in images.items() if str(url).startswith(_IMAGE)}
    return f"{macros.show_all(blocks, drawn, 2)}{data}"
