"""A project: one folder that holds all of a laboratory's work, and can be copied and opened."""

import os
import sqlite3
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from surae.database import lock
from surae.errors import InputError
from surae.files import PathLike, sha256_of, shown
from surae_workbench.web.cleanup import KEPT, clean, trash
from surae_workbench.web.database import Database, new_id
from surae_workbench.web.http_errors import RefusedError, not_found
from surae_workbench.web.places import (
    DATABASE,
    FILES,
    FOLDERS,
    file_of,
    new_private,
    recording_suffix,
    refuse_foreign,
    uploads_of,
)
from surae_workbench.web.rows import ID, Entry, plain

_DAY = 86_400
#: Days of use that are remembered; a clock that is further ahead than the last number is not used.
_REMEMBERED, _AHEAD = 400, 40


class Project:
    """A project's folder, open; one server at a time has it.

    Parameters
    ----------
    folder : path
        Made where it is missing, or begun where it is empty: ``project.db``, ``recordings/*.h5``,
        ``fits/*.json``, ``sessions/*.json``, ``studies/*.db``,
        ``uploads/`` and ``trash/``.

    Raises
    ------
    InputError
        The folder holds something else, links, or cannot be used; another server has it, or a
        newer surae wrote it.
    """

    def __init__(self, folder: PathLike) -> None:
        self.folder = Path(os.path.realpath(folder))
        where = shown(folder)
        try:
            refuse_foreign(self.folder, where)
            # What was measured of people is for the one who made the folder to show to others.
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            for name in (f"{DATABASE}.lock", DATABASE):
                new_private(self.folder / name)
            self._lock = lock(self.folder / DATABASE)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise InputError(
                f"cannot use {where} as a project: {reason}; give another folder"
            ) from None
        except sqlite3.Error as error:
            raise InputError(f"cannot use {where} as a project: {error}") from None
        if self._lock is None:
            raise InputError(
                f"{where} is in use by another `surae serve`; stop it, or give another folder"
            )
        try:
            self._places = self._identities()
            self.database = Database(self.folder / DATABASE, self.still_ours)
            try:
                for name in FOLDERS:
                    (self.folder / name).mkdir(mode=0o700, exist_ok=True)
                self.id = self._opened()
            except BaseException:
                self.database.close()
                raise
        except BaseException:
            self._lock.close()
            raise

    def _identities(self) -> list[tuple[int, int]]:
        states = (os.lstat(self.folder / name) for name in (DATABASE, f"{DATABASE}.lock"))
        return [(state.st_dev, state.st_ino) for state in states]

    def still_ours(self) -> None:
        """Refuse to go on where the folder, or the lock in it, has been taken away.

        What is written then would be lost, or meet what another server writes.
        """
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

    def close(self) -> None:
        """Let go of the folder."""
        self.database.close()
        if self._lock is not None:
            self._lock.close()

    def path(self, folder: str, id_: str, suffix: str) -> Path:
        """The file of an entry; ids are ours, never a user's text.

        A link in its place is refused: whoever gave this project away would choose what is read.
        """
        return file_of(self.folder, folder, id_, suffix)

    def recording_path(self, recording: Mapping[str, Any]) -> Path:
        """The file of a recording as it is described now."""
        return self.path(
            "recordings", recording["id"], recording_suffix(recording.get("version", 0))
        )

    def hidden(self, text: str) -> str:
        """A message without where on this computer the project lies."""
        return text.replace(f"{self.folder}{os.sep}", "")

    def uploads(self, session: str) -> Path:
        """The private folder of a session's uploads."""
        self.still_ours()
        folder = uploads_of(self.folder, session)
        folder.mkdir(mode=0o700, exist_ok=True)
        return folder

    def _opened(self) -> str:
        """Count a day of use, tidy up by that count, and give the project's own id.

        Time is not trusted: what is old is told by the days on which the project was used, of which
        a wrong clock makes one more at the most. Where it is behind, or far ahead, nothing is
        tidied up.
        """
        today = int(time.time() // _DAY)
        with self.database.transaction():
            saved: dict[str, Any] = {}
            for id_, text in self.database.rows("SELECT id, data FROM thing WHERE kind='project'"):
                own = str(id_)
                if not ID.fullmatch(own):
                    raise InputError("its own id is damaged; restore a backup")
                with suppress(ValueError):
                    saved = dict(plain(text))
                break
            else:
                own = self.database.add("project", {}, new_id())
            used = saved.get("used")
            if not isinstance(used, list) or not all(type(day) is int for day in used):
                used = []
            sane = not used or 0 <= today - used[-1] <= _AHEAD
            count = saved["days"] if type(saved.get("days")) is int else len(used)
            if not used or today > used[-1]:
                used, count = [*used, today][-_REMEMBERED:], count + 1
                self.database.update("project", own, {"used": used, "days": count})
        self.day, self._used = count, used
        if sane:
            clean(self.folder, self.database, self.day, self.before(KEPT))
        return own

    def before(self, days: int) -> float | None:
        """The time since which the project was used on so many days [s]; None where on fewer."""
        return None if len(self._used) <= days else float(self._used[-days - 1] * _DAY)

    def add(self, kind: str, data: Mapping[str, Any], id_: str) -> str:
        """Keep an entry whose file is there, with the file's checksum; its id."""
        folder, suffix = FILES[kind]
        checksum = sha256_of(self.path(folder, id_, suffix))
        return self.database.add(kind, {**data, "sha256": checksum}, id_)

    def discard(self, kind: str, id_: str) -> None:
        """Put an entry that has no history into the trash, with its files."""
        trash(self.folder, self.database, self.day, kind, id_)

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


def unique_name(rows: Iterable[Mapping[str, Any]], name: str, longest: int = 200) -> str:
    """The name, with a number where one of the entries has it."""
    taken = {row["name"] for row in rows}
    fresh, number = name[:longest], 2
    while fresh in taken:
        end = f" ({number})"
        fresh, number = name[: longest - len(end)] + end, number + 1
    return fresh


def when(seconds: float | None) -> str | None:
    """A time as text, in UTC; None where there is none."""
    if seconds is None:
        return None
    return datetime.fromtimestamp(seconds, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def dated(row: Mapping[str, Any], **more: Any) -> dict[str, Any]:
    """A row as its form of `surae_workbench.web.answers` takes it, the time as text."""
    return {**row, "created": when(row["created"]), **more}
