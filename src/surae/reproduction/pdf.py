"""The reproduction as PDF, set by typst where it is installed."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict
from importlib.resources import files

from surae._version import __version__
from surae.errors import ComputationError
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
    try:
        import typst
    except ImportError:
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
    # Its types want source and root to be the same kind of thing: here bytes and a path.
    compiled: Callable[..., object] = typst.compile
    try:
        printed = compiled(
            template,
            root=str(context.folder.resolve()),
            sys_inputs={"content": json.dumps(content)},
        )
    except Exception as error:  # typst's own errors have no common type in all of its versions
        text = " ".join(str(error).split())
        raise ComputationError(f"typst could not set the PDF: {text}") from error
    return printed if isinstance(printed, bytes) else None
