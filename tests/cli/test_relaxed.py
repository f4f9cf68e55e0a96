"""`surae relaxed`, its file, its page, its figure."""

import json

import pytest

import surae
from relaxed_ankle import measured
from surae.recording import csv_columns, write_csv

LANGUAGES = ("en", "nl", "de", "fr")


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    path = tmp_path_factory.mktemp("relaxed") / "trial.csv"
    write_csv(path, csv_columns(measured()), ["emg: envelope"])
    return path


def test_the_command_writes_what_python_says(run, trial, tmp_path) -> None:
    out = tmp_path / "r.json"
    page = tmp_path / "r.html"
    done = run("relaxed", str(trial), "--angle", "5", "--output", str(out), "--report", str(page))
    assert done.code == 0, done.err
    assert "slow_stiffness@5deg" in done.out
    data = json.loads(out.read_text())
    found = surae.relaxed(trial, angles=(5.0,))
    measure = data["measures"]["passive_stiffness@5deg"]
    assert measure["value"] == found.measures["passive_stiffness@5deg"].value
    assert measure["basis"] == "rest"
    assert measure["unit"] == "Nm/deg"
    assert measure["ci95_device"][0] > measure["ci95"][0] - 0.01
    assert data["measures"]["end_stiffness"]["to_deg"] == pytest.approx(20.0, abs=0.5)
    assert data["grade"] == "adequate"
    assert data["curve"]["trials"][0]["seconds"] > 50.0
    assert "<svg" in page.read_text() or "data:image/svg" in page.read_text()


def test_what_is_no_recording_is_one_line(run, tmp_path) -> None:
    bad = tmp_path / "bad.csv"
    bad.write_text("time_s,angle_rad\n0,0\n1,0\n2,0\n")
    done = run("relaxed", str(bad))
    assert done.code == 2
    assert len(done.err.strip().splitlines()) == 1


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_page_is_in_the_readers_language(trial, tmp_path, language) -> None:
    page = tmp_path / "page.html"
    surae.relaxed(trial).report(page, language=language)
    text = page.read_text()
    heading = {
        "en": "The relaxed ankle",
        "nl": "De ontspannen enkel",
        "de": "Das entspannte Sprunggelenk",
        "fr": "La cheville relâchée",
    }[language]
    assert heading in text
    assert "relaxed/" not in text
    assert "none/" not in text


def test_plot_and_table(trial) -> None:
    found = surae.relaxed(trial)
    axes = found.plot()
    assert axes.get_xlabel().startswith("Angle by the device")
    assert {line.get_label() for line in axes.lines} >= {"relaxed", "back, measured"}
    table = found.to_dataframe()
    assert table.loc["torque_rise", "unit"] == "Nm"
    assert table.loc["torque_rise", "low"] < table.loc["torque_rise", "value"]
    assert "torque_rise" in found._repr_html_()
