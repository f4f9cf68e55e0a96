"""A project: one folder that holds all of a laboratory's work, and can be copied and opened."""

import os
import re
import shutil
import sqlite3
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from surae.errors import InputError
from surae.files import PathLike, shown
from surae.studies.database import lock
from surae.web.cleanup import empty
from surae.web.database import Database, Thing, new_id
from surae.web.http_errors import RefusedError, not_found

_FOLDERS = ("recordings", "fits", "comparisons", "studies", "uploads")
_ID, _KEY = re.compile(r"[0-9a-f]{16}"), re.compile(r"[0-9a-f]{32,64}")


class Project:
    """A project's folder, open; one server at a time has it.

    Parameters
    ----------
    folder : path
        Made where it is missing: ``project.db``, ``recordings/*.h5``, ``fits/*.json``,
        ``comparisons/*.json``, ``studies/*.db`` and ``uploads/``.

    Raises
    ------
    InputError
        The folder cannot be used, another server has it, or a newer surae wrote it.
    """

    def __init__(self, folder: PathLike) -> None:
        self.folder = Path(os.path.realpath(folder))
        where = shown(folder)
        try:
            # What was measured of people is for the one who made the folder to show to others.
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            for name in _FOLDERS:
                if (self.folder / name).is_symlink():
                    raise InputError(
                        f"cannot use {where} as a project: its {name} is a link, which leads out "
                        f"of it; put the folder itself there"
                    )
                (self.folder / name).mkdir(exist_ok=True)
            (self.folder / "uploads").chmod(0o700)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise InputError(
                f"cannot use {where} as a project: {reason}; give another folder"
            ) from None
        try:
            self._lock = lock(self.folder / "project.db")
        except sqlite3.Error as error:
            raise InputError(f"cannot use {where} as a project: {error}") from None
        if self._lock is None:
            raise InputError(
                f"{where} is in use by another `surae serve`; stop it, or give another folder"
            )
        try:
            self.database = Database(self.folder / "project.db")
        except BaseException:
            self._lock.close()
            raise
        self.id = self._named()
        empty(self.folder, self.database)

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
        """The file of a thing; ids are ours, never a user's text.

        Raises
        ------
        RefusedError
            There is a link in its place: whoever gave this project away would choose what is read.
        """
        return file_of(self.folder, folder, id_, suffix)

    def hidden(self, text: str) -> str:
        """A message without where on this computer the project lies."""
        return text.replace(f"{self.folder}{os.sep}", "")

    def uploads(self, session: str) -> Path:
        """The private folder of a session's uploads."""
        folder = self.folder / "uploads" / _checked(session, _KEY)[:32]
        folder.mkdir(mode=0o700, exist_ok=True)
        return folder

    def drop_uploads(self, session: str) -> None:
        """Remove what a session uploaded."""
        if _KEY.fullmatch(session):  # the project may be a stranger's
            shutil.rmtree(self.folder / "uploads" / session[:32], ignore_errors=True)

    def _named(self) -> str:
        """The project's own id, made the first time; a copy has the same."""
        with self.database.transaction():
            for one in self.database.all("project"):
                return _checked(one["id"], _ID)
            return self.database.add("project", {}, new_id())

    def need(self, kind: str, id_: str) -> Thing:
        """A thing that has to be there.

        Raises
        ------
        RefusedError
            It is not.
        """
        thing = self.database.get(kind, id_)
        if thing is None:
            raise not_found(kind)
        return thing

    def change(self, kind: str, id_: str, **changes: Any) -> Thing:
        """Change some of a thing that has to be there."""
        self.need(kind, id_)
        thing = self.database.update(kind, id_, changes)
        if thing is None:
            raise not_found(kind)
        return thing


def file_of(root: Path, folder: str, id_: str, suffix: str) -> Path:
    """The file of a thing in a project's folder.

    Raises
    ------
    RefusedError
        It is none of ours.
    """
    path = root / folder / f"{_checked(id_, _ID)}{suffix}"
    if path.is_symlink():
        raise RefusedError(409, f"{folder}/{path.name} is a link; put the file itself there")
    return path


def _checked(text: str, form: "re.Pattern[str]") -> str:
    """A name that is made of our own digits."""
    if not form.fullmatch(text):
        raise RefusedError(409, f"{shown(text)[:40]} is no id; the project is damaged")
    return text


def when(seconds: float | None) -> str | None:
    """A time as text, in UTC; None where there is none."""
    if seconds is None:
        return None
    return datetime.fromtimestamp(seconds, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
