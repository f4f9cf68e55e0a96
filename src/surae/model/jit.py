"""The one numba decorator of surae, with an on-disk cache that cannot go stale.

Numba's own cache looks only at the file of the decorated function: when a helper in another file
changes, it serves the old machine code. Our cache folder is therefore named by a hash of every
kernel source together with the versions that produced the code.
"""

import hashlib
import os
import platform
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

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
    for folder in _KERNEL_FOLDERS:
        for source in sorted((_PACKAGE / folder).glob("*.py")):
            digest.update(source.name.encode() + source.read_bytes())
    base = os.environ.get("SURAE_CACHE") or os.environ.get("XDG_CACHE_HOME")
    root = Path(base) if base else Path.home() / ".cache"
    folder = root / "surae" / f"kernels-{digest.hexdigest()[:16]}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise PermissionError(folder)
    except OSError:  # a read-only home: compile into a folder of this user's own
        folder = Path(tempfile.gettempdir()) / f"surae-{os.getuid()}" / folder.name
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    return folder


def is_warm() -> bool:
    """Whether compiled kernels are there, so that nothing has to be compiled first."""
    return any(cache_folder().rglob("*.nbi"))


def jit(function: F) -> F:
    """Compile `function` with numba: no GIL, IEEE arithmetic, cached on disk."""
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(cache_folder())  # numba reads it when it decorates
    try:
        compiled: F = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    finally:
        numba.config.CACHE_DIR = previous
    return compiled
