"""A project outlives its server, and moves to other places."""

import contextlib
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest

from surae.base.errors import InputError
from surae_workbench.web.project import Project

from .conftest import PATIENCE, Browser
from .test_web_damage import SUBJECT, recording


def started(folder: Path) -> tuple[subprocess.Popen, str]:
    """`surae serve` in a process of its own, and its address."""
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "surae",
            "serve",
            str(folder),
            "--port",
            "0",
            "--no-open",
            "--workers",
            "1",
        ],
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None
    line = process.stdout.readline()
    assert line.startswith("surae workbench: http://127.0.0.1:"), line
    return process, line.split()[2].rstrip("/")


@pytest.mark.slow
def test_a_server_killed_in_mid_fit_leaves_the_project_intact(tmp_path, trial) -> None:
    folder = tmp_path / "project"
    process, address = started(folder)
    browser = Browser(address)
    recording = browser.recording(trial)
    browser.change(recordings=[recording], prepared=True, starts=1)
    done = browser.job(browser.post("/api/fits", json={}))
    before = browser.get(f"/api/fits/{done['result']}/fit.json").content
    browser.change(starts=1000, model="muscle-tendon")
    job = browser.post("/api/fits", json={}).json()
    while browser.get(f"/api/jobs/{job['id']}").json()["state"] != "running":
        time.sleep(0.05)
    with process:
        os.kill(process.pid, signal.SIGKILL)
    cookies = dict(browser.cookies)
    browser.close()

    moved = tmp_path / "elsewhere"
    shutil.copytree(folder, moved)
    process, address = started(moved)
    with httpx.Client(base_url=address, verify=False, cookies=cookies, timeout=PATIENCE) as again:
        state = again.get("/api/draft").json()
        assert state["draft"]["model"] == "muscle-tendon"  # the same session, as it was
        assert state["undo"] == "test"
        stopped = again.get(f"/api/jobs/{job['id']}").json()
        assert stopped["state"] == "interrupted"
        assert again.get(f"/api/fits/{done['result']}/fit.json").content == before
        again.headers["X-CSRF-Token"] = again.get("/api/session").json()["csrf"]
    with process:
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 0


def test_one_server_has_a_project(tmp_path) -> None:
    project = Project(tmp_path / "p")
    with pytest.raises(InputError, match="in use by another"):
        Project(tmp_path / "p")
    project.close()
    Project(tmp_path / "p").close()


def test_a_newer_project_is_refused_in_a_line(tmp_path) -> None:
    Project(tmp_path / "p").close()
    with sqlite3.connect(tmp_path / "p" / "project.db") as file:
        file.execute("PRAGMA user_version = 99")
    file.close()
    with pytest.raises(InputError, match="newer surae"):
        Project(tmp_path / "p")


@pytest.mark.parametrize("content", [b"not a database at all, but long enough to be one", None])
def test_a_file_that_is_no_project_is_left_alone(tmp_path, content) -> None:
    folder = tmp_path / "p"
    folder.mkdir()
    if content is None:
        with sqlite3.connect(folder / "project.db") as file:
            file.execute("CREATE TABLE mine (x)")
        file.close()
    else:
        (folder / "project.db").write_bytes(content)
    before = (folder / "project.db").read_bytes()
    with pytest.raises(InputError):
        Project(folder)
    assert (folder / "project.db").read_bytes() == before


def test_a_folder_that_cannot_be_used(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="give another folder"):
        Project(tmp_path / "file" / "p")


def test_what_was_read_is_kept_until_it_is_written(serve, monkeypatch) -> None:
    """Of 10,000 recordings one more once took 19 s: each was read again at every step."""
    from surae_workbench.web import database as module

    server = serve()
    database, browser, reads = server.bench.database, server.browser(), []
    with database.transaction():
        for number in range(200):
            database.add("recording", recording(f"r{number}"), f"{number:016x}")
    assert len(browser.get("/api/recordings").json()["recordings"]) == 200
    read = module.entry
    monkeypatch.setattr(module, "entry", lambda *row: (reads.append(row), read(*row))[1])
    for _ in range(3):
        assert len(browser.get("/api/recordings").json()["recordings"]) == 200
    assert reads == []
    path = f"/api/recordings/{3:016x}"
    assert browser.patch(path, json={"name": "r7"}).status_code == 409  # found among those kept
    assert browser.patch(path, json={"name": "other"}).status_code == 200
    assert browser.delete(f"/api/recordings/{4:016x}").status_code == 204
    told = browser.get("/api/recordings").json()["recordings"]
    assert len(told) == 199
    assert "other" in [row["name"] for row in told]
    assert browser.post("/api/draft/undo").status_code == 200
    assert len(browser.get("/api/recordings").json()["recordings"]) == 200
    assert len(reads) < 20


def test_what_a_transaction_takes_back_was_never_there(serve) -> None:
    database = serve().bench.database
    database.add("subject", SUBJECT, "1" * 16)
    assert len(database.all("subject")) == 1
    with contextlib.suppress(KeyError), database.transaction():
        database.add("subject", {**SUBJECT, "code": "S02"}, "2" * 16)
        database.mark("subject", "1" * 16, deleted=True)
        assert [row["code"] for row in database.all("subject")] == ["S02"]
        raise KeyError
    assert [row["code"] for row in database.all("subject")] == ["S01"]
