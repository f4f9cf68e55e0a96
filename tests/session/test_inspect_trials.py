"""Several files inspected: one mapping for all of them, and where they differ."""

import json
import shutil
import tomllib

import pytest

import surae


@pytest.fixture
def folder(tmp_path, table):
    for name in ("a", "b", "c"):
        text = table().replace("time,crank,load,muscle", "time,Angle (deg),Torque (Nm),EMG_TA (mV)")
        (tmp_path / f"{name}.csv").write_text(text)
    return tmp_path


def test_trials_of_one_layout_get_one_mapping(folder, run):
    done = run("inspect", folder, "--output", "map.toml")
    assert done.code == 0, done.err
    assert "3 trials of this layout: a, b, c" in done.out
    assert "--mapping map.toml --output OUT" in done.out
    toml = tomllib.loads((folder / "map.toml").read_text())
    assert all("file" not in body for body in toml["channels"].values())
    assert toml["name"] == folder.name
    session = surae.session(folder, mapping=folder / "map.toml")
    assert session.fitted == ("a", "b", "c")


def test_the_session_is_called_as_its_folder_wherever_the_mapping_is(folder, run):
    (folder / "S01 left").mkdir()
    for name in ("a", "b"):
        shutil.copy(folder / f"{name}.csv", folder / "S01 left")
    assert run("inspect", "S01 left", "--output", "map.toml").code == 0
    assert tomllib.loads((folder / "map.toml").read_text())["name"] == "S01 left"


def test_what_differs_is_listed_and_written(folder, run):
    text = (folder / "b.csv").read_text()
    (folder / "b.csv").write_text(text.replace("Torque (Nm)", "Torque (Nmm)"))
    (folder / "c.csv").write_text(text.replace("EMG_TA (mV)", "something"))
    (folder / "d.csv").write_text(text.replace("Angle (deg)", "Ankle angle (deg)"))
    (folder / "e.csv").write_text(text)
    done = run("inspect", folder, "--output", "map.toml")
    assert "b: torque is column 'Torque (Nmm)', not 'Torque (Nm)'" in done.out
    assert "b: torque is in Nmm, that of a in Nm" in done.out
    assert "c: no column 'EMG_TA (mV)'" in done.out
    assert "d: angle is column 'Ankle angle (deg)', not 'Angle (deg)'" in done.out
    toml = tomllib.loads((folder / "map.toml").read_text())
    assert toml["trials"]["c"] == {"emg_ta": False}
    assert set(toml["trials"]) == {"b", "c", "d"}
    trials = surae.session(folder, mapping=folder / "map.toml").trials
    assert all(trial.recording is not None for trial in trials)
    first, second = (trial.recording.channels["torque"].values[0] for trial in trials[:2])
    assert second == pytest.approx(1e-3 * first)  # as the heading of its own says


def test_json_lists_the_trials(folder, run):
    found = json.loads(run("inspect", folder, "--json").out)
    assert found["trials"] == ["a", "b", "c"]
    assert found["differences"] == []


def test_parts_of_one_recording_stay_one(tmp_path, run):
    (tmp_path / "robot.csv").write_text("time_s,angle_deg,torque_Nm\n0,1,2\n1,2,3\n2,3,4\n")
    (tmp_path / "emg.csv").write_text("time_s,emg_ta_V\n0,1\n1,2\n2,3\n")
    done = run("inspect", "robot.csv", "emg.csv", "--output", "map.toml")
    assert "trials of this layout" not in done.out
    toml = tomllib.loads((tmp_path / "map.toml").read_text())
    assert toml["channels"]["angle"]["file"] == "robot.csv"
    assert surae.read(tmp_path / "map.toml").channels["emg_ta"].values[0] == 1.0


def test_trials_in_folders_of_their_own(shared, tmp_path, run):
    for name in ("walk36", "run81"):
        shutil.copytree(shared / "gait" / name, tmp_path / name)
    parts = [path.relative_to(tmp_path) for path in tmp_path.rglob("*.sto")]
    done = run("inspect", *parts, "--side", "right", "--output", "map.toml")
    assert done.code == 0, done.err
    toml = tomllib.loads((tmp_path / "map.toml").read_text())
    assert toml["channels"]["torque"]["file"] == "{trial}/id.sto"
    assert toml["name"] == tmp_path.name
    for given in (tmp_path, [tmp_path / part for part in parts]):
        session = surae.session(given, mapping=tmp_path / "map.toml")
        assert session.fitted == ("run81", "walk36")
    assert len(session["walk36"].recording.files) == 4


def test_the_measured_folder(shared, tmp_path, run):
    for part in ("dynamometer", "repeats"):
        for file in (shared / part).glob("*.mat"):
            shutil.copy(file, tmp_path)
    done = run("inspect", tmp_path, "--output", "map.toml")
    assert "11 trials of this layout" in done.out
    text = (tmp_path / "map.toml").read_text()
    assert "Pas_Sho2Long: 'Torque' rises with 'Angle' (r = +0.99): if this trial is passive" in text
    assert "offset = -" not in text  # each has its own, which the preparation takes away
    shown = run("inspect", "Pas_5.mat", "PL_0_01.mat", "--mapping", "map.toml")
    assert shown.code == 0
    assert "Recording 'Pas_5'" in shown.out
    assert "EMG_TA [V]" in shown.out


def test_a_file_that_the_mapping_does_not_fit(folder, run):
    run("inspect", folder, "--output", "map.toml")
    (folder / "other.csv").write_text("time,x\n0,1\n1,2\n")
    done = run("inspect", "a.csv", "other.csv", "--mapping", "map.toml")
    assert done.code == 2
    assert "Recording 'a'" in done.out
    assert "has no column 'Angle (deg)'" in done.out
    assert "1 of 2 files cannot be read so" in done.err
