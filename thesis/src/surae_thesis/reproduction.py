"""Run sections one after the other; the page shows what is finished."""

from collections.abc import Callable, Sequence
from pathlib import Path

from surae_thesis.section import Context, Section, keep
from surae_thesis.writers import write


def reproduce(
    context: Context,
    chosen: Sequence[Section],
    started: Callable[[Section], None] | None = None,
) -> list[Path]:
    """Run sections and write the page after each, so that what is finished is there.

    The page also shows the others that have run in the folder with these settings. `started` is
    told of each section before it runs. What was written is returned, the page first.

    Raises
    ------
    InputError, ComputationError
        A section cannot go on, or something cannot be written; what is finished is kept.
    """
    written: list[Path] = []
    for section in chosen:
        if started is not None:
            started(section)
        keep(context, section, section.run(context))
        written = write(context)
    return written
