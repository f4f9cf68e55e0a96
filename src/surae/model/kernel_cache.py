"""Where compiled kernels are kept: neither trusted further than its owner, nor needed.

Numba's own cache looks only at the file of the decorated function: when a helper in another file
changes, it serves the old machine code. Our folder is therefore named by a hash of every source
that has kernels together with the versions that produced the code. Folders of other sources and
versions are removed when nobody has used them for a while.

What lies in the folder is run, so it is used only where nobody else can write; each file begins
with a digest of its name and content, and what does not agree with its digest is compiled again.
Where nothing can be written, kernels are compiled in memory, which takes longer and is said once.
"""

import hashlib
import logging
import os
import pickle
import platform
import re
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from surae.base.errors import InputError
from surae.base.working_folder import ignoring

#: Variables that numba obeys when it is loaded, and refuses to be loaded by where they are wrong.
_SETTINGS = ("NUMBA_NUM_THREADS", "NUMBA_THREADING_LAYER", "NUMBA_CPU_NAME", "NUMBA_OPT")

try:
    with ignoring(".numba_config.yaml"):
        import numba
        from numba.core.caching import IndexDataCacheFile
except (ValueError, RuntimeError) as error:
    given = ", ".join(f"{name}={os.environ[name][:20]}" for name in _SETTINGS if name in os.environ)
    raise InputError(
        f"numba, which compiles the models, refuses its settings ({given or 'none is set'}): "
        f"{error}; unset them"
    ) from None

_PACKAGE = Path(__file__).resolve().parents[1]
_KERNEL_FOLDERS = (
    "model",
    "inference",
    "inference/least_squares",
    "inference/posterior",
    "planning",
    "causal",
)
#: Numbers that kernels take from sources without kernels, and the lines that say them.
_CONSTANTS = {
    "causal/layout.py": ("DOUBT",),
    "model/crosstalk.py": ("SILENT",),
    "model/movement.py": ("GRAVITY",),
    "model/parameters.py": ("JOINT_RESTS",),
}
#: What a source that has kernels says; they may take constants from such sources and those alone.
_IMPORT = b"from surae.model.jit import "
#: So many folders are kept, and any that was used within so many days.
_KEPT = 3
_KEPT_DAYS = 2.0
_DIGEST = hashlib.sha256().digest_size
#: Bits of a folder's mode by which others could write into it.
_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
_log = logging.getLogger(__name__)


@cache
def cache_folder() -> Path | None:
    """Folder of compiled kernels, of this source, these versions and this interpreter.

    None where there is none that this user alone can write to.
    """
    digest = hashlib.sha256()
    for version in (numba.__version__, np.__version__, platform.python_version()):
        digest.update(version.encode())
    for kernels in _KERNEL_FOLDERS:
        for source in sorted((_PACKAGE / kernels).glob("*.py")):
            text = source.read_bytes()
            if _IMPORT in text or source.name == "jit.py":
                digest.update(source.name.encode() + text)
    for line in _constants():
        digest.update(line)
    name = f"kernels-{digest.hexdigest()[:16]}"
    for folder in _homes():
        with suppress(OSError):
            for each in (folder, folder / name):
                each.mkdir(mode=0o700, parents=True, exist_ok=True)
                _require_private(each)
            os.utime(folder / name)  # it is in use
            _remove_unused(folder)
            return folder / name
    return None


def _constants() -> Iterator[bytes]:
    """Lines that say the numbers kernels take from elsewhere, without their comments."""
    for source, names in _CONSTANTS.items():
        text = (_PACKAGE / source).read_bytes()
        for name in names:
            said = re.search(rb"^%s = ([^#\n]*[^#\s])" % name.encode(), text, re.MULTILINE)
            assert said is not None, f"{source} says no {name}"
            yield said[0]


def _homes() -> Iterator[Path]:
    """Folders that may hold kernels, the preferred first: the last is among temporary files."""
    base = os.environ.get("SURAE_CACHE") or os.environ.get("XDG_CACHE_HOME")
    if base:
        yield Path(base).absolute() / "surae"
    else:
        with suppress(RuntimeError):  # no home
            yield Path.home() / ".cache" / "surae"
    number = f"-{os.getuid()}" if hasattr(os, "getuid") else ""  # else each user has a folder
    yield Path(tempfile.gettempdir()) / f"surae{number}"


def _require_private(folder: Path) -> None:
    """Make sure that nobody else can put code into a folder.

    Raises
    ------
    OSError
        It is a link or another user's, its parent lets others replace it, or it can't be written.
    """
    status = folder.lstat()
    if not stat.S_ISDIR(status.st_mode):
        raise NotADirectoryError(folder)
    if hasattr(os, "getuid"):
        if status.st_uid != os.getuid():
            raise PermissionError(folder)
        if status.st_mode & 0o077:
            folder.chmod(0o700)
        if status.st_mode & _OTHERS_WRITE:  # others may have put code there while it was open
            for kernel in folder.rglob("*.nbi.*"):
                kernel.unlink()
        above = folder.parent.stat()
        if above.st_mode & _OTHERS_WRITE and not above.st_mode & stat.S_ISVTX:
            raise PermissionError(folder.parent)
    if not os.access(folder, os.W_OK):
        raise PermissionError(folder)


def _remove_unused(root: Path) -> None:
    """Remove folders of kernels that nobody has used for long, but for the last ones."""
    used = {path: path.lstat().st_mtime for path in root.glob("kernels-*") if path.is_dir()}
    oldest = time.time() - _KEPT_DAYS * 86400.0
    for path in sorted(used, key=used.__getitem__, reverse=True)[_KEPT:]:
        if used[path] < oldest and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)


#: Who is to be told when a kernel has to be compiled.
_waiting: list[Callable[[], None]] = []


@contextmanager
def on_compilation(notice: Callable[[], None]) -> Iterator[None]:
    """Call `notice` once, when and only when a kernel has to be compiled."""
    _waiting.append(notice)
    try:
        yield
    finally:
        with suppress(ValueError):
            _waiting.remove(notice)


@cache
def say_unsaved(folder: Path | None, why: str) -> None:
    """Say, once, that compiled kernels cannot be kept; what is computed is the same."""
    place = "no folder of this user's" if folder is None else f"{folder} ({why})"
    _log.warning(
        "surae: compiled code cannot be kept in %s, so every start compiles anew, some 20 s; "
        "free it, or set SURAE_CACHE to a folder of your own",
        place,
    )


class VerifiedFile(IndexDataCacheFile):
    """Machine code in a file for each signature, behind a digest of its name and content.

    Two who write numba's index mix up whose code is whose, so there is none.
    """

    def _named(self, key: object) -> str:
        whole = repr((self._source_stamp, key)).encode()  # sources of plugins name no folder
        return f"{self._index_name}.{hashlib.sha256(whole).hexdigest()[:16]}"

    def save(self, key: object, data: object) -> None:
        """Write machine code, in one go; where that fails it is said, and the code is used."""
        name = self._named(key)
        content: bytes = self._dump(data)  # type: ignore[no-untyped-call]
        path = self._data_path(name)  # type: ignore[no-untyped-call]
        try:
            with self._open_for_write(path) as file:
                file.write(_digest(name, content) + content)
        except OSError as error:
            say_unsaved(Path(path).parent, str(error.strerror).lower())

    def load(self, key: object) -> Any:
        """Read machine code; None where there is none, or none that is whole."""
        name = self._named(key)
        with suppress(OSError):
            content = Path(self._data_path(name)).read_bytes()  # type: ignore[no-untyped-call]
            if content[:_DIGEST] == _digest(name, content[_DIGEST:]):
                return pickle.loads(content[_DIGEST:])
        while _waiting:
            _waiting.pop()()
        return None


def _digest(name: str, content: bytes) -> bytes:
    return hashlib.sha256(name.encode() + b"\0" + content).digest()
