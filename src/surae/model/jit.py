"""The one numba decorator of surae, with an on-disk cache that cannot go stale.

Numba's own cache looks only at the file of the decorated function: when a helper in another file
changes, it serves the old machine code. Our cache folder is therefore named by a hash of every
source that has kernels together with the versions that produced the code. Folders of other sources
and versions are removed when nobody has used them for a while.
"""

import hashlib
import os
import platform
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager, suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np

from surae.base.working_folder import ignoring

with ignoring(".numba_config.yaml"):
    import numba
    from numba.core.caching import IndexDataCacheFile
vars(numba.config)["_config_fname"] = ""  # looked for again at every compilation

F = TypeVar("F", bound=Callable[..., Any])

_PACKAGE = Path(__file__).resolve().parents[1]
_KERNEL_FOLDERS = (
    "model",
    "inference",
    "inference/least_squares",
    "inference/posterior",
    "protocol/planning",
)
#: What a source that has kernels says; they may take constants from such sources only.
_IMPORT = b"from surae.model.jit import "
#: So many folders are kept, and any that was used within so many days.
_KEPT = 3
_KEPT_DAYS = 2.0


@cache
def cache_folder() -> Path:
    """Folder of compiled kernels, of this source, these versions and this interpreter."""
    digest = hashlib.sha256()
    for version in (numba.__version__, np.__version__, platform.python_version()):
        digest.update(version.encode())
    for kernels in _KERNEL_FOLDERS:
        for source in sorted((_PACKAGE / kernels).glob("*.py")):
            text = source.read_bytes()
            if _IMPORT in text or source.name == "jit.py":
                digest.update(source.name.encode() + text)
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
    with suppress(OSError):
        os.utime(folder)  # it is in use
        _remove_unused(folder.parent)
    return folder


def _remove_unused(root: Path) -> None:
    """Remove folders of kernels that nobody has used for long, but for the last ones."""
    used = {path: path.lstat().st_mtime for path in root.glob("kernels-*") if path.is_dir()}
    oldest = time.time() - _KEPT_DAYS * 86400.0
    for path in sorted(used, key=used.__getitem__, reverse=True)[_KEPT:]:
        if used[path] < oldest and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)


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
        status = folder.lstat()
        private = stat.S_ISDIR(status.st_mode) and not status.st_mode & 0o022
        if status.st_uid != os.getuid() or not private:  # somebody else may have put it there
            return Path(tempfile.mkdtemp(prefix="surae-"))
    return folder


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
def compile_all() -> None:
    """Compile what a fit needs, half of it in a child at the same time, once for a cache folder."""
    done = cache_folder() / "all"
    if done.exists():
        return
    from surae.processes import Child

    with ThreadPoolExecutor(1) as pool, closing(Child(calls=1)) as child:
        other = pool.submit(child.call, f"{__name__}:compile_half", {"half": 1})
        compile_half(0)
        other.exception()  # what a child that failed left is compiled where it is needed
    done.touch()


def compile_half(half: int) -> None:
    """Compile, or load, kernels that Python calls in a fit: one half of `kernels.txt`.

    It names what each takes: real numbers and integers, in arrays of so many dimensions, and tuples
    of such.
    """
    text = Path(__file__).with_name("kernels.txt").read_text(encoding="utf-8")
    for line in text.split("\n\n")[half].splitlines():
        name, *given = line.split()
        module, kernel = name.split(":")
        types = tuple(map(_type_of, given))
        getattr(import_module(f"surae.{module}"), kernel).compile(types)


def _type_of(word: str) -> Any:
    """Numba's type by its word: f or i, then dimensions; in parentheses a tuple of them."""
    types: Any = numba.types
    if word.startswith("("):
        return types.Tuple(tuple(map(_type_of, word[1:-1].split(","))))
    kind = {"f": numba.float64, "i": numba.int64}[word[0]]
    return types.Array(kind, int(word[1:]), "C") if word[1:] else kind


class _OneFileEach(IndexDataCacheFile):
    """Machine code in a file for each signature: two who write numba's index mix them up."""

    def _named(self, key: object) -> str:
        whole = repr((self._source_stamp, key)).encode()  # sources of plugins name no folder
        return f"{self._index_name}.{hashlib.sha256(whole).hexdigest()[:16]}"

    def save(self, key: object, data: object) -> None:
        """Write machine code, in one go."""
        self._save_data(self._named(key), data)  # type: ignore[no-untyped-call]

    def load(self, key: object) -> Any:
        """Read machine code; None where there is none."""
        with suppress(OSError):
            return self._load_data(self._named(key))  # type: ignore[no-untyped-call]
        while _waiting:
            _waiting.pop()()
        return None


def inner(function: F) -> F:
    """As `jit`, of what kernels alone call: not to be called by Python spares its wrapper."""
    return jit(function, no_cpython_wrapper=True)


def jit(function: F, **more: Any) -> F:
    """Compile `function` with numba: no GIL, IEEE arithmetic but for `more`, cached on disk."""
    config: Any = numba.config
    previous = config.CACHE_DIR
    config.CACHE_DIR = str(cache_folder())  # numba reads it when it decorates
    try:
        # Nobody calls them by address: to allow for that is a tenth of their compilation.
        options: Any = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True, **more}
        compiled: Any = numba.njit(cache=True, **options)(function)
        with suppress(AttributeError):  # a later numba's own file serves too
            compiled._cache._cache_file.__class__ = _OneFileEach
    finally:
        config.CACHE_DIR = previous
    return cast(F, compiled)
