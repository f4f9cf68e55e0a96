"""The one numba decorator of surae, with an on-disk cache that cannot go stale.

Numba's own cache looks only at the file of the decorated function: when a helper in another file
changes, it serves the old machine code. Our cache folder is therefore named by a hash of every
kernel source together with the versions that produced the code.
"""

import hashlib
import os
import platform
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import numpy as np

F = TypeVar("F", bound=Callable[..., Any])

_PACKAGE = Path(__file__).resolve().parents[1]
_KERNEL_FOLDERS = ("model", "estimation")


@cache
def cache_folder() -> Path:
    """Folder of compiled kernels, of this source, these versions and this interpreter."""
    digest = hashlib.sha256()
    for version in (numba.__version__, np.__version__, platform.python_version()):
        digest.update(version.encode())
    for kernels in _KERNEL_FOLDERS:
        for source in sorted((_PACKAGE / kernels).glob("*.py")):
            digest.update(source.name.encode() + source.read_bytes())
    name = f"kernels-{digest.hexdigest()[:16]}"
    base = os.environ.get("SURAE_CACHE") or os.environ.get("XDG_CACHE_HOME")
    try:
        root = Path(base).absolute() if base else Path.home() / ".cache"
        folder = root / "surae" / name
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise PermissionError(folder)
    except (OSError, RuntimeError):  # a read-only home, or none at all
        folder = _private_folder() / name
        folder.mkdir(exist_ok=True)
    return folder


def _private_folder() -> Path:
    """Folder among the temporary files that only this user can write to: its code will be run."""
    temporary = Path(tempfile.gettempdir())
    if not hasattr(os, "getuid"):  # where users have no number, each has a temporary folder
        folder = temporary / "surae"
        folder.mkdir(exist_ok=True)
        return folder
    folder = temporary / f"surae-{os.getuid()}"
    try:
        folder.mkdir(mode=0o700)
    except FileExistsError:
        found = folder.lstat()
        private = stat.S_ISDIR(found.st_mode) and not found.st_mode & 0o022
        if found.st_uid != os.getuid() or not private:  # somebody else may have put it there
            return Path(tempfile.mkdtemp(prefix="surae-"))
    return folder


@contextmanager
def on_compilation(notice: Callable[[], None]) -> Iterator[None]:
    """Call `notice` once, when and only when a kernel has to be compiled."""
    from numba.core import event

    class Listener(event.Listener):
        """Passes on the first compilation."""

        def __init__(self) -> None:
            self.told = False

        def on_start(self, event: Any) -> None:
            del event
            if not self.told:
                self.told = True
                notice()

        def on_end(self, event: Any) -> None:
            del event

    with event.install_listener("numba:compile", Listener()):
        yield


def jit(function: F) -> F:
    """Compile `function` with numba: no GIL, IEEE arithmetic, cached on disk."""
    config: Any = numba.config
    previous = config.CACHE_DIR
    config.CACHE_DIR = str(cache_folder())  # numba reads it when it decorates
    try:
        compiled: Any = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    finally:
        config.CACHE_DIR = previous
    return cast(F, compiled)
