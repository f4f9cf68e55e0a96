"""Uploads are understood as `surae inspect` understands files, in the same sentences."""

import sys
from pathlib import Path

import pytest

import surae
from surae.api import nothing_mapped
from surae.base.errors import InputError

sys.path.insert(0, str(Path(__file__).parents[1] / "recording"))
import layouts as made
import layouts_more as more

TEXTS = {
    "a column of trials": made.trials(),
    "trials side by side": more.beside("number"),
    "times by their shape": made.timed("Tick"),
    "days": made.timed("Date", 45352.4 + made.TIME / 86400),
    "Spike2": more.spike2(),
    "EMG of no muscle": more.openbci(),
    "EMG alone": made.timed("time_s", names=made.MUSCLES, data=made.EMG),
    "percent": made.timed("Gang %"),
    "keys above the names": "channels = 6\n" + made.timed("Time (s)"),
    "lines below": made.timed("Time (s)", below="END OF FILE\n"),
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_uploads_give_the_sentences_of_the_command_line(browser, tmp_path, text):
    path = tmp_path / "mine.txt"
    path.write_text(text)
    id_ = browser.post("/api/uploads", params={"name": path.name}, content=text).json()["id"]
    answer = browser.get(f"/api/uploads/{id_}/inspect")
    as_the_command_line(answer, path)


def as_the_command_line(answer, path: Path) -> None:
    """Whether an upload's inspection says what `surae inspect` says of the file."""
    try:
        found = surae.inspect(path)
    except InputError as refused:
        assert answer.status_code != 200, answer.text
        said = str(refused).removeprefix(f"{path}")
        assert answer.json()["error"].endswith(said)
        return
    assert answer.status_code == 200, answer.text
    lines = [*found.advice, *found.remarks]
    if not found.roles and not found.open:
        lines.append(nothing_mapped(found).replace(f"{path}", path.name))
    assert answer.json()["notes"][: len(lines)] == lines


CASES = (
    *("emg_unit_too_small", "exports_by_name", "force_for_torque", "lines_below_the_numbers"),
    *("mvc", "no_common_span", "percent_in_another_language", "recordings_in_subfolders"),
    *("resolution_taken_for_fault", "start_times_of_tdms", "text_taken_for_toml"),
    *("time_not_recognised", "trials_in_one_file", "two_clocks_drift", "two_rows_of_names"),
    "unknown_unit_in_heading",
)


@pytest.mark.parametrize("case", CASES)
def test_uploads_of_laboratories_files_give_the_sentences_of_the_command_line(
    browser, shared, case
):
    folder = shared.parent / "cases" / case
    if not folder.is_dir():
        pytest.skip("the sixteen inputs are not here")
    files = [each for each in sorted(folder.rglob("*")) if each.is_file() and each.suffix != ".md"]
    assert files
    for path in files:
        content = path.read_bytes()
        upload = browser.post("/api/uploads", params={"name": path.name}, content=content)
        as_the_command_line(browser.get(f"/api/uploads/{upload.json()['id']}/inspect"), path)


def test_uploads_that_belong_together_say_what_the_command_line_says(browser, shared):
    folder = shared.parent / "cases" / "no_common_span"
    if not folder.is_dir():
        pytest.skip("the sixteen inputs are not here")
    paths = [folder / "robot.csv", folder / "emg.csv"]
    first, second = (
        browser.post("/api/uploads", params={"name": p.name}, content=p.read_bytes()).json()["id"]
        for p in paths
    )
    answer = browser.get(f"/api/uploads/{first}/inspect", params={"also": [second]})
    assert answer.status_code == 200, answer.text
    advice = list(surae.inspect(paths).advice)
    assert any("share no span" in line for line in advice)
    assert answer.json()["notes"][: len(advice)] == advice


@pytest.mark.parametrize("text", [made.trials(), more.beside("suffix")])
def test_each_trial_of_a_file_is_imported(browser, text):
    id_ = browser.post("/api/uploads", params={"name": "leg.csv"}, content=text).json()["id"]
    told = browser.get(f"/api/uploads/{id_}/inspect").json()
    names = [one["name"] for one in told["trials"]]
    assert names == ["leg-1", "leg-2", "leg-3"]
    lengths = []
    for one in told["trials"]:
        mapping = told["mapping"] | one
        for channel in mapping["channels"].values():
            channel["unit"] = channel["unit"] or "mV"
        answer = browser.post("/api/imports/preview", json={"mapping": mapping})
        assert answer.status_code == 200, answer.text
        assert answer.json()["name"] == one["name"]
        lengths.append(answer.json()["duration_s"])
        assert browser.post("/api/imports", json={"mapping": mapping}).status_code < 300
    assert len(set(lengths)) == 1  # none is joined with another


def test_a_file_of_one_trial_has_none_to_choose(browser):
    text = made.timed("Time (s)")
    id_ = browser.post("/api/uploads", params={"name": "leg.csv"}, content=text).json()["id"]
    assert browser.get(f"/api/uploads/{id_}/inspect").json()["trials"] == []
