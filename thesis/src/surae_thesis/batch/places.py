"""Where fits of a batch are kept: a folder, or a place that fsspec opens, as ``s3://bucket/fits``."""

from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from surae.base.errors import InputError
from surae.base.files import make_folder, shown

#: Where a fit is kept: the place, and the name in it.
Kept = Sequence[str]


def is_remote(place: str) -> bool:
    """Whether a place is a URL and no folder of this machine."""
    return "://" in place


def check_place(place: str) -> str:
    """The place, its folder made; a folder is named from the root, for workers are elsewhere.

    Raises
    ------
    InputError
        It can be neither made nor opened.
    """
    if not is_remote(place):
        return str(make_folder(place).resolve())
    files, root = _opened(place)
    try:
        files.makedirs(root, exist_ok=True)
    except Exception as error:  # whatever a driver raises
        raise InputError(f"cannot keep fits in {shown(place)}: {error}") from None
    return place.rstrip("/")


def keep(kept: Kept, write: Callable[[Path], None]) -> str:
    """Have one file written, and put it in its place when it is whole; where it is.

    Raises
    ------
    InputError
        It cannot be written.
    """
    place, name = kept
    if not is_remote(place):
        path = Path(place, name)
        make_folder(path.parent)
        write(path)  # writers of surae put a whole file in place of another
        return str(path)
    with TemporaryDirectory(prefix="surae-") as folder:
        path = Path(folder, Path(name).name)
        write(path)
        return _sent(path, place, name)


def keep_folder(kept: Kept, fill: Callable[[Path], None]) -> str:
    """Have a folder filled that goes on where it was, and put it in a place; where it is.

    In a place elsewhere it is there when it is whole: what ends in between begins anew.
    """
    place, name = kept
    if not is_remote(place):
        path = make_folder(Path(place, name))
        fill(path)
        return str(path)
    with TemporaryDirectory(prefix="surae-") as folder:
        root = Path(folder, "session")
        root.mkdir()
        fill(root)
        for path in sorted(p for p in root.rglob("*") if p.is_file()):
            _sent(path, place, f"{name}/{path.relative_to(root).as_posix()}")
    return f"{place}/{name}"


def _sent(path: Path, place: str, name: str) -> str:
    files, root = _opened(place)
    target = f"{root.rstrip('/')}/{name}"
    try:
        files.makedirs(target.rpartition("/")[0], exist_ok=True)
        files.put_file(str(path), target)
    except Exception as error:  # whatever a driver raises
        raise InputError(f"cannot keep {shown(name)} in {shown(place)}: {error}") from None
    return f"{place}/{name}"


def _opened(place: str) -> tuple[Any, str]:
    """The file system of a URL, and the path in it."""
    try:
        import fsspec
    except ImportError:
        raise InputError(
            f"{shown(place)}: a URL needs fsspec; install it with `pip install fsspec`"
        ) from None
    try:
        files, root = fsspec.core.url_to_fs(place)
    except (ImportError, ValueError, OSError) as error:  # a driver that is not there says so
        raise InputError(f"cannot open {shown(place)}: {error}") from None
    return files, str(root)
