"""Files at the border: bounded reads of regular files, atomic writes, checksums."""

import hashlib
import json
import math
import os
import re
import stat
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from surae.base.cleaning import cleaned
from surae.base.errors import InputError

if TYPE_CHECKING:
    from jinja2 import Environment, Template

#: Largest file that is read [bytes]; a 30-minute trial at 2048 Hz is about 0.4 GB of text.
MAX_BYTES = 4 * 2**30

PathLike = str | os.PathLike[str]


def paths_of(paths: PathLike | Iterable[PathLike]) -> list[PathLike]:
    """A path, or several, as a list."""
    return [paths] if isinstance(paths, str | os.PathLike) else list(paths)


def natural_order(name: str) -> list[tuple[int, str]]:
    """What names are sorted by: their words by letters, their numbers by size."""
    parts = re.findall(r"\d+|\D+", name)
    return [(int(part), "") if part.isdigit() else (-1, part) for part in parts]


def shown(path: PathLike) -> str:
    """A path as it appears in a message: always on one line."""
    return cleaned(os.fspath(path), 4096)


def sha256(data: bytes) -> str:
    """SHA-256 of `data` as 64 hexadecimal digits."""
    return hashlib.sha256(data).hexdigest()


def sha256_of(path: PathLike) -> str:
    """SHA-256 of a file, read piece by piece."""
    with Path(path).open("rb") as handle:
        return hashlib.file_digest(handle, "sha256").hexdigest()


def read_bytes(path: PathLike, limit: int = MAX_BYTES) -> bytes:
    """The content of a regular file of at most `limit` bytes; a device or a pipe is refused."""
    cannot = f"cannot read {shown(path)}"
    try:
        # Looked at before it is opened: opening a pipe waits for its other end.
        mode = Path(path).stat().st_mode
        if stat.S_ISDIR(mode):
            raise InputError(f"{cannot}: it is a folder, not a file")
        if not stat.S_ISREG(mode):
            raise InputError(f"{cannot}: it is a device or a pipe, not a regular file")
        with Path(path).open("rb") as handle:
            size = os.fstat(handle.fileno()).st_size
            if size > limit:
                raise InputError(f"{cannot}: it is larger than {limit / 2**30:g} GiB; split it")
            return handle.read(size)
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(f"{cannot}: there is no such file") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{cannot}: {_reason(error)}") from None


@contextmanager
def atomic_file(path: PathLike) -> Iterator[BinaryIO]:
    """Open `path` for writing so that it holds either all that is written, or what it held before.

    The bytes go to a temporary file in the same folder, which takes the place of `path` at the
    end. A link's target is replaced, not the link; an existing file keeps its permissions; a
    device or pipe, such as ``/dev/stdout``, is written to directly.
    """
    cannot = f"cannot write {shown(path)}"
    if "\0" in os.fspath(path):
        raise InputError(f"{cannot}: its name holds a zero byte")
    try:
        mode = Path(path).stat().st_mode if Path(path).exists() else None
        if mode is not None and stat.S_ISDIR(mode):
            raise InputError(f"{cannot}: it is a folder, not a file")
        if mode is not None and not stat.S_ISREG(mode):
            with Path(path).open("wb") as handle:
                yield handle
            return
        if mode is not None and not os.access(path, os.W_OK):
            raise InputError(f"{cannot}: it is write-protected")
        target = Path(os.path.realpath(path))
        temporary = target.with_name(f".surae-{os.urandom(8).hex()}.part")
        try:
            with temporary.open("xb") as handle:
                yield handle
                handle.flush()
                _sync(handle.fileno())
            if mode is not None:
                temporary.chmod(stat.S_IMODE(mode))
            temporary.replace(target)
            _sync_folder(target.parent)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise
    except OSError as error:
        raise InputError(f"{cannot}: {_reason(error)}") from None


def _sync(descriptor: int) -> None:
    """Have the system put a file on its disk; macOS does so only when it is asked twice."""
    try:
        import fcntl

        fcntl.fcntl(descriptor, getattr(fcntl, "F_FULLFSYNC"))  # noqa: B009, only macOS has it
    except (ImportError, AttributeError, OSError):  # another system, or a disk elsewhere
        os.fsync(descriptor)


def _sync_folder(folder: Path) -> None:
    """Have a new name outlive a power cut too, where a folder can be opened."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def write_atomic(path: PathLike, data: bytes | str) -> None:
    """Write `data` (text as UTF-8) to `path`, all of it or nothing; see `atomic_file`."""
    with atomic_file(path) as handle:
        handle.write(data.encode() if isinstance(data, str) else data)


def write_json(path: PathLike, data: Mapping[str, Any]) -> None:
    """Write plain data as indented JSON, all of it or nothing; only finite numbers are allowed."""
    write_atomic(path, json.dumps(data, indent=1, allow_nan=False, ensure_ascii=False) + "\n")


def is_link(path: Path) -> bool:
    """Whether a path leads elsewhere: a symbolic link, or a junction of Windows."""
    return path.is_symlink() or bool(getattr(os.path, "isjunction", lambda _: False)(path))


#: Where a spreadsheet may see the start of a formula: also behind what it may take for the end of
#: a cell, and with the wide signs that some of them take for the narrow ones.
_FORMULA = re.compile(r"(^|[;,|\t\r\n])(\s*)(?=[=+\-@\uff1d\uff0b\uff0d\uff20]|[\t\r])")


def csv_row(cells: Iterable[object]) -> str:
    """A line of a CSV table: numbers read back as they were, texts run nothing.

    A text that a spreadsheet would take for a formula gets an apostrophe before it, and every text
    that is not plain stands in quotes. None and numbers that are not finite are empty cells.
    """
    return ",".join(map(_csv_cell, cells)) + "\n"


def _csv_cell(cell: object) -> str:
    if cell is None or (isinstance(cell, float) and not math.isfinite(cell)):
        return ""
    if isinstance(cell, bool | int | float):
        return repr(float(cell)) if isinstance(cell, float) else str(cell)
    text = _FORMULA.sub(r"\1\2'", str(cell))
    if re.search(r"[\s,;|\"']", text):
        return '"' + text.replace('"', '""') + '"'
    return text


def write_table(
    path: PathLike, names: Sequence[str], rows: Sequence[Mapping[str, str | float | None]]
) -> None:
    """Write rows as CSV, numbers without loss; a missing one is an empty cell."""
    with atomic_file(path) as handle:
        handle.write(csv_row(names).encode())
        handle.writelines(csv_row(row.get(name) for name in names).encode() for row in rows)


def require_writable(path: PathLike) -> None:
    """Refuse a path that `write_atomic` could not write to, without touching what it holds."""
    cannot = f"cannot write {shown(path)}"
    try:
        target = Path(os.path.realpath(path))
        if not os.fspath(path):
            raise InputError("cannot write a file without a name")
        if target.is_dir():
            raise InputError(f"{cannot}: it is a folder, not a file")
        if not target.parent.is_dir():
            raise InputError(f"{cannot}: there is no folder {shown(target.parent)}; make it first")
        if not os.access(target if target.exists() else target.parent, os.W_OK):
            raise InputError(f"{cannot}: it is write-protected")
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(f"{cannot}: {_reason(error)}") from None


def make_folder(folder: PathLike) -> Path:
    """The folder, made where it is missing."""
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise InputError(f"cannot make the folder {shown(folder)}: {_reason(error)}") from None
    return Path(folder)


def _reason(error: OSError | ValueError) -> str:
    """The system's reason for `error`, in lower case, without the path."""
    text = (error.strerror if isinstance(error, OSError) else None) or str(error)
    return text[:1].lower() + text[1:]


def template(name: str, *packages: str) -> "Template":
    """A page's template, of the first package that has it; what it is filled with is escaped."""
    return _templates(packages).get_template(name)


@cache
def _templates(packages: tuple[str, ...]) -> "Environment":
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=ChoiceLoader(list(map(PackageLoader, packages))),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
