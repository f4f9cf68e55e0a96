"""What is set aside when a project is opened: what was deleted long ago, and old uploads.

Nothing is deleted: entries and their files go to the project's ``trash`` folder, and only from
there for good, after 30 more days on which the project was used. Only what the database says was
made here is touched.
"""

import json
import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from surae.files import is_link
from surae_workbench.web.database import Database
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.places import FILES, move_to_trash, uploads_of
from surae_workbench.web.rows import plain

#: Days of use: deleted entries come back with undo for so long, uploads lie so long unused; and
#: the trash keeps what came into it.
KEPT = 30
#: Finished jobs that are remembered; results are kept whether or not their job is.
JOBS = 500
#: A file in the trash that we put there.
_TRASHED = re.compile(r"(recordings|fits|sessions|studies|uploads)-[0-9a-f]{16}[a-z0-9.-]{0,40}")


def clean(folder: Path, database: Database, day: int, old: float | None) -> None:
    """Set aside what is old; nobody else has the project open.

    The project was used on so many days (`day`); what was deleted or uploaded before the time `old`
    [s] is old, nothing where it is None.
    """
    database.forget_jobs(JOBS)
    if old is not None:
        for kind, id_ in database.rows(
            "SELECT kind, id FROM thing WHERE (deleted > 0 AND deleted < ?) "
            "OR (kind = 'upload' AND created < ?)",
            old, old,
        ):  # fmt: skip
            trash(folder, database, day, kind, id_)
    for id_, text in database.rows("SELECT id, data FROM thing WHERE kind = 'trash'"):
        with suppress(ValueError, TypeError, KeyError):
            row = plain(text)
            if row["day"] + KEPT < day:
                _empty(folder / "trash", row["files"])
                database.remove("trash", id_)


def trash(folder: Path, database: Database, day: int, kind: str, id_: str) -> None:
    """Put an entry and its files into the trash; its row, whatever it holds, stays there too."""
    row = database.row(
        "SELECT created, deleted, data FROM thing WHERE kind = ? AND id = ?", kind, id_
    )
    if row is None:
        return
    content: Any = str(row[2])
    with suppress(ValueError):
        content = plain(content)
    moved = [move_to_trash(folder, path) for path in list(_files(folder, kind, id_, content))]
    data = {
        "kind": kind, "created": row[0], "deleted": row[1], "content": content, "files": moved,
        "day": day,
    }  # fmt: skip
    with database.transaction():
        database.remove(kind, id_)
        query = "INSERT OR REPLACE INTO thing VALUES (?, 'trash', 0.0, 0, ?)"
        database.change("trash", id_, query, id_, json.dumps(data))
        for step, text in database.rows("SELECT id, before FROM step WHERE kind = 'deleted'"):
            with suppress(ValueError, TypeError, KeyError):
                if plain(text)["id"] == id_:
                    database.write("DELETE FROM step WHERE id = ?", step)


def _files(root: Path, kind: str, id_: str, content: object) -> Iterator[Path]:
    """The files that were made for an entry."""
    paths: list[Path] = []
    if kind in FILES:
        paths = list((root / FILES[kind][0]).glob(f"{id_}.*"))
    elif kind == "upload" and isinstance(content, dict):
        with suppress(RefusedError):
            paths = [uploads_of(root, content.get("session")) / id_]
    yield from (path for path in paths if path.is_file() and not is_link(path))


def _empty(folder: Path, names: object) -> None:
    """Delete files of the trash, for good."""
    for name in names if isinstance(names, list) else []:
        if isinstance(name, str) and _TRASHED.fullmatch(name):
            (folder / name).unlink(missing_ok=True)
