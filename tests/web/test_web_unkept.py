"""A project on a full disk, or one that is read-only: it is read, and nothing is lost unsaid."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from surae.base.errors import InputError
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.project import Project
from surae_workbench.web.sessions import BrowserSession
from surae_workbench.web.upkeep import check
from surae_workbench.web.workbench import Workbench

SUBJECT = {"code": "S1", "group": "", "notes": "", "body_mass": None}


@pytest.fixture
def disk(tmp_path):
    """A disk of 4 MB of its own."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", str(place)]
    if os.name != "posix" or subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("no disk can be mounted here, which takes rights that CI may not have")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=False)


def full(disk: Path, folder: Path) -> None:
    del folder
    with suppress_full(), (disk / "filler").open("wb", buffering=0) as file:
        while True:
            file.write(b"\0" * 4096)


class suppress_full:  # noqa: N801
    """As `suppress`, of a full disk alone."""

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, _: object) -> bool:
        return isinstance(error, OSError) and error.errno == 28


def read_only(disk: Path, folder: Path) -> None:
    del folder
    subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)


WAYS = pytest.mark.parametrize(("way", "says"), [(full, "is full"), (read_only, "is read-only")])


@WAYS
@pytest.mark.parametrize("ended", ["closed", "killed"])
def test_a_project_opens_to_be_read(disk, way, says, ended) -> None:
    folder = disk / "p"
    first = Project(folder)
    first.database.add("subject", SUBJECT)
    if ended == "killed":  # what was written last lies in the log beside it
        folder = disk / "q"
        shutil.copytree(disk / "p", folder, ignore=shutil.ignore_patterns("*-shm", "*.lock"))
        assert (folder / "project.db-wal").stat().st_size
    first.close()
    way(disk, folder)
    bench = Workbench(folder, 1)
    try:
        assert [row["code"] for row in bench.database.all("subject")] == ["S1"]
        assert says in bench.project.unkept
        assert str(folder) in bench.project.unkept
        session, cookie = bench.sessions.make()
        assert bench.sessions.open([cookie]) == BrowserSession(session.key, session.csrf)
        assert bench.sessions.draft(session)["recordings"] == []
        with pytest.raises(RefusedError, match=says) as told:
            bench.database.add("subject", SUBJECT)
        assert told.value.status == 503
        with pytest.raises(RefusedError, match=says):
            bench.project.uploads(session.key)
    finally:
        bench.close()
    assert check(folder).problems == ()


@WAYS
def test_where_there_is_no_project_none_is_begun(disk, way, says) -> None:
    del says
    way(disk, disk / "p")
    with pytest.raises(InputError, match=r"cannot use .*/p as a project"):
        Project(disk / "p")
