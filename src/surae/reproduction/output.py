"""The folder of a reproduction: the page, its PDF, and the verdicts as CSV and Markdown."""

from collections.abc import Sequence
from pathlib import Path

from surae.files import write_atomic
from surae.reproduction.chapter import Context
from surae.reproduction.kept import Chapter, chapters, counts, csv_text
from surae.reproduction.page import page
from surae.reproduction.pdf import pdf

#: Names of what is written, beside a PDF where there is typst.
PAGE, PDF, CSV, MARKDOWN = "reproduction.html", "reproduction.pdf", "verdicts.csv", "verdicts.md"
_COLUMNS = (
    "section", "claim", "source", "text", "thesis", "ours", "verdict", "reason", "rule", "figure",
)  # fmt: skip


def write(context: Context) -> list[Path]:
    """Write the page, the verdicts, and a PDF where typst is installed.

    Returns
    -------
    list of Path
        What was written, the page first.

    Raises
    ------
    InputError
        Something cannot be written.
    """
    found = chapters(context)
    files = {PAGE: page(context, found), CSV: verdicts_csv(found), MARKDOWN: markdown(found)}
    written = []
    for name, text in files.items():
        write_atomic(context.folder / name, text)
        written.append(context.folder / name)
    printed = pdf(context, found)
    if printed is not None:
        write_atomic(context.folder / PDF, printed)
        written.append(context.folder / PDF)
    return written


def verdicts_csv(found: Sequence[Chapter]) -> str:
    """All findings as CSV."""
    rows = [
        (
            chapter.name, one.claim.name, one.claim.source, one.claim.text, one.claim.number,
            one.ours, one.verdict, one.reason, one.claim.rule, one.figure,
        )
        for chapter in found
        for one in chapter.findings
    ]  # fmt: skip
    return csv_text(_COLUMNS, rows)


def markdown(found: Sequence[Chapter]) -> str:
    """All findings as Markdown: a table for each section, reasons below it."""
    total = ", ".join(f"{number} {verdict}" for verdict, number in counts(found).items())
    lines = ["# The thesis’s results, computed again", "", f"Verdicts: {total}.", ""]
    for chapter in found:
        lines += [f"## {_plain(chapter.title)}", "", f"Thesis: {_plain(chapter.source)}.", ""]
        for note in chapter.notes:
            lines += [_plain(note), ""]
        lines += ["| claim | thesis | ours | verdict |", "|---|---|---|---|"]
        for one in chapter.findings:
            claim = f"{one.claim.text} ({one.claim.source})"
            cells = (claim, one.claim.number, one.ours or "–", f"**{one.verdict}**")
            lines.append("| " + " | ".join(_plain(cell) for cell in cells) + " |")
        told = [one for one in chapter.findings if one.reason]
        lines += ["", *(f"- *{_plain(one.claim.text)}* {_plain(one.reason)}" for one in told), ""]
    return "\n".join(lines).rstrip() + "\n"


def _plain(text: str) -> str:
    """Text that is no markup, on one line, in a cell of a table or outside one."""
    for mark in "\\`|<[_":
        text = text.replace(mark, f"\\{mark}")
    return " ".join(text.split())
