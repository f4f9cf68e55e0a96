"""What is thrown away for good when a project is opened: what nobody can want back."""

import re
import shutil
import time
from contextlib import suppress
from pathlib import Path

from surae.web.database import Database

#: Deleted things come back with undo for so long, uploads lie so long unused [s].
_KEPT = 30 * 86_400.0
#: Finished jobs that are remembered; results are kept whether or not their job is.
_JOBS = 500
#: Files that we made: of a thing, or half of one.
_OURS = re.compile(r"([0-9a-f]{16})\.|\.surae-")
#: Folders of things, and their kinds.
_KINDS = {
    "recordings": "recording",
    "fits": "fit",
    "comparisons": "comparison",
    "studies": "study",
}


def empty(folder: Path, database: Database) -> None:
    """Remove deleted things, old uploads and jobs, and files that belong to nothing.

    A deleted thing goes when no history can bring it back, or after 30 days. Files without a thing
    are left by work that was killed. Nobody else has the project open.

    Parameters
    ----------
    folder : Path
        The project's.
    database : Database
        Its content.
    """
    old = time.time() - _KEPT
    with database.transaction():
        database.write(
            "DELETE FROM step WHERE kind = 'deleted' AND json_extract(before, '$.id') IN "
            "(SELECT id FROM thing WHERE deleted > 0 AND deleted < ?)",
            old,
        )
        database.write(
            "DELETE FROM thing WHERE deleted > 0 AND id NOT IN "
            "(SELECT json_extract(before, '$.id') FROM step WHERE kind = 'deleted')"
        )
        database.write("DELETE FROM thing WHERE kind = 'upload' AND created < ?", old)
        forget_jobs(database)
        there = {kind: {id_ for (id_,) in database.rows(
            "SELECT id FROM thing WHERE kind = ?", kind)} for kind in (*_KINDS.values(), "upload")
        }  # fmt: skip
    for name, kind in _KINDS.items():
        for path in (folder / name).iterdir():
            found = _OURS.match(path.name)
            if found and found[1] not in there[kind]:
                _remove(path)
    for path in (folder / "uploads").glob("*/*"):
        if path.name not in there["upload"]:
            _remove(path)


def forget_jobs(database: Database) -> None:
    """Remove the oldest of the jobs that are finished."""
    database.write(
        "DELETE FROM thing WHERE kind = 'job' AND id IN (SELECT id FROM thing WHERE kind = 'job' "
        "AND json_extract(data, '$.state') NOT IN ('queued', 'running') "
        "ORDER BY created DESC LIMIT -1 OFFSET ?)",
        _JOBS,
    )


def _remove(path: Path) -> None:
    with suppress(OSError):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink()
