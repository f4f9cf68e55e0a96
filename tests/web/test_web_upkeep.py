"""A project copied, checked and mended: what is whole stays, what is not is set aside."""

import shutil
import sqlite3
import subprocess
import sys

import pytest
from click.testing import CliRunner

from surae.base.errors import ComputationError, InputError
from surae.base.files import sha256
from surae.cli import group
from surae_workbench.web import upkeep
from surae_workbench.web.database import new_id
from surae_workbench.web.project import Project

from .test_web_damage import OTHERS, SUBJECT, files, recording


@pytest.fixture
def filled(tmp_path) -> Project:
    """A project that is open, with a subject, two recordings, a fit, an upload and a study."""
    project = Project(tmp_path / "p")
    database = project.database
    database.add("subject", SUBJECT, "5" * 16)
    for id_ in ("a" * 16, "b" * 16):
        project.path("recordings", id_, ".h5").write_bytes(id_.encode())
        project.add("recording", recording(id_), id_)
    project.path("fits", "c" * 16, ".json").write_text("{}")
    project.add("fit", OTHERS["fit"], "c" * 16)
    with sqlite3.connect(project.path("studies", "d" * 16, ".db")) as study:
        study.execute("CREATE TABLE rows (x)")
        study.execute("INSERT INTO rows VALUES (1)")
    study.close()
    database.add("study", OTHERS["study"], "d" * 16)
    session = "e" * 64
    (project.uploads(session) / ("f" * 16)).write_bytes(b"raw")
    upload = {"name": "x.csv", "bytes": 3, "sha256": sha256(b"raw"), "session": session}
    database.add("upload", upload, "f" * 16)
    return project


def told(*arguments: object) -> tuple[int, str]:
    done = CliRunner().invoke(group, ["project", *map(str, arguments)])
    if isinstance(done.exception, InputError | ComputationError):
        return (2 if isinstance(done.exception, InputError) else 1), str(done.exception)
    return done.exit_code, done.output


def test_a_copy_of_a_project_in_use_is_a_project(filled, tmp_path) -> None:
    assert told("check", filled.folder) == (0, "7 entries, 5 files as they were kept\n")
    code, said = told("backup", filled.folder, tmp_path / "copy")
    assert code == 0, said
    assert "5 files, all as they were kept" in said
    filled.database.add("subject", {**SUBJECT, "code": "S02"})  # it goes on
    assert files(tmp_path / "copy") == files(filled.folder)
    copy = Project(tmp_path / "copy")
    assert [subject["code"] for subject in copy.database.all("subject")] == ["S01"]
    assert copy.id == filled.id
    copy.close()
    assert (tmp_path / "copy" / "project.db").stat().st_mode & 0o077 == 0
    assert told("backup", filled.folder, tmp_path / "copy")[0] == 2  # it exists
    assert told("backup", filled.folder, filled.folder / "inside")[0] == 2
    assert told("backup", tmp_path, tmp_path / "other")[0] == 2  # no project
    filled.close()


def test_what_is_wrong_is_told_and_not_copied(filled) -> None:
    root, database = filled.folder, filled.database
    filled.path("recordings", "a" * 16, ".h5").write_bytes(b"changed")
    filled.path("recordings", "b" * 16, ".h5").unlink()
    (root / "recordings" / ".surae-0123.part").write_bytes(b"half")
    (root / "fits" / f"{'9' * 16}.json").write_text("left by a kill")
    bad = "INSERT INTO thing VALUES (?, 'recording', 1.0, 0, '{}')"
    database.change("recording", "1" * 16, bad, "1" * 16)
    code, said = told("check", root)
    assert code == 1
    assert "3 entries are wrong" in said
    lines = upkeep.check(root)
    assert sorted(line.split(": ")[0] for line in lines.problems) == [
        f"recording {'1' * 16} is damaged",
        f"recording {'a' * 16}",
        f"recording {'b' * 16}",
    ]
    assert lines.orphans == (f"fits/{'9' * 16}.json", "recordings/.surae-0123.part")
    with pytest.raises(ComputationError, match="cannot copy"):
        upkeep.backup(root, root.parent / "copy")
    assert not (root.parent / "copy").exists()
    assert [path.name for path in root.parent.iterdir()] == ["p"]  # no half copy either
    filled.close()


def test_a_strangers_triggers_are_refused(filled) -> None:
    filled.close()
    with sqlite3.connect(filled.folder / "project.db") as file:
        file.execute("CREATE TRIGGER t AFTER UPDATE ON thing BEGIN DELETE FROM thing; END")
    file.close()
    assert "not surae's" in upkeep.check(filled.folder).problems[0]


def test_a_copy_that_was_killed_is_seen_and_is_no_project(filled, tmp_path) -> None:
    code = (
        "import os, signal, sys\nfrom surae_workbench.web import upkeep\n"
        "upkeep.sha256_of = lambda path: os.kill(os.getpid(), signal.SIGKILL)\n"
        "upkeep.backup(sys.argv[1], sys.argv[2])"
    )
    copy = tmp_path / "copy"
    done = subprocess.run([sys.executable, "-c", code, filled.folder, copy], check=False)
    assert done.returncode == -9
    (half,) = (path for path in tmp_path.iterdir() if path != filled.folder)
    assert half.name == "copy.unfinished"
    with pytest.raises(InputError, match="but no project"):
        Project(half)
    code, said = told("backup", filled.folder, copy)
    assert code == 2
    assert "a backup that was stopped has left" in said
    assert "copy.unfinished; delete that folder" in said
    shutil.rmtree(half)
    assert told("backup", filled.folder, copy)[0] == 0
    assert {path.name for path in tmp_path.iterdir()} == {"p", "copy"}
    filled.close()


def test_a_check_says_how_far_it_is(filled) -> None:
    seen: list[tuple[int, int]] = []
    upkeep.check(filled.folder, lambda *far: seen.append(far))
    assert seen == [(number, 7) for number in range(7)]
    filled.close()


def test_an_older_projects_files_have_no_checksum(filled) -> None:
    id_ = new_id()
    filled.path("fits", id_, ".json").write_text("{}")
    filled.database.add("fit", OTHERS["fit"], id_)
    assert upkeep.check(filled.folder).unsealed == (f"fits/{id_}.json",)
    filled.close()
