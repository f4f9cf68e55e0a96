"""Where entries lie in a project's folder, and what may not lie there."""

import os
import re
import stat
from contextlib import suppress
from pathlib import Path

from surae.base.errors import InputError
from surae.base.files import is_link, shown
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.rows import ID

DATABASE = "project.db"
#: Folders of entries.
FOLDERS = ("recordings", "fits", "sessions", "studies", "uploads", "trash")
#: Where the file of an entry lies.
FILES = {
    "recording": ("recordings", ".h5"),
    "fit": ("fits", ".json"),
    "session": ("sessions", ".json"),
    "study": ("studies", ".db"),
}
#: What we put beside the folders, and nobody else does.
_OURS = {DATABASE, *(f"{DATABASE}-{end}" for end in ("wal", "shm", "journal")), f"{DATABASE}.lock"}
#: Folders within each other; ours are three at most.
_DEEPEST = 8
_KEY = re.compile(r"[0-9a-f]{32,64}")


def plural(kind: str) -> str:
    """What browsers call the list of a kind of entries."""
    return FILES[kind][0] if kind in FILES else f"{kind}s"


def refuse_foreign(folder: Path, where: str) -> None:
    """Refuse a folder of somebody's own files, and links anywhere in a project."""
    if not folder.exists():
        return
    cannot = f"cannot use {where} as a project"
    database = folder / DATABASE
    begun = database.is_symlink() or (database.exists() and database.lstat().st_size > 0)
    top = list(folder.iterdir())
    strange = [path for path in top if path.name not in _OURS and not _is_empty_folder(path)]
    if strange and not begun:
        raise InputError(
            f"{where} holds files ({shown(strange[0].name)[:60]}) but no project; begin one in a "
            f"folder of its own: surae serve {shown(Path(where) / 'surae-project')}"
        )
    for path in top:
        _refuse_link(cannot, path, folder)
        if path.name in _OURS:
            state = path.lstat()
            if not stat.S_ISREG(state.st_mode) or state.st_nlink > 1:
                raise InputError(
                    f"{cannot}: its {path.name} is no file of its own, others share it; copy the "
                    "folder, and open the copy"
                )
        elif path.name in FOLDERS:
            if not path.is_dir():
                raise InputError(f"{cannot}: its {path.name} is no folder; move it away")
            _refuse_within(cannot, path, folder)


def _refuse_within(cannot: str, path: Path, folder: Path) -> None:
    """Refuse what none of our folders holds: links, pipes, devices, and folders without end."""
    for at, folders, files in os.walk(path):
        for name in (*folders, *files):
            inner = Path(at, name)
            _refuse_link(cannot, inner, folder)
            what = shown(inner.relative_to(folder))[:80]
            if name in files and not inner.is_file():
                raise InputError(f"{cannot}: its {what} is a pipe or a device; move it away")
            if len(inner.relative_to(folder).parts) > _DEEPEST:
                raise InputError(f"{cannot}: its {what} lies too deep; move it away")


def _refuse_link(cannot: str, path: Path, folder: Path) -> None:
    if is_link(path):
        name = shown(path.relative_to(folder))[:80]
        raise InputError(
            f"{cannot}: its {name} is a link, which leads out of it; put the file itself there"
        )


def _is_empty_folder(path: Path) -> bool:
    """Whether it is one of ours that was made just before a kill."""
    return path.name in FOLDERS and path.is_dir() and not is_link(path) and not any(path.iterdir())


def new_private(path: Path) -> None:
    """Make a file for its owner alone, where there is none."""
    with suppress(FileExistsError):
        flags = os.O_CREAT | os.O_EXCL | os.O_RDWR | getattr(os, "O_NOFOLLOW", 0)
        os.close(os.open(path, flags, 0o600))


def uploads_of(root: Path, session: object) -> Path:
    """The folder of a session's uploads."""
    return _own(root / "uploads" / _checked(session, _KEY)[:32])


def file_of(root: Path, folder: str, id_: str, suffix: str) -> Path:
    """The file of an entry in a project's folder."""
    return _own(root / folder / f"{_checked(id_, ID)}{suffix}")


def _own(path: Path) -> Path:
    """A path that leads nowhere else, also since the project was opened."""
    if is_link(path) or is_link(path.parent):
        name = f"{path.parent.name}/{path.name}"
        raise RefusedError(409, f"{name} is a link; put the file or folder itself there")
    return path


def _checked(text: object, form: "re.Pattern[str]") -> str:
    """A name that is made of our own digits."""
    if not isinstance(text, str) or not form.fullmatch(text):
        raise RefusedError(409, f"{shown(str(text))[:40]} is no id; the project is damaged")
    return text


def recording_suffix(version: int) -> str:
    """How the file of a recording ends: 0 is what was imported, each description has its own."""
    return f".v{version}.h5" if version else ".h5"
