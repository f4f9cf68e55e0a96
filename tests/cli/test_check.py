"""`surae check`, and what `surae fit` makes of it."""

import json

import pytest

from surae.quality import recording_of
from surae.recording import csv_columns, write_csv


@pytest.fixture
def paths(tmp_path, noisy):
    """A clean recording, one with a wrong sign and one with an offset of the torque."""
    table = csv_columns(recording_of(noisy))
    torque = table["torque_Nm"]
    for name, values in (("clean", torque), ("wrong", -torque), ("offset", torque + 15.0)):
        write_csv(tmp_path / f"{name}.csv", table | {"torque_Nm": values}, ["emg: envelope"])
    return tmp_path / "clean.csv", tmp_path / "wrong.csv", tmp_path / "offset.csv"


def test_findings_are_no_failure_unless_strict(run, paths) -> None:
    clean, wrong, _ = paths
    assert run("check", wrong).code == 0
    assert run("check", wrong, "--strict").code == 1
    assert run("check", clean, "--strict").code == 0


def test_the_screen_has_all_of_it_folded_to_its_width(run, paths, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "110")
    clean, wrong, _ = (path.name for path in paths)
    done = run("check", clean, wrong)
    assert "clean.csv: nothing found" in done.out
    assert "wrong.csv: 1 error" in done.out
    assert "torque-sign" in done.out
    assert "sign = -1" in done.out
    assert max(map(len, done.out.splitlines())) <= 110


def test_json_has_the_keys_of_every_finding(run, paths) -> None:
    data = json.loads(run("check", *paths[:2], "--json").out)
    (finding,) = data["findings"]
    assert finding["code"] == "torque-sign"
    assert finding["recording"] == str(paths[1])
    keys = "code severity channel start_s end_s value message advice"
    assert set(keys.split()) <= set(finding)


@pytest.mark.parametrize("arguments", [(), ("none.csv",), ("clean.csv", "--commanded", "x.csv")])
def test_wrong_use_is_one_line(run, paths, arguments) -> None:
    done = run("check", *arguments)
    assert done.code == 2
    assert len(done.err.strip().splitlines()) == 1


def test_a_strict_fit_refuses_errors(run, paths) -> None:
    done = run("fit", "--model", "muscle", paths[1], "--prepared", "--strict")
    assert done.code == 2
    assert "torque-sign" in done.err
    assert len(done.err.strip().splitlines()) == 1


def test_a_fit_shows_what_was_found(run, paths) -> None:
    done = run("fit", "--model", "muscle", paths[2], "--prepared", "--starts", "1")
    assert done.code == 0
    assert "warning torque-offset" in done.out
    assert done.out.count("`surae check`") == 1
