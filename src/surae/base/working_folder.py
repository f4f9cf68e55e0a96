"""The current folder holds somebody's data: settings that libraries look for there are not ours."""

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_moving = threading.Lock()


@contextmanager
def ignoring(name: str) -> Iterator[None]:
    """Import a library that obeys a file of this name as if the current folder had none.

    It is imported from our own folder. Where there is no such file nothing is moved: the current
    folder is that of all threads.
    """
    if not os.path.lexists(name):
        yield
        return
    with _moving:
        here = Path.cwd()
        os.chdir(Path(__file__).parent)
        try:
            yield
        finally:
            os.chdir(here)
