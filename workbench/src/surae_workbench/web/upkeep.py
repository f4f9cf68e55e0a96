"""Look after a project: a copy of it while it is in use, and what is wrong with it."""

import os
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from surae.base.database import connected, copy, open_to_read, sqlite_errors
from surae.base.errors import ComputationError, InputError, SuraeError
from surae.base.files import PathLike, sha256_of, shown
from surae.base.progress import Progress
from surae_workbench.web.database import FORMAT, refuse_damage
from surae_workbench.web.places import (
    DATABASE,
    FILES,
    FOLDERS,
    file_of,
    recording_suffix,
    refuse_foreign,
    uploads_of,
)
from surae_workbench.web.rows import KINDS, Entry, entry, is_sealed

#: What the database of a copy is called until the copy is whole.
_UNFINISHED = f"{DATABASE}.unfinished"


@dataclass(frozen=True, slots=True)
class Checked:
    """What a check has seen."""

    #: `entries`, `files`: entries in the database, and files that are theirs and as they were kept.
    entries: int
    files: int
    problems: tuple[str, ...]  #: What is wrong, a line each.
    orphans: tuple[str, ...]  #: Files that belong to nothing, as work that was killed leaves them.
    unsealed: tuple[str, ...]  #: Files of entries whose checksum an older surae did not keep.


def check(folder: PathLike, progress: Progress | None = None) -> Checked:
    """Compare a project's database with itself and with the files, also while it is in use.

    `progress` is called with how many entries have been looked at, and how many there are.
    """
    root = _project(folder)
    try:
        with _opened(root) as file:
            return _checked(root, file, progress)
    except SuraeError as error:
        return Checked(0, 0, (str(error),), (), ())


def backup(folder: PathLike, to: PathLike, progress: Progress | None = None) -> Checked:
    """Copy a project to a new folder, also while it is in use; what the copy's check has seen.

    The database is copied as it is at one instant, then every file that it names: files are whole
    before the database names them, and are never changed.

    A copy that is not whole is a ComputationError.
    """
    root = _project(folder)
    target = Path(os.path.realpath(to))
    cannot = f"cannot copy to {shown(to)}"
    if target.exists():
        raise InputError(f"{cannot}: it exists; give a folder that does not")
    if root in target.parents:
        raise InputError(f"{cannot}: it lies in the project; give a folder elsewhere")
    part = target.with_name(f"{target.name}.unfinished")
    if part.exists():
        raise InputError(
            f"{cannot}: a backup that was stopped has left {shown(part)}; delete that folder, or "
            "give another name"
        )
    try:
        part.mkdir(mode=0o700, parents=True)
        # Until it is whole its database has another name: half a copy is no project.
        with _opened(root) as source:
            copy(source, part / _UNFINISHED)
        (part / _UNFINISHED).chmod(0o600)
        for name in FOLDERS:
            (part / name).mkdir(mode=0o700)
            _copy(root / name, part / name)
        with _opened(part, _UNFINISHED) as file:
            seen = _checked(part, file, progress)
        if seen.problems:
            raise ComputationError(
                f"{cannot}: {seen.problems[0]}; `surae project check` tells more"
            )
        (part / _UNFINISHED).replace(part / DATABASE)
        part.replace(target)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise ComputationError(f"{cannot}: {reason}") from None
    finally:
        shutil.rmtree(part, ignore_errors=True)  # half a copy
    return seen


def _project(folder: PathLike) -> Path:
    """The folder of a project that is there."""
    root = Path(os.path.realpath(folder))
    if not (root / DATABASE).is_file():
        raise InputError(f"{shown(folder)} is no surae project: it has no {DATABASE}")
    refuse_foreign(root, shown(folder))
    return root


@contextmanager
def _opened(root: Path, name: str = DATABASE) -> Iterator[sqlite3.Connection]:
    """The database of a project, to read, if its tables are whole."""
    with (
        sqlite_errors(DATABASE, FORMAT),
        closing(open_to_read(root / name, DATABASE, FORMAT)) as file,
    ):
        refuse_damage(file, DATABASE)
        yield file


def _checked(root: Path, file: sqlite3.Connection, progress: Progress | None) -> Checked:
    """What a check sees of a database that can be read."""
    problems = list[str]()
    unsealed = list[str]()
    whole = 0
    with sqlite_errors(DATABASE, FORMAT):
        rows = file.execute("SELECT kind, id, created, data, deleted FROM thing").fetchall()
    project = next((str(id_) for kind, id_, *_ in rows if kind == "project"), "")
    for number, (kind, id_, created, text, deleted) in enumerate(rows):
        if progress is not None:
            progress(number, len(rows))
        if kind not in KINDS:
            continue
        name = f"{kind} {shown(str(id_))[:40]}"
        try:
            paths = list(_paths(root, kind, entry(kind, id_, created, text, project)))
        except (ValueError, SuraeError) as error:
            problems.append(f"{name} is damaged: {error}")
            continue
        unsealed += [] if is_sealed(text) else [f"what {name} says"]
        for path, digest in paths:
            place = path.relative_to(root)
            if not path.is_file():
                if not deleted and kind != "study":  # which makes its file when it begins
                    problems.append(f"{name}: {place} is missing")
            elif digest is not None and sha256_of(path) != digest:
                problems.append(f"{name}: {place} is not as it was kept (SHA-256)")
            else:
                whole += 1
                unsealed += [str(place)] if digest is None and kind != "study" else []
    owners = {(FILES[kind][0] if kind in FILES else f"{kind}s", id_) for kind, id_, *_ in rows}
    orphans = sorted(
        str(path.relative_to(root))
        for name in FOLDERS
        for path in (root / name).rglob("*")
        if path.is_file() and name != "trash" and (name, path.name.partition(".")[0]) not in owners
    )
    return Checked(len(rows), whole, tuple(problems), tuple(orphans), tuple(unsealed))


def _paths(root: Path, kind: str, row: Entry) -> Iterator[tuple[Path, str | None]]:
    """The files of an entry, and the checksum that was kept of each."""
    if kind in FILES:
        yield file_of(root, FILES[kind][0], row["id"], FILES[kind][1]), row.get("sha256")
        if row.get("version"):
            suffix = recording_suffix(row["version"])
            yield file_of(root, "recordings", row["id"], suffix), row["version_sha256"]
    elif kind == "upload":
        yield uploads_of(root, row["session"]) / row["id"], row["sha256"]


def _copy(source: Path, target: Path) -> None:
    """Copy a folder of a project; a study that is at work, as it is at one instant."""
    for path in sorted(source.rglob("*")):
        place = target / path.relative_to(source)
        if path.is_dir():
            place.mkdir(mode=0o700, parents=True, exist_ok=True)
        elif path.suffix == ".db" and source.name == "studies":
            with closing(connected(path, "ro")) as study:
                copy(study, place)
        elif path.name.endswith((".db-wal", ".db-shm", ".db.lock", ".part")):
            continue
        else:
            place.parent.mkdir(parents=True, exist_ok=True)
            with suppress(FileNotFoundError):  # an upload that was just put into the trash
                shutil.copy2(path, place)
