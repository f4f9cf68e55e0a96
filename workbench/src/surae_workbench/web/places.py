"""Where entries lie in a project's folder, and what may not lie there."""

import os
import re
import stat
from contextlib import suppress
from pathlib import Path

from surae.errors import InputError
from surae.files import is_link, shown
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


def plural(kind: str) -> str:
    """What browsers call the list of a kind of entries."""
    return FILES[kind][0] if kind in FILES else f"{kind}s"


#: What we put beside the folders, and nobody else does.
_OURS = {DATABASE, *(f"{DATABASE}-{end}" for end in ("wal", "shm", "journal")), f"{DATABASE}.lock"}
#: Folders within each other; ours are three at most.
_DEEPEST = 8
_KEY = re.compile(r"[0-9a-f]{32,64}")


def refuse_foreign(folder: Path, where: str) -> None:
    """Refuse a folder of somebody's own files, and links anywhere in a project."""
    cannot = f"cannot use {where} as a project"
    if not folder.exists():
        return
    with os.scandir(folder) as entries:
        top = {entry.name: Path(entry.path) for entry in entries}
    database = folder / DATABASE
    begun = database.is_symlink() or (database.exists() and database.lstat().st_size > 0)
    if not begun:
        strange = [n for n, p in top.items() if n not in _OURS and not _is_empty_folder(n, p)]
        if strange:
            raise InputError(
                f"{where} holds files ({shown(strange[0])[:60]}) but no project; begin one in a "
                f"folder of its own: surae serve {shown(Path(where) / 'surae-project')}"
            )
    for path in top.values():
        if is_link(path):
            raise _leads_out(cannot, path, folder)
        if path.name in _OURS:
            state = path.lstat()
            if not stat.S_ISREG(state.st_mode) or state.st_nlink > 1:
                raise InputError(
                    f"{cannot}: its {path.name} is no file of its own, others share it; copy the "
                    "folder, and open the copy"
                )
        if path.name in FOLDERS:
            _refuse_within(cannot, path, folder)


def _refuse_within(cannot: str, path: Path, folder: Path) -> None:
    """Refuse what none of our folders holds: links, pipes, devices, and folders without end."""
    if not path.is_dir():
        raise InputError(f"{cannot}: its {path.name} is no folder; move it away")
    within = [path]
    while within:
        for inner in within.pop().iterdir():
            if is_link(inner):
                raise _leads_out(cannot, inner, folder)
            name = shown(inner.relative_to(folder))[:80]
            if inner.is_dir():
                if len(inner.relative_to(folder).parts) > _DEEPEST:
                    raise InputError(f"{cannot}: its {name} lies too deep; move it away")
                within.append(inner)
            elif not inner.is_file():
                raise InputError(f"{cannot}: its {name} is a pipe or a device; move it away")


def _leads_out(cannot: str, path: Path, folder: Path) -> InputError:
    name = shown(path.relative_to(folder))[:80]
    return InputError(
        f"{cannot}: its {name} is a link, which leads out of it; put the file itself there"
    )


def _is_empty_folder(name: str, path: Path) -> bool:
    """Whether it is one of ours that was made just before a kill."""
    return name in FOLDERS and path.is_dir() and not is_link(path) and not any(path.iterdir())


def new_private(path: Path) -> None:
    """Make a file for its owner alone, where there is none."""
    with suppress(FileExistsError):
        flags = os.O_CREAT | os.O_EXCL | os.O_RDWR | getattr(os, "O_NOFOLLOW", 0)
        os.close(os.open(path, flags, 0o600))


def uploads_of(root: Path, session: object) -> Path:
    """The folder of a session's uploads."""
    folder = root / "uploads" / _checked(session, _KEY)[:32]
    if is_link(folder) or is_link(folder.parent):
        raise RefusedError(409, "the folder of uploads is a link; put the folder itself there")
    return folder


def file_of(root: Path, folder: str, id_: str, suffix: str) -> Path:
    """The file of an entry in a project's folder."""
    path = root / folder / f"{_checked(id_, ID)}{suffix}"
    if is_link(path) or is_link(path.parent):
        raise RefusedError(409, f"{folder}/{path.name} is a link; put the file itself there")
    return path


def _checked(text: object, form: "re.Pattern[str]") -> str:
    """A name that is made of our own digits."""
    if not isinstance(text, str) or not form.fullmatch(text):
        raise RefusedError(409, f"{shown(str(text))[:40]} is no id; the project is damaged")
    return text


def recording_suffix(version: int) -> str:
    """How the file of a recording ends: 0 is what was imported, each description has its own."""
    return f".v{version}.h5" if version else ".h5"


def move_to_trash(root: Path, path: Path) -> str:
    """Move a file of a project to its trash; its name there."""
    (root / "trash").mkdir(mode=0o700, exist_ok=True)
    name = f"{path.relative_to(root).parts[0]}-{path.name}"
    target, number = root / "trash" / name, 2
    while target.exists() or is_link(target):
        target, number = root / "trash" / f"{name}-{number}", number + 1
    path.rename(target)
    return target.name
