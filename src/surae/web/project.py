"""A project: one folder that holds all of a laboratory's work, and can be copied and opened."""

import os
import shutil
import sqlite3
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from surae.errors import InputError
from surae.files import PathLike, shown
from surae.studies.database import lock
from surae.web.database import Database, Thing
from surae.web.refusals import not_found

_FOLDERS = ("recordings", "fits", "comparisons", "studies", "uploads")


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
            self.folder.mkdir(parents=True, exist_ok=True)
            for name in _FOLDERS:
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
        for left in (self.folder / "uploads").glob("*/import-*"):  # by a worker that was killed
            shutil.rmtree(left, ignore_errors=True)

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
        """The file of a thing; ids are ours, never a user's text."""
        return self.folder / folder / f"{id_}{suffix}"

    def uploads(self, session: str) -> Path:
        """The private folder of a session's uploads."""
        folder = self.folder / "uploads" / session[:32]
        folder.mkdir(mode=0o700, exist_ok=True)
        return folder

    def drop_uploads(self, session: str) -> None:
        """Remove what a session uploaded."""
        shutil.rmtree(self.folder / "uploads" / session[:32], ignore_errors=True)

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


def when(seconds: float | None) -> str | None:
    """A time as text, in UTC; None where there is none."""
    if seconds is None:
        return None
    return datetime.fromtimestamp(seconds, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
