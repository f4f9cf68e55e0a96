"""What commands take: folders, protocols, raw EMG, one mapping for many; help in groups."""

import json
from pathlib import Path

import numpy as np
import pytest

import surae
from surae.cli.grouped import GROUPS
from surae.cli.session import default_folder
from surae.recording import write_csv

from .conftest import refused
from .test_simulate import columns

MAPPING = """emg = "envelope"
[channels.angle]
file = "first.csv"
column = "winkel"
unit = "deg"
[channels.torque]
file = "first.csv"
column = "moment"
unit = "Nm"
sign = -1
[channels.emg_sol]
file = "first.csv"
column = "kanal 3"
unit = "mV"
[fixed]
g1 = 0.0
g2 = 0.0
g4 = 0.0
"""


@pytest.fixture
def one_layout(tmp_path, trial_csv) -> Path:
    """Three files of a laboratory with its own names, of which one has a mapping."""
    given = columns(trial_csv)
    folder = tmp_path / "leg"
    folder.mkdir()
    for number, name in enumerate(("first", "second", "third")):
        write_csv(
            folder / f"{name}.csv",
            {
                "time_s": given["time_s"],
                "winkel": np.degrees(given["angle_rad"]) * (1.0 - 0.01 * number),
                "moment": -given["torque_Nm"],
                "kanal 3": 1e3 * np.abs(given["emg_sol_V"]),
            },
        )
    (folder / "first.toml").write_text(MAPPING)
    return folder


def test_one_mapping_serves_a_folder_of_one_layout(one_layout) -> None:
    session = surae.session(one_layout)
    assert {trial.name: trial.problem for trial in session.trials} == dict.fromkeys(
        ("first", "second", "third"), ""
    )
    (toml, names), *others = session.same_layout.items()
    assert (Path(toml).name, names, others) == ("first.toml", ("second", "third"), [])
    third = session["third"].recording
    assert third.channels["torque"].source == "third.csv: moment [Nm], sign reversed"


def test_a_file_without_one_is_told_of_the_mapping_beside_it(run, one_layout) -> None:
    done = run("fit", one_layout / "second.csv")
    refused(done, "first.toml describes a file with these columns")
    told = run("check", one_layout / "second.csv", "--mapping", one_layout / "first.toml")
    assert told.code == 0


@pytest.mark.parametrize("change", ["other column", "two opinions", "its own"])
def test_a_mapping_of_other_columns_or_two_that_differ_serve_nobody(one_layout, change) -> None:
    if change == "other column":
        text = MAPPING.replace("kanal 3", "kanal 4")
        (one_layout / "first.toml").write_text(text)
    elif change == "two opinions":
        (one_layout / "other.toml").write_text(MAPPING.replace("sign = -1\n", ""))
    else:
        (one_layout / "first.toml").write_text("[knowledge]\nangle_zero_deg = 3\n")
    with pytest.raises(surae.SuraeError, match=r"say which|missing column|seems to be the angle"):
        surae.read(one_layout / "second.csv")
    if change == "two opinions":  # the file that has its own is read by it
        (one_layout / "other.toml").rename(one_layout / "third.toml")
        (one_layout / "third.csv").unlink()
        session = surae.session(one_layout)
        assert session["second"].recording is None
        assert session.same_layout == {}
    else:
        with pytest.raises(surae.SuraeError, match="no trial can be read"):
            surae.session(one_layout)


@pytest.mark.parametrize(
    ("given", "folder"),
    [(["leg"], "leg-session"), (["leg/"], "leg-session"), (["leg/a.csv", "x.csv"], "leg-session")],
)
def test_results_go_beside_the_trials(monkeypatch, tmp_path, given, folder) -> None:
    (tmp_path / "leg").mkdir()
    monkeypatch.chdir(tmp_path)
    assert Path(default_folder(given)).resolve() == tmp_path / folder


def test_results_of_the_folder_itself_go_beside_it(monkeypatch, tmp_path) -> None:
    (tmp_path / "leg").mkdir()
    monkeypatch.chdir(tmp_path / "leg")
    for given in (".", "a.csv"):
        assert Path(default_folder([given])).resolve() == tmp_path / "leg-session"


def test_a_folder_stands_for_its_recordings(run, one_layout) -> None:
    done = run("check", one_layout, "--mapping", one_layout / "first.toml")
    assert done.code == 0
    for name in ("first", "second", "third"):
        assert name in done.out
    nothing = one_layout / "none"
    nothing.mkdir()
    refused(run("check", nothing), "no recording is there")


def parameters(tmp_path: Path, files: Path) -> Path:
    """A leg's parameters with weights per part of the largest EMG."""
    truth = json.loads((files / "true.json").read_text(encoding="utf-8"))["parameters"]
    path = tmp_path / "p.json"
    path.write_text(json.dumps({"parameters": truth | {f"g{i}": 100.0 for i in range(1, 5)}}))
    return path


def test_a_protocol_is_simulated_as_it_was_written(run, files, tmp_path) -> None:
    assert run("protocol", "sine", "--rate", "64", "--output", "p.csv").code == 0
    done = run(
        "simulate", "p.csv", "--parameters", parameters(tmp_path, files), "--output", "out.csv"
    )
    assert done.code == 0, done.err
    asked, made = columns(Path("p.csv")), columns(Path("out.csv"))
    np.testing.assert_array_equal(made["angle_rad"], asked["angle_rad"])
    np.testing.assert_array_equal(made["emg_sol_1"], asked["emg_sol"])
    assert np.ptp(made["torque_Nm"]) > 1.0
    truth = json.loads((tmp_path / "p.json").read_text())["parameters"]
    np.testing.assert_allclose(made["torque_Nm"], surae.simulate("muscle", truth, "p.csv"))


def test_raw_emg_is_simulated_by_its_envelopes_and_said(run, files, tmp_path) -> None:
    surae.example("ex.csv")
    done = run(
        "simulate", "ex.csv", "--parameters", files / "true.json", "--output", tmp_path / "o.csv"
    )
    assert done.code == 0, done.err
    assert "its EMG is raw: envelopes are used, at 256 Hz" in done.err
    made = columns(tmp_path / "o.csv")
    prepared = surae.prepare(surae.read("ex.csv"))
    np.testing.assert_array_equal(made["time_s"], prepared.time)
    np.testing.assert_array_equal(made["emg_ta_V"], prepared.emg[:, 0])
    truth = json.loads((files / "true.json").read_text(encoding="utf-8"))["parameters"]
    np.testing.assert_allclose(made["torque_Nm"], surae.simulate("muscle", truth, prepared))


@pytest.mark.parametrize("command", ["fit", "session"])
def test_help_has_every_option_in_a_group(run, command) -> None:
    done = run(command, "--help")
    assert done.code == 0
    headings = [line.rstrip(":") for line in done.out.splitlines() if line and line[0] != " "]
    assert [name for name, _ in GROUPS] == [name for name in headings if name in dict(GROUPS)]
    last = done.out.partition("Others:")[2].split()
    assert [word for word in last if word.startswith("--")] == ["--help"]
    assert done.out.count("--seed") == 1
