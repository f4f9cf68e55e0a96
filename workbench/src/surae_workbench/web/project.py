"""A project: one folder that holds all of a laboratory's work, and can be copied and opened."""

import errno
import os
import re
import shutil
import sqlite3
import time
from collections.abc import Iterable, Mapping
from contextlib import ExitStack, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from surae.base.database import lock
from surae.base.errors import ComputationError, InputError
from surae.base.files import PathLike, is_link, sha256_of, shown, write_json
from surae_workbench.web.database import Database, new_id
from surae_workbench.web.http_errors import RefusedError, not_found
from surae_workbench.web.places import (
    DATABASE,
    FILES,
    FOLDERS,
    file_of,
    new_private,
    plural,
    recording_suffix,
    refuse_foreign,
    uploads_of,
)
from surae_workbench.web.rows import ID, KINDS, Entry

#: Deleted entries come back with undo for so long, uploads lie so long, and the trash keeps what
#: came into it so long [s].
KEPT = 30 * 86_400.0
#: What a system, and SQLite, say where nothing can be written; and room that any writing needs.
_NOT_WRITTEN = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.EPERM)
_NOT_TAKEN = (
    sqlite3.SQLITE_FULL,
    sqlite3.SQLITE_READONLY,
    sqlite3.SQLITE_CANTOPEN,
    sqlite3.SQLITE_IOERR,
)
_ROOM = 2**18
#: A file in the trash that we put there.
_TRASHED = re.compile(r"[a-z]+-[0-9a-f]{16}[a-z0-9.-]{0,40}")


class Project:
    """A project's folder, open; one server at a time has it.

    It is made where it is missing, or begun where it is empty: ``project.db``,
    ``recordings/*.h5``, ``fits/*.json``, ``sessions/*.json``, ``studies/*.db``, ``uploads/`` and
    ``trash/``. One that holds something else, or links, that another server has or a newer surae
    wrote, is an InputError.
    """

    def __init__(self, folder: PathLike) -> None:
        self.folder = Path(os.path.realpath(folder))
        where = shown(folder)
        #: Checksums of files that were compared, and how the files looked then.
        self._seen: dict[Path, tuple[object, tuple[int, ...]]] = {}
        #: Why nothing is kept, in a sentence: there is no room, or nothing may be written.
        self.unkept = ""
        with ExitStack() as opened:
            try:
                refuse_foreign(self.folder, where)
                self._begin(opened, where)
            except (OSError, sqlite3.Error, ComputationError) as error:
                opened.close()
                self.unkept = self._why_unkept(error, where)
                if not self.unkept:
                    if isinstance(error, ComputationError):
                        raise
                    reason = (getattr(error, "strerror", None) or str(error)).lower()
                    raise InputError(
                        f"cannot use {where} as a project: {reason}; give another folder"
                    ) from None
                self.database = Database(self.folder / DATABASE, unkept=self.unkept)
                opened.callback(self.database.close)
                self.id = self._own_id()
            self._opened = opened.pop_all()

    def _begin(self, opened: ExitStack, where: str) -> None:
        """Take the folder to work in it."""
        # What was measured of people is for the one who made the folder to show to others.
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        for name in (f"{DATABASE}.lock", DATABASE):
            new_private(self.folder / name)
        held = lock(self.folder / DATABASE)
        if held is None:
            raise InputError(
                f"{where} is in use by another `surae serve`; stop it, or give another folder"
            )
        opened.callback(held.close)
        self._places = self._identities()
        self.database = Database(self.folder / DATABASE, self.still_ours)
        opened.callback(self.database.close)
        for name in FOLDERS:
            (self.folder / name).mkdir(mode=0o700, exist_ok=True)
        self.id = self._own_id()
        self._tidy()

    def _why_unkept(self, error: BaseException, where: str) -> str:
        """Why nothing can be kept in a project that is there; empty where that is not all."""
        cause = error if isinstance(error, OSError | sqlite3.Error) else error.__cause__
        code = getattr(cause, "sqlite_errorcode", 0) & 0xFF
        if getattr(cause, "errno", None) not in _NOT_WRITTEN and code not in _NOT_TAKEN:
            return ""
        if not (self.folder / DATABASE).is_file() or not (self.folder / DATABASE).stat().st_size:
            return ""  # there is nothing to read
        room = shutil.disk_usage(self.folder).free
        why = f"the disk that {where} is on is full" if room < _ROOM else f"{where} is read-only"
        more = "make room there" if room < _ROOM else "allow writing there, or open a copy"
        return f"{why}: the project can be read, and nothing is kept; {more}, and start again"

    def close(self) -> None:
        """Let go of the folder."""
        self._opened.close()

    def _identities(self) -> list[tuple[int, int]]:
        states = (os.lstat(self.folder / name) for name in (DATABASE, f"{DATABASE}.lock"))
        return [(state.st_dev, state.st_ino) for state in states]

    def still_ours(self) -> None:
        """Refuse to go on where the folder, or the lock in it, has been taken away.

        What is written then would be lost, or meet what another server writes.
        """
        if self.unkept:
            return
        with suppress(OSError):
            if self._identities() == self._places:
                return
        raise RefusedError(
            503,
            "the project's folder, or its lock, was moved or removed while it was open: nothing "
            "is kept any more; stop the server, and start it where the project is now",
        )

    @property
    def name(self) -> str:
        """What pages call it: the folder's name."""
        return shown(self.folder.name)

    def path(self, folder: str, id_: str, suffix: str) -> Path:
        """The file of an entry; ids are ours, never a user's text.

        A link in its place is refused: whoever gave this project away would choose what is read.
        """
        return file_of(self.folder, folder, id_, suffix)

    def file(self, kind: str, id_: str) -> Path:
        """The file of an entry, by its kind; of a recording, as it was imported."""
        return self.path(FILES[kind][0], id_, FILES[kind][1])

    def kept(self, kind: str, id_: str) -> Path:
        """The file of an entry that has to be there, refused where it is another than was kept."""
        row = self.need(kind, id_)
        return self._same(self.file(kind, id_), row.get("sha256"), kind)

    def recording_path(self, recording: Mapping[str, Any]) -> Path:
        """The file of a recording as it is described now, refused as `kept` does."""
        version = recording.get("version", 0)
        path = self.path("recordings", recording["id"], recording_suffix(version))
        checksum = recording.get("version_sha256" if version else "sha256")
        return self._same(path, checksum, "recording")

    def _same(self, path: Path, checksum: object, kind: str) -> Path:
        """The file, if its checksum is the one that was kept; older projects kept none."""
        with suppress(OSError):  # whoever opens it says that it is missing
            state = path.stat()
            now = (state.st_mtime_ns, state.st_ctime_ns, state.st_size, state.st_ino)
            if checksum and self._seen.get(path) != (checksum, now):
                if sha256_of(path) != checksum:
                    raise RefusedError(
                        409,
                        f"the file of this {kind} is not the one that was kept: files were "
                        "exchanged, or it is damaged; `surae project check` tells which",
                    )
                self._seen[path] = (checksum, now)
        return path

    def hidden(self, text: str) -> str:
        """A message without where on this computer the project lies."""
        return text.replace(f"{self.folder}{os.sep}", "")

    def uploads(self, session: str) -> Path:
        """The private folder of a session's uploads."""
        if self.unkept:
            raise RefusedError(503, self.unkept)
        self.still_ours()
        folder = uploads_of(self.folder, session)
        folder.mkdir(mode=0o700, exist_ok=True)
        return folder

    def add(self, kind: str, data: Mapping[str, Any], id_: str) -> str:
        """Keep an entry whose file is there, with the file's checksum; its id."""
        checksum = sha256_of(self.file(kind, id_))
        return self.database.add(kind, {**data, "sha256": checksum}, id_)

    def need(self, kind: str, id_: str) -> Entry:
        """An entry that has to be there."""
        row = self.database.get(kind, id_)
        if row is None:
            raise not_found(kind)
        return row

    def change(self, kind: str, id_: str, **changes: Any) -> Entry:
        """Change some of an entry that has to be there."""
        self.need(kind, id_)
        row = self.database.update(kind, id_, changes)
        if row is None:
            raise not_found(kind)
        return row

    def discard(self, kind: str, id_: str) -> None:
        """Put an entry into the trash for good: its files, and one with what its row held."""
        row = self.database.row("SELECT * FROM thing WHERE kind = ? AND id = ?", kind, id_)
        if row is None or kind not in KINDS or not ID.fullmatch(id_):
            return
        trash = self.folder / "trash"
        columns = ("id", "kind", "created", "deleted", "data")
        moved = [trash / f"{plural(kind)}-{id_}.entry.json"]
        write_json(moved[0], dict(zip(columns, row, strict=True)))
        for path in self._files(kind, id_):
            moved.append(trash / f"{plural(kind)}-{path.name}")
            path.replace(moved[-1])
        for path in moved:
            os.utime(path, (time.time(),) * 2)  # since when it lies there
        self.database.remove(kind, id_)

    def _files(self, kind: str, id_: str) -> list[Path]:
        """The files that were made for an entry."""
        paths: list[Path] = []
        if kind in FILES:
            paths = list((self.folder / FILES[kind][0]).glob(f"{id_}.*"))
        elif kind == "upload":
            with suppress(RefusedError, TypeError):  # a damaged one has none that we know
                upload = self.database.get(kind, id_, deleted=True)
                paths = [uploads_of(self.folder, upload["session"]) / id_]  # type: ignore[index]
        return [path for path in paths if path.is_file() and not is_link(path)]

    def _own_id(self) -> str:
        """What tells the project from others on the same computer."""
        row = self.database.row("SELECT id FROM thing WHERE kind = 'project'")
        if row is None and self.unkept:
            return new_id()
        id_ = self.database.add("project", {}, new_id()) if row is None else str(row[0])
        if not ID.fullmatch(id_):
            raise InputError("its own id is damaged; restore a backup")
        return id_

    def _tidy(self) -> None:
        """Set aside what was deleted, or uploaded, long ago; empty the trash of what is as old.

        A clock that is wrong sets things aside too early, where they still lie for as long.
        """
        self.database.forget_jobs()
        old = time.time() - KEPT
        query = "(deleted > 0 AND deleted < ?) OR (kind = 'upload' AND created < ?)"
        for kind, id_ in self.database.rows(f"SELECT kind, id FROM thing WHERE {query}", old, old):
            self.discard(kind, id_)
        for path in (self.folder / "trash").iterdir():
            state = path.lstat()
            lies_since = max(state.st_mtime, state.st_ctime)  # it came in under another name
            if _TRASHED.fullmatch(path.name) and lies_since < old:
                path.unlink()


def unique_name(rows: Iterable[Mapping[str, Any]], name: str, longest: int = 200) -> str:
    """The name, with a number where one of the entries has it."""
    taken = {row["name"] for row in rows}
    fresh = name[:longest]
    number = 2
    while fresh in taken:
        end = f" ({number})"
        fresh = name[: longest - len(end)] + end
        number = number + 1
    return fresh


def when(seconds: float | None) -> str | None:
    """A time as text, in UTC; None where there is none."""
    if seconds is None:
        return None
    return datetime.fromtimestamp(seconds, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def dated(row: Mapping[str, Any], **more: Any) -> dict[str, Any]:
    """A row as its form of `surae_workbench.web.answers` takes it, the time as text."""
    return {**row, "created": when(row["created"]), **more}
