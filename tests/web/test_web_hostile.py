"""What a stranger's project may say, and files of a project that were exchanged."""

import re
import shutil
from pathlib import Path

import pytest

import surae
from surae.recording import write_hdf5
from surae.report import part_of
from surae.report.output import write_blocks
from web.hostile import ATTACK, blocks, hostile_project

#: What would run, leave or ask elsewhere if it stood so in a page.
LIVE = re.compile(r"<meta[^>]*refresh|<img[^>]*attack|<script>document|<base|javascript:|[^/]49")


@pytest.fixture(scope="module")
def kept(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("kept") / "trial.h5"
    write_hdf5(path, surae.example().crop(0.0, 3.0))
    return path


def test_a_part_of_a_page_is_what_it_says_and_runs_nothing() -> None:
    shown = part_of(**blocks())
    assert not LIVE.search(shown.replace(";49", "")), LIVE.search(shown)
    assert shown.count("</script") == 1
    assert "attack.invalid/seen.png" not in shown


def test_a_page_to_keep_runs_nothing_and_writes_only_itself(tmp_path) -> None:
    made = {key: value for key, value in blocks().items() if key != "translated"}
    folder = tmp_path / "a" / "b" / "c"
    folder.mkdir(parents=True)
    write_blocks(folder / "leg.html", **made)
    text = (folder / "leg.html").read_text(encoding="utf-8")
    assert '<meta http-equiv="refresh' not in text
    assert "<script>document" not in text
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["leg.html"]


def test_pages_of_a_hostile_project_say_its_names_and_nothing_else(serve, tmp_path, kept) -> None:
    ids = hostile_project(tmp_path / "project", kept)
    browser = serve().browser()
    pages = ("/", "/recordings/{recording}", "/sessions/{session}", "/fit", "/analyse", "/cohort")
    for page in pages:
        answer = browser.get(page.format(**ids))
        assert answer.status_code == 200, page
        found = LIVE.search(re.sub(r"\d49|49\d|;49", "", answer.text))
        assert not found or "attack" not in answer.text[found.start() : found.end() + 80], page
        assert '<meta http-equiv="refresh' not in answer.text, page
        assert ATTACK not in answer.text, page


def test_files_that_were_exchanged_are_refused_when_they_are_used(serve, tmp_path, trial) -> None:
    server = serve()
    browser = server.browser()
    one = browser.recording(trial)
    other = browser.recording(trial)
    project = server.bench.project
    files = [project.file("recording", id_) for id_ in (one, other)]
    files[0].write_bytes(files[0].read_bytes() + b"\0")
    shutil.copy(files[1], tmp_path / "kept.h5")
    files[1].unlink()
    shutil.copy(files[0], files[1])
    for id_ in (one, other):
        answer = browser.get(f"/api/recordings/{id_}/window")
        assert answer.status_code == 409
        assert "not the one that was kept" in answer.json()["error"]
    shutil.copy(tmp_path / "kept.h5", files[1])
    assert browser.get(f"/api/recordings/{other}/window").status_code == 200
