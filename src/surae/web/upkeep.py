"""Look after a project: a copy of it while it is in use, what is wrong with it, and its mending."""

import os
import shutil
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from surae.database import lock, make_tables
from surae.errors import ComputationError, InputError, SuraeError
from surae.files import PathLike, sha256_of, shown, write_json
from surae.web.database import FORMAT, connected, recognised, sqlite_errors
from surae.web.places import (
    DATABASE,
    FILES,
    FOLDERS,
    file_of,
    move_to_trash,
    recording_suffix,
    refuse_foreign,
    uploads_of,
)
from surae.web.project import Project
from surae.web.rows import ID, KINDS, Thing, thing

#: Columns of the tables; a row is copied where each is of its kind.
_TABLES = {
    "thing": ("id", "kind", "created", "deleted", "data"),
    "session": ("key", "csrf", "draft", "revision", "seen"),
    "step": ("id", "session", "done", "label", "kind", "before", "after"),
}


@dataclass(frozen=True, slots=True)
class Checked:
    """What a check has seen."""

    #: `things`, `files`: things in the database, and files that are theirs and as they were kept.
    things: int
    files: int
    problems: tuple[str, ...]  #: What is wrong, a line each.
    orphans: tuple[str, ...]  #: Files that belong to nothing, as work that was killed leaves them.
    unsealed: tuple[str, ...]  #: Files of things whose checksum an older surae did not keep.


def check(folder: PathLike) -> Checked:
    """Compare a project's database with itself and with the files, also while it is in use."""
    root = _project(folder)
    file = None
    try:
        with sqlite_errors(DATABASE):
            file = connected(root / DATABASE, "ro")
            recognised(file, DATABASE)
        return _checked(root, file)
    except SuraeError as error:
        return Checked(0, 0, (str(error),), (), ())
    finally:
        if file is not None:
            file.close()


def backup(folder: PathLike, to: PathLike) -> Checked:
    """Copy a project to a new folder, also while it is in use; what the copy's check has seen.

    The database is copied as it is at one instant, then every file that it names: files are whole
    before the database names them, and are never changed.

    A copy that is not whole is a ComputationError.
    """
    root, target = _project(folder), Path(os.path.realpath(to))
    cannot = f"cannot copy to {shown(to)}"
    if target.exists():
        raise InputError(f"{cannot}: it exists; give a folder that does not")
    if root in target.parents:
        raise InputError(f"{cannot}: it lies in the project; give a folder elsewhere")
    part = target.with_name(f".{target.name}-{os.urandom(4).hex()}.part")
    try:
        part.mkdir(mode=0o700, parents=True)
        with sqlite_errors(DATABASE), closing(connected(root / DATABASE, "ro")) as source:
            recognised(source, DATABASE)
            with closing(sqlite3.connect(part / DATABASE)) as copy:
                source.backup(copy)
        (part / DATABASE).chmod(0o600)
        for name in FOLDERS:
            (part / name).mkdir(mode=0o700)
            _copy(root / name, part / name)
        seen = check(part)
        if seen.problems:
            raise ComputationError(
                f"{cannot}: {seen.problems[0]}; `surae project check` tells more"
            )
        part.replace(target)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise ComputationError(f"{cannot}: {reason}") from None
    finally:
        shutil.rmtree(part, ignore_errors=True)  # half a copy
    return seen


def repair(folder: PathLike) -> tuple[str, ...]:
    """Set aside what is wrong with a project; what was done, a line each. Nothing is deleted.

    A database that is damaged, or holds more than ours, is read row by row into a new one; the old
    one, damaged rows, and files that belong to nothing go to the trash.
    """
    root = _project(folder)
    done: list[str] = []
    before = check(root)
    with _alone(root):
        if before.problems:
            done += _rebuilt(root)
    project = Project(root)
    try:
        for name in check(root).orphans:
            move_to_trash(root, root / name)
            done.append(f"{name} belongs to nothing: in the trash")
        for kind in FILES:
            for row in project.database.all(kind):
                done += _sealed(project, kind, row)
    finally:
        project.close()
    return tuple(done)


def _project(folder: PathLike) -> Path:
    """The folder of a project that is there."""
    root = Path(os.path.realpath(folder))
    if not (root / DATABASE).is_file():
        raise InputError(f"{shown(folder)} is no surae project: it has no {DATABASE}")
    refuse_foreign(root, shown(folder))
    return root


def _checked(root: Path, file: sqlite3.Connection) -> Checked:
    """What a check sees of a database that can be read."""
    problems, unsealed, known = list[str](), list[str](), set[Path]()
    things = whole = 0
    with sqlite_errors(DATABASE):
        rows = file.execute("SELECT kind, id, created, data, deleted FROM thing").fetchall()
    for kind, id_, created, text, deleted in rows:
        things += 1
        name = f"{shown(str(kind))[:20]} {shown(str(id_))[:40]}"
        if isinstance(id_, str) and ID.fullmatch(id_) and kind in FILES:
            known |= set((root / FILES[kind][0]).glob(f"{id_}.*"))
        if kind not in KINDS:
            continue
        try:
            row = thing(str(kind), id_, created, text)
            paths = list(_paths(root, str(kind), row))
        except (ValueError, SuraeError) as error:
            problems.append(f"{name} is damaged: {error}")
            continue
        known |= {path for path, _ in paths}
        for path, digest in paths:
            place = path.relative_to(root)
            if not path.is_file():
                if not deleted and kind != "study":  # which makes its file when it begins
                    problems.append(f"{name}: {place} is missing")
            elif digest is None:
                unsealed += [str(place)] if kind != "study" else []
                whole += 1
            elif sha256_of(path) != digest:
                problems.append(f"{name}: {place} is not as it was kept (SHA-256)")
            else:
                whole += 1
    orphans = sorted(
        str(path.relative_to(root))
        for name in FOLDERS
        if name != "trash"
        for path in (root / name).rglob("*")
        if path.is_file() and path not in known
    )
    return Checked(things, whole, tuple(problems), tuple(orphans), tuple(unsealed))


def _paths(root: Path, kind: str, row: Thing) -> Iterator[tuple[Path, str | None]]:
    """The files of a thing, and the checksum that was kept of each."""
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
            with closing(connected(path, "ro")) as study, closing(sqlite3.connect(place)) as copy:
                study.backup(copy)
        elif path.name.endswith((".db-wal", ".db-shm", ".db.lock", ".part")):
            continue
        else:
            place.parent.mkdir(parents=True, exist_ok=True)
            with suppress(FileNotFoundError):  # an upload that was just put into the trash
                shutil.copy2(path, place)


@contextmanager
def _alone(root: Path) -> Iterator[None]:
    """Have a project's lock, so that no server uses it meanwhile."""
    own_lock = lock(root / DATABASE)
    if own_lock is None:
        raise InputError(f"{shown(root)} is in use by `surae serve`; stop it first")
    with closing(own_lock):
        yield


def _rebuilt(root: Path) -> list[str]:
    """Read whatever can be read of a database into a new one; the old one goes to the trash."""
    fresh, bad = root / f"{DATABASE}.new", list[dict[str, str]]()
    fresh.unlink(missing_ok=True)
    with closing(sqlite3.connect(fresh, isolation_level=None)) as new:
        fresh.chmod(0o600)
        make_tables(new, FORMAT)
        counts = {name: _rows_into(root / DATABASE, new, name, bad.append) for name in _TABLES}
    if not any(counts.values()):
        fresh.unlink()
        raise ComputationError(
            f"nothing of {DATABASE} can be read any more; restore a backup: recordings and fits "
            "beside it are untouched"
        )
    (root / "trash").mkdir(mode=0o700, exist_ok=True)
    with suppress(sqlite3.Error), closing(connected(root / DATABASE)) as file:
        file.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    old = _aside(root, root / DATABASE)
    for end in ("-wal", "-shm"):
        if (root / f"{DATABASE}{end}").exists():
            (root / f"{DATABASE}{end}").replace(root / "trash" / f"{old}{end}")
    fresh.replace(root / DATABASE)
    lines = [f"{counts['thing']} things read into a new database; the old one is trash/{old}"]
    if bad:
        write_json(root / "trash" / f"{old}-rows.json", {"rows": bad})
        lines.append(f"{len(bad)} damaged rows set aside in trash/{old}-rows.json")
    return lines


def _aside(root: Path, path: Path) -> str:
    number = 1
    while (root / "trash" / f"{path.name}-{number}").exists():
        number += 1
    name = f"{path.name}-{number}"
    shutil.copy2(path, root / "trash" / name)
    return name


def _rows_into(
    path: Path, new: sqlite3.Connection, table: str, refuse: Callable[[dict[str, str]], None]
) -> int:
    """Copy the good rows of a table, as far as it can be read; how many."""
    names, count = _TABLES[table], 0
    marks = ", ".join("?" * len(names))
    with suppress(sqlite3.Error), closing(connected(path, "ro")) as old:
        for row in old.execute(f"SELECT {', '.join(names)} FROM {table}"):
            values = dict(zip(names, row, strict=True))
            if table == "thing" and values["kind"] in KINDS:
                try:
                    thing(values["kind"], values["id"], values["created"], values["data"])
                except ValueError as error:
                    refuse({"problem": str(error), **{k: repr(v) for k, v in values.items()}})
                    continue
            try:
                new.execute(f"INSERT INTO {table} VALUES ({marks})", row)
            except sqlite3.Error as error:
                refuse({"problem": str(error), **{k: repr(v) for k, v in values.items()}})
                continue
            count += 1
    return count


def _sealed(project: Project, kind: str, row: Thing) -> Iterator[str]:
    """Keep a checksum that is missing; set aside a thing whose file is."""
    folder, suffix = FILES[kind]
    path = project.path(folder, row["id"], suffix)
    if kind == "study":
        return
    if not path.is_file():
        project.discard(kind, row["id"])
        yield f"{kind} {row['id']}: its file is missing; its entry is in the trash"
    elif "sha256" not in row:
        project.change(kind, row["id"], sha256=sha256_of(path))
