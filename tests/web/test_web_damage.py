"""What may be wrong with a project: links, a stranger's content, a full disk, deleted things."""

import contextlib
import errno
import json
import os
import sqlite3
import subprocess
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from surae.base.errors import ComputationError, InputError
from surae.processes import NO_ROOM, Child
from surae_workbench.web import upkeep
from surae_workbench.web.database import new_id
from surae_workbench.web.events import Events
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.project import Project
from surae_workbench.web.rows import KINDS
from surae_workbench.web.sessions import BrowserSessions

SUBJECT = {"code": "S01", "group": "", "notes": "", "body_mass": None}


def recording(name: str) -> dict[str, Any]:
    """What the database keeps of a recording."""
    return {
        "name": name,
        "subject": None,
        "side": None,
        "trial": "",
        "condition": "",
        "duration_s": 1.0,
        "emg": None,
        "fixed": {},
        "channels": [],
        "files": [],
        "mapping": None,
        "findings": [],
    }


def job(state: str) -> dict[str, Any]:
    return {
        "kind": "fit",
        "label": "x",
        "state": state,
        "session": "",
        "task": {},
        "about": None,
        "message": "",
        "result": None,
        "started": None,
        "ended": None,
    }


OTHERS: dict[str, dict[str, Any]] = {
    "fit": {
        "name": "x",
        "model": "muscle",
        "status": "converged",
        "vaf": 99.0,
        "ipde": None,
        "seconds": 1.0,
        "recordings": ["f" * 16],
        "names": ["x"],
        "starts": 1,
        "agreeing": 1,
        "parameters": {},
        "settings": {},
    },
    "session": {
        "name": "x",
        "recordings": ["f" * 16],
        "fits": {"joint": "f" * 16},
        "content": {"adequacy": {"grade": "doubtful"}},
        "settings": {},
    },
    "study": {"name": "x", "toml": 'name = "x"\nprotocol = "sine"\n', "rows": 1},
    "protocol": {"name": "x", "settings": {"profile": "multiple-holds"}},
    "upload": {"name": "x", "bytes": 1, "sha256": "", "session": "x"},
}


def test_a_link_leads_nowhere(serve, tmp_path) -> None:
    server = serve()
    browser = server.browser()
    id_ = server.bench.database.add("recording", recording("lost"))
    path = server.bench.project.path("recordings", id_, ".h5")
    answer = browser.get(f"/api/recordings/{id_}/window")
    assert answer.status_code == 400
    assert str(tmp_path) not in answer.text  # where the project lies is nobody's business
    (tmp_path / "elsewhere.h5").write_bytes(b"secret")
    path.symlink_to(tmp_path / "elsewhere.h5")
    answer = browser.get(f"/api/recordings/{id_}/window")
    assert answer.status_code == 409
    assert "is a link" in answer.json()["error"]


@pytest.mark.parametrize(
    "name",
    [
        "uploads",
        "trash",
        "recordings/x.h5",
        "uploads/x",
        "uploads/x/y",
        "notes",
        "project.db",
        "project.db-wal",
        "project.db-shm",
        "project.db.lock",
    ],
)
def test_links_in_a_project_reach_nothing(tmp_path, name) -> None:
    """Of a stranger's project: `uploads/x → elsewhere` once had all of elsewhere deleted."""
    Project(tmp_path / "p").close()
    mine = tmp_path / "mine"
    mine.mkdir(mode=0o755)
    (mine / "thesis.txt").write_text("years of work")
    link = tmp_path / "p" / name
    link.parent.mkdir(exist_ok=True)
    if link.is_dir():
        link.rmdir()
    target = mine if name in ("uploads", "trash", "uploads/x", "notes") else mine / "thesis.txt"
    link.unlink(missing_ok=True)
    link.symlink_to(target)
    with pytest.raises(InputError, match=r"is a link, which leads out"):
        Project(tmp_path / "p")
    assert [path.name for path in mine.iterdir()] == ["thesis.txt"]
    assert (mine / "thesis.txt").read_text() == "years of work"
    assert mine.stat().st_mode & 0o777 == 0o755


def test_a_database_that_others_share_is_refused(tmp_path) -> None:
    Project(tmp_path / "p").close()
    (tmp_path / "q").mkdir()
    os.link(tmp_path / "p" / "project.db", tmp_path / "q" / "project.db")
    with pytest.raises(InputError, match="others share it"):
        Project(tmp_path / "q")


@pytest.mark.parametrize(
    ("name", "make", "says"),
    [
        ("fits", os.mkfifo, "its fits is no folder"),
        ("uploads", Path.touch, "its uploads is no folder"),
        ("recordings/x.h5", os.mkfifo, "is a pipe or a device"),
        ("project.db-wal", os.mkfifo, "is no file of its own"),
        ("uploads/" + "d/" * 1200, None, "lies too deep"),
    ],
)
def test_what_no_folder_of_ours_holds_is_refused(tmp_path, name, make, says) -> None:
    """Some of it once ended the program; a pipe would have it wait for ever."""
    Project(tmp_path / "p").close()
    path = tmp_path / "p" / name
    if make is None:
        at = os.open(tmp_path / "p" / "uploads", os.O_RDONLY)
        for _ in range(1200):  # longer than a path may be
            os.mkdir("d", dir_fd=at)
            at, above = os.open("d", os.O_RDONLY, dir_fd=at), at
            os.close(above)
        os.close(at)
    else:
        if path.is_dir():
            path.rmdir()
        make(path)
    for attempt in (Project, upkeep.check):
        with pytest.raises(InputError, match=says):
            attempt(tmp_path / "p")
    subprocess.run(["rm", "-rf", tmp_path / "p"], check=True)


def test_a_row_without_end_is_damaged_and_the_others_are_there(tmp_path) -> None:
    """Of a stranger's project: 300 MB in one row."""
    project = Project(tmp_path / "p")
    project.database.add("subject", SUBJECT)
    row = ("c" * 16, json.dumps({**SUBJECT, "notes": "x" * 17 * 2**20}))
    long = "INSERT INTO thing VALUES (?, 'subject', 1.0, 0, ?)"
    project.database.change("subject", "c" * 16, long, *row)
    assert [subject["code"] for subject in project.database.all("subject")] == ["S01"]
    assert project.database.damaged()[0]["problem"] == "it is longer than 16 MiB"
    project.close()


def test_a_link_that_came_while_it_ran_is_refused(tmp_path) -> None:
    project = Project(tmp_path / "p")
    (tmp_path / "mine").mkdir()
    key = "a" * 64
    (tmp_path / "p" / "uploads" / key[:32]).symlink_to(tmp_path / "mine")
    with pytest.raises(RefusedError, match="is a link"):
        project.uploads(key)
    project.close()


@pytest.mark.parametrize(
    "name", ["uploads/2024/patient1.csv", "recordings/0123456789abcdef.h5", "notes.txt"]
)
def test_a_folder_of_ones_own_is_no_project(tmp_path, name) -> None:
    path = tmp_path / "mine" / name
    path.parent.mkdir(parents=True)
    path.write_text("mine")
    before = sorted((tmp_path / "mine").rglob("*"))
    with pytest.raises(InputError, match=r"holds files .* but no project; begin one"):
        Project(tmp_path / "mine")
    assert sorted((tmp_path / "mine").rglob("*")) == before
    assert path.read_text() == "mine"


def test_a_start_that_was_killed_early_can_be_repeated(tmp_path) -> None:
    (tmp_path / "p" / "uploads").mkdir(parents=True)
    for name in ("project.db.lock", "project.db"):
        (tmp_path / "p" / name).touch()
    Project(tmp_path / "p").close()


def test_a_strangers_project_removes_nothing_of_ours(tmp_path) -> None:
    """Keys and ids in a project that was given to us may be paths."""
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("years of work")
    Project(tmp_path / "p").close()
    with sqlite3.connect(tmp_path / "p" / "project.db") as file:
        file.execute("INSERT INTO session VALUES ('../../mine', 'x', '{}', 0, 0.0)")
    file.close()
    project = Project(tmp_path / "p")
    BrowserSessions(project, Events())
    with pytest.raises(RefusedError, match="is no id"):
        project.path("recordings", "../../mine/thesis", ".txt")
    project.close()
    assert (tmp_path / "mine" / "thesis.txt").exists()


def test_a_damaged_project_is_told_in_a_line(tmp_path) -> None:
    Project(tmp_path / "p").close()
    path = tmp_path / "p" / "project.db"
    data = path.read_bytes()
    path.write_bytes(data[:4096] + os.urandom(len(data) - 4096))
    with pytest.raises(ComputationError, match="whole; restore a backup"):
        Project(tmp_path / "p")


def test_a_new_project_is_for_its_owner(tmp_path) -> None:
    """Its files too: somebody may open the folder to others, as where it is copied to."""
    (tmp_path / "p").mkdir(mode=0o755)
    project = Project(tmp_path / "p")
    project.database.add("subject", SUBJECT)
    files = [path for path in (tmp_path / "p").iterdir() if path.is_file()]
    assert {path.name for path in files} >= {"project.db", "project.db-wal", "project.db.lock"}
    for file in (*files, *(tmp_path / "p").glob("*/")):
        assert file.stat().st_mode & 0o077 == 0, file
    project.close()


def reopened(folder: Path, days: float, monkeypatch) -> None:
    """Open a project so many days from now."""
    from surae_workbench.web import project

    then = time.time() + 86_400.0 * days
    monkeypatch.setattr(project.time, "time", lambda: then)
    Project(folder).close()
    monkeypatch.undo()


def files(folder: Path) -> set[str]:
    return {
        str(path.relative_to(folder))
        for path in folder.rglob("*")
        if path.is_file() and not path.name.startswith("project.db")
    }


def filled(folder: Path) -> tuple[str, str, str]:
    """A project with a recording, one that was deleted, an old upload, and files it knows not."""
    project = Project(folder)
    kept, gone, upload = new_id(), new_id(), new_id()
    session = "b" * 64
    for id_ in (kept, gone):
        project.path("recordings", id_, ".h5").write_bytes(b"x")
        project.add("recording", recording(id_), id_)
    (project.uploads(session) / upload).write_bytes(b"y")
    project.database.add(
        "upload", {"name": "a.csv", "bytes": 1, "sha256": "", "session": session}, upload
    )
    project.database.mark("recording", gone, deleted=True)
    (folder / "recordings" / "0123456789abcdef.h5").write_bytes(b"mine")
    (folder / "uploads" / "mine.csv").write_bytes(b"mine")
    project.close()
    return kept, gone, upload


def test_nothing_is_deleted_but_what_has_been_in_the_trash(tmp_path, monkeypatch) -> None:
    kept, gone, upload = filled(tmp_path / "p")
    session = "b" * 32
    always = {f"recordings/{kept}.h5", "recordings/0123456789abcdef.h5", "uploads/mine.csv"}
    before = always | {f"recordings/{gone}.h5", f"uploads/{session}/{upload}"}
    reopened(tmp_path / "p", 29, monkeypatch)
    assert files(tmp_path / "p") == before
    reopened(tmp_path / "p", 31, monkeypatch)
    aside = {f"trash/recordings-{gone}.h5", f"trash/uploads-{upload}"}
    rows = {f"trash/recordings-{gone}.entry.json", f"trash/uploads-{upload}.entry.json"}
    assert files(tmp_path / "p") == always | aside | rows
    row = json.loads((tmp_path / "p" / f"trash/recordings-{gone}.entry.json").read_text())
    assert json.loads(row["data"])["name"] == gone
    reopened(tmp_path / "p", 60, monkeypatch)
    assert files(tmp_path / "p") == always | aside | rows
    reopened(tmp_path / "p", 62, monkeypatch)
    assert files(tmp_path / "p") == always


@pytest.mark.parametrize("days", [400, 40_000, -400, -15_000])
def test_a_wrong_clock_loses_nothing(tmp_path, monkeypatch, days) -> None:
    """Once a start 400 days ahead purged uploads, recordings and sessions."""
    filled(tmp_path / "p")
    project = Project(tmp_path / "p")
    sessions = BrowserSessions(project, Events())
    session, cookie = sessions.make()
    sessions.change(session, {"seed": 5}, "seed")
    project.close()
    before = {path.rsplit("-")[-1].rsplit("/")[-1] for path in files(tmp_path / "p")}
    for _ in range(2):
        reopened(tmp_path / "p", days, monkeypatch)
    reopened(tmp_path / "p", 0, monkeypatch)
    after = {path.rsplit("-")[-1].rsplit("/")[-1] for path in files(tmp_path / "p")}
    assert after >= before  # what is old by that clock is in the trash
    project = Project(tmp_path / "p")
    assert BrowserSessions(project, Events()).open([cookie]) == session
    project.close()


def test_a_deleted_upload_is_in_the_trash(tmp_path) -> None:
    _, _, upload = filled(tmp_path / "p")
    project = Project(tmp_path / "p")
    project.discard("upload", upload)
    assert project.database.get("upload", upload) is None
    assert (tmp_path / "p" / "trash" / f"uploads-{upload}").read_bytes() == b"y"
    project.close()


def test_finished_jobs_are_forgotten(tmp_path) -> None:
    project = Project(tmp_path / "p")
    with project.database.transaction():
        for number in range(600):
            project.database.add("job", job("done"), f"{number:016x}")
    project.close()
    project = Project(tmp_path / "p")
    assert len(project.database.all("job")) == 500
    project.close()


#: What a stranger, or a disk, may put where a row's content was.
BAD = ["{}", "", "{", "[]", "null", "1", '{"name": 1e999}', '{"code": NaN}', "[" * 9000, "\x00"]


def test_one_bad_row_is_one_bad_row(serve) -> None:
    server = serve()
    database, browser = server.bench.database, server.browser()
    content = {"subject": SUBJECT, "recording": recording("a"), "job": job("done"), **OTHERS}
    bad = [(f"{number:016x}"[::-1], 1.0, text) for number, text in enumerate(BAD, 1)]
    with database.transaction():
        for kind in KINDS:
            database.add(kind, content[kind], "0" * 16)
            late = ("e" * 16, float("inf"), json.dumps(content[kind]))
            for id_, created, text in (*bad, late, ("../../x", 1.0, "{}")):
                row = (id_, kind, created, 0, text)
                database.change(kind, id_, "INSERT INTO thing VALUES (?, ?, ?, ?, ?)", *row)
    damaged = browser.get("/api/damaged").json()["damaged"]
    assert Counter(name["kind"] for name in damaged) == dict.fromkeys(KINDS, len(BAD) + 2)
    for kind in (
        "subjects",
        "recordings",
        "fits",
        "sessions",
        "jobs",
        "studies",
        "protocols",
    ):
        answer = browser.get(f"/api/{kind}")
        assert answer.status_code == 200, answer.text
        assert [entry["id"] for entry in answer.json()[kind]] == ["0" * 16], kind
    for path in ("cohort", "draft", "uploads", "jobs?active=true"):
        assert browser.get(f"/api/{path}").status_code == 200, path
    for path in ("recordings", "fits", "sessions", "jobs"):
        assert browser.get(f"/api/{path}/{'e' * 16}").status_code == 409
    server.close()
    Project(server.bench.project.folder).close()  # it still opens


def test_a_bad_step_or_draft_is_passed_over(serve) -> None:
    server = serve()
    browser, database = server.browser(), server.bench.database
    browser.change(seed=5)
    ((key,),) = database.rows("SELECT key FROM session")
    steps = [
        ("draft", "{"),
        ("deleted", "{}"),
        ("draft", "[]"),
        ("other", "{}"),
        ("deleted", '{"kind": 1, "id": 2}'),
        ("draft", '{"seed": "x", "starts": -1}'),
    ]
    for kind, text in steps:
        database.write(
            "INSERT INTO step (session, done, label, kind, before, after) "
            "VALUES (?, 1, 'x', ?, ?, ?)",
            key,
            kind,
            text,
            text,
        )
    assert browser.get("/api/draft").json()["undo"] == "x"
    assert browser.post("/api/draft/undo").json()["draft"]["seed"] == 5  # the last made no sense
    assert browser.post("/api/draft/undo").json()["draft"]["seed"] == 0
    for draft in ('{"model": 7, "seed": 8, "recordings": "x"}', "{", "[]", "9e999"):
        database.write("UPDATE session SET draft = ?, revision = 'x'", draft)
        answer = browser.get("/api/draft").json()["draft"]
        assert (answer["model"], answer["recordings"]) == ("auto", [])
        assert browser.get("/api/draft/parameters").status_code == 200


@pytest.mark.parametrize(
    "statement",
    [
        "CREATE TRIGGER t AFTER INSERT ON thing BEGIN DELETE FROM thing; END",
        "CREATE VIEW v AS SELECT * FROM thing",
        "CREATE TABLE other (x)",
        "CREATE INDEX i ON thing (data)",
        "DROP INDEX thing_kind",
        "ALTER TABLE session ADD COLUMN x",
    ],
)
def test_a_project_with_more_than_our_tables_is_refused(tmp_path, statement) -> None:
    Project(tmp_path / "p").close()
    with sqlite3.connect(tmp_path / "p" / "project.db") as file:
        file.execute(statement)
    file.close()
    with pytest.raises(InputError, match=r"that are not surae.s, or lacks some"):
        Project(tmp_path / "p")


def held(server) -> sqlite3.Connection:
    """Another program that writes into a project's database."""
    other = sqlite3.connect(server.bench.project.folder / "project.db", isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    return other


def test_a_program_that_holds_the_database_keeps_nobody_from_reading(serve, monkeypatch) -> None:
    monkeypatch.setattr(
        "surae_workbench.web.database._PATIENCE", 60.0
    )  # reads on a busy computer take less
    server = serve()
    browser = server.browser()
    browser.change(seed=5)
    answers = []
    write = threading.Thread(target=lambda: answers.append(browser.post("/api/draft/undo")))
    with contextlib.closing(held(server)):
        write.start()
        time.sleep(0.2)
        assert browser.get("/api/draft").json()["draft"]["seed"] == 5
        assert browser.get("/api/recordings").status_code == 200
        assert write.is_alive()  # they did not wait for it
    write.join()
    assert answers[0].json()["draft"]["seed"] == 0


def test_a_program_that_goes_on_holding_the_database_is_told(serve, monkeypatch) -> None:
    monkeypatch.setattr("surae_workbench.web.database._PATIENCE", 0.1)
    server = serve()
    browser = server.browser()
    browser.change(seed=5)
    with contextlib.closing(held(server)):
        answer = browser.post("/api/draft/undo")
        assert answer.status_code == 503
        assert "another program holds" in answer.json()["error"]
    assert browser.post("/api/draft/undo").json()["draft"]["seed"] == 0


@pytest.mark.parametrize("what", ["folder", "lock", "database"])
def test_a_project_that_was_taken_away_keeps_nothing(serve, what, tmp_path) -> None:
    server = serve()
    browser, folder = server.browser(), server.bench.project.folder
    if what == "folder":
        folder.rename(tmp_path / "elsewhere")
    else:
        (folder / ("project.db.lock" if what == "lock" else "project.db")).unlink()
    for answer in (
        browser.post("/api/subjects", json={"code": "S01"}),
        browser.post("/api/uploads", params={"name": "a.csv"}, content=b"x"),
    ):
        assert answer.status_code == 503
        assert "was moved or removed" in answer.json()["error"]


def test_a_full_disk_is_told(serve, monkeypatch) -> None:
    server = serve()
    browser = server.browser()

    def full(*arguments: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("surae_workbench.web.routes.uploads._keep", full)
    answer = browser.post("/api/uploads", params={"name": "a.csv"}, content=b"x")
    assert (answer.status_code, answer.json()["error"]) == (503, NO_ROOM)
    folder = server.bench.project.folder / "uploads"
    assert [path for path in folder.rglob("*") if path.is_file()] == []
    pages = server.bench.database.row("PRAGMA page_count")
    assert pages is not None
    server.bench.database.write(f"PRAGMA max_page_count = {pages[0]}")
    long = {"notes": "x" * 4000}
    answers = [browser.post("/api/subjects", json={"code": f"S{i}", **long}) for i in range(9)]
    assert {answer.status_code for answer in answers} <= {201, 503}
    assert answers[-1].json()["error"].startswith("project.db: the disk that it is on is full; ")
    assert browser.get("/api/subjects").status_code == 200


def test_a_mistake_of_ours_tells_no_values() -> None:
    child = Child()
    end = child.call("surae_workbench.web.imports:quality", {"path": ["name of a patient"]})
    child.close()
    assert end.how == "failed"
    assert "patient" not in str(end)
    assert "imports.py" in end.where


def test_a_session_with_no_grade_where_one_should_be_is_damaged(serve) -> None:
    server = serve()
    browser, good = server.browser(), OTHERS["session"]
    server.bench.database.add("session", good, "0" * 16)
    damaged = []
    for digit, adequacy in zip("abcde", (1, [], {}, {"grade": 2}, "doubtful"), strict=True):
        text = json.dumps({**good, "content": {"adequacy": adequacy}})
        damaged.append(digit * 16)
        row = (damaged[-1], "session", 1.0, 0, text)
        insert = "INSERT INTO thing VALUES (?, ?, ?, ?, ?)"
        server.bench.database.change("session", row[0], insert, *row)
    listed = browser.get("/api/sessions")
    assert listed.status_code == 200, listed.text
    assert [entry["id"] for entry in listed.json()["sessions"]] == ["0" * 16]
    names = [name["id"] for name in browser.get("/api/damaged").json()["damaged"]]
    assert sorted(names) == damaged


def test_a_row_says_what_was_kept_or_is_damaged(tmp_path) -> None:
    """Edited words and numbers, exchanged rows and those of another project are shown as such."""
    other = Project(tmp_path / "other")
    foreign = other.database.add("subject", SUBJECT | {"code": "elsewhere"})
    row = other.database.row("SELECT * FROM thing WHERE id = ?", foreign)
    other.close()
    project = Project(tmp_path / "p")
    ids = [project.database.add("subject", SUBJECT | {"code": f"S{k}"}) for k in range(4)]
    project.change("subject", ids[3], notes="changed, by us")
    project.close()
    with contextlib.closing(sqlite3.connect(tmp_path / "p" / "project.db")) as file, file:
        of = dict(file.execute("SELECT id, data FROM thing WHERE kind = 'subject'"))
        file.execute("UPDATE thing SET data = replace(data, 'S0', 'S9') WHERE id = ?", (ids[0],))
        for here, there in ((1, 2), (2, 1)):
            file.execute("UPDATE thing SET data = ? WHERE id = ?", (of[ids[there]], ids[here]))
        file.execute("INSERT INTO thing VALUES (?, ?, ?, ?, ?)", row)
    again = Project(tmp_path / "p")
    assert [each["code"] for each in again.database.all("subject")] == ["S3"]
    damaged = again.database.damaged()
    assert {each["id"] for each in damaged} == {*ids[:3], foreign}
    assert all("is not what was kept here" in each["problem"] for each in damaged)
    with pytest.raises(RefusedError, match="not what was kept here"):
        again.need("subject", ids[0])
    again.close()
    assert len(upkeep.check(tmp_path / "p").problems) == 4


@pytest.mark.parametrize("kind", ["fit", "recording", "session"])
def test_verdicts_of_a_row_without_its_checksum_are_not_believed(tmp_path, kind) -> None:
    """Whoever edits a row may take its checksum off too: lists then show no verdict of it."""
    one = {"value": 1.0, "sem": 0.01, "low": 0.9, "high": 1.1, "verdict": "identified"}
    rows = {
        "fit": {
            **{"name": "x", "model": "muscle", "status": "converged", "vaf": 99.0, "r2": 99.0},
            **{"grade": "adequate", "ipde": 0.1, "recordings": ["0" * 16], "names": ["t"]},
            **{"parameters": {"m": one}, "measures": {"end_torque": one}, "settings": {}},
        },
        "recording": {
            **{"name": "x", "subject": None, "side": None, "trial": "", "condition": ""},
            **{"duration_s": 1.0, "emg": None, "fixed": {}, "channels": [], "files": []},
            **{"mapping": None, "findings": [], "first": {"says": "a normal leg"}},
        },
        "session": {
            **{"name": "x", "recordings": ["0" * 16], "fits": {}, "settings": {}},
            "content": {"adequacy": {"grade": "adequate"}},
        },
    }
    content = rows[kind]
    project = Project(tmp_path / "p")
    id_ = project.database.add(kind, content)
    sealed = project.database.get(kind, id_)
    project.close()
    assert sealed is not None
    assert {key: sealed[key] for key in content} == content
    with contextlib.closing(sqlite3.connect(tmp_path / "p" / "project.db")) as file, file:
        file.execute("UPDATE thing SET data = ? WHERE id = ?", (json.dumps(content), id_))
    again = Project(tmp_path / "p")
    shown = again.database.get(kind, id_)
    again.close()
    assert shown is not None
    assert shown["name"] == "x (not sealed: made by an older version)"
    text = json.dumps(shown)
    assert not any(word in text for word in ("identified", '"adequate"', "99.0", "a normal leg"))
    assert upkeep.check(tmp_path / "p").unsealed[:1] == (f"what {kind} {id_} says",)


def test_a_row_of_an_older_version_has_no_checksum_and_a_check_says_so(tmp_path) -> None:
    project = Project(tmp_path / "p")
    id_ = project.database.add("subject", SUBJECT)
    project.close()
    with contextlib.closing(sqlite3.connect(tmp_path / "p" / "project.db")) as file, file:
        file.execute("UPDATE thing SET data = ? WHERE id = ?", (json.dumps(SUBJECT), id_))
    again = Project(tmp_path / "p")
    assert again.need("subject", id_)["code"] == "S01"
    again.close()
    assert upkeep.check(tmp_path / "p").unsealed == (f"what subject {id_} says",)
