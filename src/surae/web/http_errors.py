"""What the workbench refuses, each with its HTTP status and one line that says what to do."""

import errno
import traceback
from pathlib import Path

from surae.errors import InputError

#: What a system says when there is no room, and what we say.
FULL = (errno.ENOSPC, errno.EDQUOT)
NO_ROOM = "the disk is full; make room and try again, what is finished is kept"


class RefusedError(InputError):
    """A request that is refused.

    Parameters
    ----------
    status : int
        HTTP status, 4xx.
    message : str
        What, where and what to do.
    """

    def __init__(self, status: int, message: str) -> None:
        super().__init__(message)
        self.status = status


def not_found(what: str) -> RefusedError:
    """There is nothing under an id."""
    return RefusedError(
        404, f"there is no such {what}; it may have been deleted, load the page again"
    )


def where(error: BaseException) -> str:
    """An error for a log: its kind and lines of code, not its text, which may name patients."""
    frames = traceback.extract_tb(error.__traceback__)
    places = [f"{'/'.join(Path(one.filename).parts[-2:])}:{one.lineno}" for one in frames[-8:]]
    return f"{type(error).__name__} at {' < '.join(reversed(places))}"


def one_line(text: object) -> str:
    """A message on one line."""
    return " ".join(str(text).split())
