"""Run sections one after the other; what is finished is on the page whatever happens then."""

from collections.abc import Callable, Sequence
from pathlib import Path

from surae.errors import InputError
from surae.files import shown
from surae.reproduction.chapter import Context, Section
from surae.reproduction.kept import keep
from surae.reproduction.output import write


def make_folder(path: Path) -> None:
    """Make the output folder.

    Raises
    ------
    InputError
        It cannot be made, or cannot be written into.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        probe = path / ".surae-probe"
        probe.touch()
        probe.unlink()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"cannot write into the folder {shown(path)}: {reason.lower()}") from None


def reproduce(
    context: Context,
    chosen: Sequence[Section],
    started: Callable[[Section], None] | None = None,
) -> list[Path]:
    """Run sections and write the page after each.

    Parameters
    ----------
    context : Context
        Settings; its folder is there.
    chosen : sequence of Section
        Which; the page also shows the others that have run in the folder with these settings.
    started : callable, optional
        Told of each section before it runs.

    Returns
    -------
    list of Path
        What was written, the page first.

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
