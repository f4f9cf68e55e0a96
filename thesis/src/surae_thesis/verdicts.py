"""The verdicts as Markdown: a table for each section, of which one alone may be computed again."""

from collections.abc import Iterable, Mapping

from surae_thesis.claims import CAUSES, VERDICTS, JudgedClaim
from surae_thesis.section import SECTIONS, Chapters, Result, Section

#: Heading of the page and of its Markdown.
TITLE = "The thesis’s results, computed again"
#: Before the heading of a section.
_SECTION = "\n## "


def markdown(there: Chapters, earlier: str = "") -> str:
    """All findings: a table for each section, a column for each view, reasons below.

    A section of `earlier`, a text that this function wrote, which is not `there` stays as it is.
    """
    ours = earlier.split(_SECTION) if earlier.startswith(f"# {TITLE}\n") else []
    blocks = {
        heading: block.rstrip() for heading, _, block in (part.partition("\n") for part in ours[1:])
    }
    blocks |= {_plain(section.title): _block(section, result) for section, result in there}
    order = [_plain(section.title) for section in SECTIONS]
    order = [*filter(blocks.__contains__, order), *(b for b in blocks if b not in order)]
    every = [said for heading in order for said in _said(blocks[heading])]
    verdicts = [_verdict(said) for said in every]
    total = ", ".join(f"{verdicts.count(verdict)} {verdict}" for verdict in VERDICTS)
    different = {cause: every.count(f"differs: {cause}") for cause in CAUSES}
    head = [f"# {TITLE}", "", f"Verdicts: {total}.", causes_said(different)]
    text = "\n".join([*head, *(f"{_SECTION}{name}\n{blocks[name]}" for name in order)])
    return text.rstrip() + "\n"


def judged_by(finding: JudgedClaim) -> str:
    """The thesis's sentence and, beside it, the rule that judges it."""
    return f"“{finding.says}” Holds when: {finding.rule}"


def causes_said(counted: Mapping[str, int]) -> str:
    """What a second look at the claims that differ found, in a sentence; empty where none does."""
    some = [f"{number} by {cause}" for cause, number in counted.items() if number]
    text = ", ".join(some).replace("by unexplained", "unexplained")
    return f"Of those that differ, {text}." if some else ""


def number_in(finding: JudgedClaim, name: str) -> str:
    """Our number in one view, marked where the claim holds there."""
    if name not in finding.ours:
        return "–"
    holds, text = finding.ours[name]
    return f"✓ {text}" if holds else text


def _block(section: Section, result: Result) -> str:
    """A section below its heading."""
    lines = ["", f"Thesis: {_plain(section.source)}.", ""]
    if result.made:
        lines += [f"Computed on {_plain(result.made)}.", ""]
    lines += [f"**{_plain(insight)}**\n" for insight in result.insights]
    lines += [f"{_plain(note)}\n" for note in result.notes]
    views = result.views
    heads = ["claim", "thesis", *(name or "ours" for name in views), "verdict"]
    lines += [f"| {' | '.join(map(_plain, heads))} |", "|" + "---|" * len(heads)]
    for f in result.findings:
        cells = [f"{f.statement} ({f.source})", f.number]
        cells += [number_in(f, name) for name in views]
        lines.append(f"| {' | '.join(map(_plain, cells))} | **{_plain(f.said)}** |")
    lines.append("")
    for f in result.findings:
        lines.append(f"- *{_plain(f.statement)}* {_plain(f'{judged_by(f)} {f.reason}')}")
    return "\n".join(lines)


def _said(block: str) -> Iterable[str]:
    """The verdicts in a section's table, in full."""
    rows = (line for line in block.splitlines() if line.startswith("| ") and line.endswith("** |"))
    return [row.rpartition(" | **")[2].removesuffix("** |") for row in rows]


def _verdict(said: str) -> str:
    """The verdict of one that is said in full, with its reading or cause."""
    if said in VERDICTS:
        return said
    return "differs" if said.startswith("differs") else "holds under a reading"


def _plain(text: str) -> str:
    """Text that is no markup, on one line, in a cell of a table or outside one."""
    for mark in "\\`|<[_*":
        text = text.replace(mark, f"\\{mark}")
    return " ".join(text.split())
