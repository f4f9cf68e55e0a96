"""The reproduction as PDF, set by typst where it is installed."""

from collections.abc import Sequence
from dataclasses import asdict
from importlib.resources import files

from surae._version import __version__
from surae.report.typeset import has_typst, typeset
from surae.reproduction.chapter import Context
from surae.reproduction.kept import Chapter, counts
from surae.reproduction.page import cell_text


def pdf(context: Context, chapters: Sequence[Chapter]) -> bytes | None:
    """The sections as PDF; None where typst is not installed (``surae[pdf]``).

    Texts reach typst as data, never as markup.

    Raises
    ------
    ComputationError
        Typst cannot set it.
    """
    if not has_typst():
        return None
    content = {
        "version": __version__,
        "seed": context.seed,
        "quick": context.quick,
        "counts": counts(chapters),
        "chapters": [
            asdict(chapter)
            | {
                "tables": [
                    asdict(table) | {"rows": [[cell_text(cell) for cell in r] for r in table.rows]}
                    for table in chapter.tables
                ]
            }
            for chapter in chapters
        ],
    }
    template = files("surae.reproduction").joinpath("templates", "reproduction.typ").read_bytes()
    return typeset(template, context.folder.resolve(), content)
