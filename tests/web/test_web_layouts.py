"""Uploads are understood as `surae inspect` understands files, in the same sentences."""

import sys
from pathlib import Path

import pytest

import surae
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
    if answer.status_code == 200:
        advice = list(surae.inspect(path).advice)
        assert answer.json()["notes"][: len(advice)] == advice
        return
    with pytest.raises(InputError) as refused:
        surae.inspect(path)
    assert answer.json()["error"].endswith(str(refused.value).removeprefix(f"{path}"))


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
