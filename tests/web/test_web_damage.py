"""What may be wrong with a project: links, a stranger's content, a full disk, deleted things."""

import errno
import os
import shutil
import sqlite3
import time
from pathlib import Path

import pytest

from surae.errors import ComputationError, InputError
from surae.processes import NO_ROOM, Child
from surae.web.http_errors import RefusedError
from surae.web.project import Project


def test_a_link_leads_nowhere(serve, tmp_path) -> None:
    server = serve()
    browser = server.browser()
    id_ = server.bench.database.add("recording", {"name": "lost"})
    path = server.bench.project.path("recordings", id_, ".h5")
    answer = browser.get(f"/api/recordings/{id_}/window")
    assert answer.status_code == 400
    assert str(tmp_path) not in answer.text  # where the project lies is nobody's business
    (tmp_path / "elsewhere.h5").write_bytes(b"secret")
    path.symlink_to(tmp_path / "elsewhere.h5")
    answer = browser.get(f"/api/recordings/{id_}/window")
    assert answer.status_code == 409
    assert "is a link" in answer.json()["error"]


def test_a_folder_that_leads_out_of_the_project(tmp_path) -> None:
    (tmp_path / "p").mkdir()
    (tmp_path / "other").mkdir(mode=0o755)
    (tmp_path / "p" / "uploads").symlink_to(tmp_path / "other")
    with pytest.raises(InputError, match="uploads is a link"):
        Project(tmp_path / "p")
    assert (tmp_path / "other").stat().st_mode & 0o777 == 0o755


def test_a_strangers_project_removes_nothing_of_ours(tmp_path) -> None:
    """Keys and ids in a project that was given to us may be paths."""
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("years of work")
    Project(tmp_path / "p").close()
    with sqlite3.connect(tmp_path / "p" / "project.db") as file:
        file.execute("INSERT INTO session VALUES ('../../mine', 'x', '{}', 0, 0.0)")
    file.close()
    from surae.web.events import Events
    from surae.web.sessions import Sessions

    project = Project(tmp_path / "p")
    Sessions(project, Events())
    with pytest.raises(RefusedError, match="is no id"):
        project.path("recordings", "../../mine/thesis", ".txt")
    project.close()
    assert (tmp_path / "mine" / "thesis.txt").exists()


def test_a_damaged_project_is_told_in_a_line(tmp_path) -> None:
    Project(tmp_path / "p").close()
    path = tmp_path / "p" / "project.db"
    data = path.read_bytes()
    path.write_bytes(data[:4096] + os.urandom(len(data) - 4096))
    with pytest.raises(ComputationError, match="restore it from a copy"):
        Project(tmp_path / "p")


def test_a_new_project_is_for_its_owner(tmp_path) -> None:
    Project(tmp_path / "p").close()
    assert (tmp_path / "p").stat().st_mode & 0o077 == 0


def deleted(project: Project, kind: str, when: float) -> tuple[str, Path]:
    """A thing that was deleted, and its file."""
    folder = {"recording": "recordings", "fit": "fits"}[kind]
    id_ = project.database.add(kind, {})
    project.database.write("UPDATE thing SET deleted = ? WHERE id = ?", int(when), id_)
    path = project.path(folder, id_, ".h5")
    path.write_text("x")
    return id_, path


def test_what_nobody_can_want_back_is_removed(tmp_path) -> None:
    project = Project(tmp_path / "p")
    now, month = time.time(), 31 * 86_400.0
    kept, kept_file = deleted(project, "recording", now)
    old, old_file = deleted(project, "fit", now - month)
    _, alone_file = deleted(project, "fit", now)
    for id_ in (kept, old):
        project.database.write(
            "INSERT INTO step (session, done, label, kind, before, after) "
            "VALUES ('s', 1, 'delete', 'deleted', ?, '{}')",
            f'{{"kind": "recording", "id": "{id_}"}}',
        )
    lost = project.path("recordings", "f" * 16, ".h5")  # by an import that was killed
    notes = project.folder / "recordings" / "notes.txt"
    there = project.path("recordings", project.database.add("recording", {}), ".h5")
    for path in (lost, notes, there):
        path.write_text("x")
    with project.database.transaction():
        for number in range(600):
            project.database.add("job", {"state": "done"}, f"{number:016x}")
    project.close()

    project = Project(tmp_path / "p")
    assert [one.exists() for one in (kept_file, notes, there)] == [True] * 3
    assert [one.exists() for one in (old_file, alone_file, lost)] == [False] * 3
    assert project.database.rows("SELECT count(*) FROM step") == [(1,)]
    assert len(project.database.all("job")) == 500
    project.close()
    shutil.rmtree(tmp_path / "p")


def test_a_full_disk_is_told(serve, monkeypatch) -> None:
    server = serve()
    browser = server.browser()

    def full(*arguments: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("surae.web.routes.uploads._keep", full)
    answer = browser.post("/api/uploads", params={"name": "a.csv"}, content=b"x")
    assert (answer.status_code, answer.json()["error"]) == (503, NO_ROOM)
    folder = server.bench.project.folder / "uploads"
    assert [one for one in folder.rglob("*") if one.is_file()] == []
    pages = server.bench.database.row("PRAGMA page_count")
    assert pages is not None
    server.bench.database.rows(f"PRAGMA max_page_count = {pages[0]}")
    long = {"notes": "x" * 4000}
    answers = [browser.post("/api/subjects", json={"code": f"S{i}", **long}) for i in range(9)]
    assert {one.status_code for one in answers} <= {201, 503}
    assert answers[-1].json()["error"] == NO_ROOM
    assert browser.get("/api/subjects").status_code == 200


def test_a_mistake_of_ours_tells_no_values() -> None:
    child = Child()
    end = child.call(
        "surae.web.tasks:do", {"task": {"do": "quality", "path": ["name of a patient"]}}
    )
    child.close()
    assert end.how == "failed"
    assert "patient" not in str(end)
    assert "tasks.py" in end.where
