"""Errors as a program and its children tell them: in one line, or as lines of code."""

import errno
import traceback
from pathlib import Path

#: What a system says when there is no room, and what we say.
FULL = (errno.ENOSPC, errno.EDQUOT)
NO_ROOM = "the disk is full; make room and try again, what is finished is kept"


def where(error: BaseException) -> str:
    """An error for a log: its kind and lines of code, not its text, which may name patients."""
    frames = traceback.extract_tb(error.__traceback__)
    places = [f"{'/'.join(Path(frame.filename).parts[-2:])}:{frame.lineno}" for frame in frames]
    return f"{type(error).__name__} at {' < '.join(reversed(places[-8:]))}"


def one_line(text: object) -> str:
    """A message on one line."""
    return " ".join(str(text).split())
