"""`surae inspect`: what it lists, the mapping it writes, and that the fit takes it."""

import json
import tomllib

import numpy as np
import pytest

from surae import load
from surae.recording import write_csv

from .conftest import refused


def settled(path, **changes):
    """The user's part: confirm what the mapping asks for."""
    text = path.read_text(encoding="utf-8")
    for old, new in changes.values():
        assert text.count(old) >= 1
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")


def test_a_csv_of_ours(files, run):
    done = run("inspect", "trial.csv")
    assert (done.code, done.err) == (0, "")
    assert "emg_sol_V" in done.out
    assert "torque = torque_Nm (stated" in done.out
    assert "which direction" not in done.out  # names of our own say it


def test_headings_are_shown_as_they_are(files, run):
    time = np.arange(200) / 100.0
    write_csv("lab.csv", {"time": time, "Hoek [deg]": np.sin(time), "x [/b]": np.cos(time)})
    done = run("inspect", "lab.csv")
    assert (done.code, done.err) == (0, "")
    assert "Hoek [deg]   deg " in done.out
    assert "x [/b]" in done.out


def test_json(files, run):
    done = run("inspect", "trial.csv", "--json")
    data = json.loads(done.out)
    role = data["roles"]["emg_ta"]
    assert (role["file"], role["column"]) == ("trial.csv", "emg_ta_V")
    assert data["missing"] == []
    assert data["channels"][0]["rate_hz"] == pytest.approx(48.0)


def test_several_files_make_one_mapping_that_fits(files, run):
    table = np.genfromtxt("trial.csv", delimiter=",", names=True)
    time = table["time_s"]
    write_csv("motion.csv", {"time": time, "AnkleAngle": np.rad2deg(table["angle_rad"])})
    write_csv("force.csv", {"time": time, "Torque": -table["torque_Nm"]})
    emg = {"TA": "emg_ta_V", "LG": "emg_gl_V", "SOL": "emg_sol_V", "MG": "emg_gm_V"}
    write_csv("emg.csv", {"time": time, **{name: table[of] for name, of in emg.items()}})
    done = run("inspect", "motion.csv", "force.csv", "emg.csv", "--output", "map.toml")
    assert done.code == 0, done
    assert "mapping: map.toml" in done.out
    refused(
        run("fit", "--model", "muscle", "map.toml", "--prepared"), "channels.angle: unit is missing"
    )
    settled(
        files / "map.toml",
        angle=('# unit = "rad"', 'unit = "deg"'),
        torque=('# unit = "Nm"', 'unit = "Nm"'),
        emg=('# unit = "V"', 'unit = "V"'),
        sign=("sign = 1  # check: 1 if it is positive when", "sign = -1  # it is negative when"),
    )
    done = run(
        "fit",
        "--model",
        "muscle",
        "map.toml",
        "--prepared",
        "--starts",
        "2",
        "--output",
        "again.json",
    )
    assert done.code == 0, done
    again, first = load("again.json"), load("fit.json")
    for name, value in first.values.items():
        assert again.values[name] == pytest.approx(value, rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("nothing.csv",), "there is no such file"),
        (("trial.csv", "trial.csv"), "given twice"),
        (("trial.csv", "--side", "up"), "use one of: left, right"),
        (("trial.csv", "--output", "map.csv"), "must end in .toml"),
        (("trial.csv", "--output", "no/map.toml"), "there is no folder"),
        (("fit.json",), "fit.json"),
        ((), "Missing argument"),
    ],
)
def test_wrong_use_is_one_line(files, run, arguments, says):
    refused(run("inspect", *arguments), says)


def test_the_dynamometers_passive_and_active_trials(shared, run, tmp_path):
    """Inspect → mapping → joint fit, with signs as the passive trial settles them."""
    folder = shared / "dynamometer"
    for name in ("Pas_Sho2Long", "PL_50_01"):
        done = run("inspect", folder / f"{name}.mat", "--output", f"{name}.toml")
        assert done.code == 0, done
        assert "emg_ta = EMG_TA" in done.out
        settled(
            tmp_path / f"{name}.toml",
            sign=("sign = 1 ", "sign = -1 "),
            zero=("# offset = 0.0  # Nm", "offset = 4.0  # Nm"),
        )
        toml = tomllib.loads((tmp_path / f"{name}.toml").read_text(encoding="utf-8"))
        assert toml["fixed"] == {"g2": 0.0, "g3": 0.0, "g4": 0.0}
        assert ("offset" in toml["channels"]["emg_ta"]) == (name == "Pas_Sho2Long")
    done = run(
        "fit",
        "--model",
        "muscle",
        "Pas_Sho2Long.toml",
        "PL_50_01.toml",
        "--starts",
        "1",
        "--output",
        "f.json",
    )
    assert done.code == 0, done
    fit = load("f.json")
    vaf = {recording.name: recording.vaf for recording in fit.assessment.recordings}
    assert vaf["Pas_Sho2Long"] > 99.0
    assert vaf["PL_50_01"] > 98.0
    assert fit.status in ("converged", "at-bounds")


@pytest.mark.parametrize("wrong", ["angle", "torque"])
def test_the_wrong_direction_does_not_fit_the_passive_trial(shared, run, tmp_path, wrong):
    run("inspect", shared / "dynamometer" / "Pas_Sho2Long.mat", "--output", "m.toml")
    marks = {"angle": "sign = 1  # check: 1 if dorsi", "torque": "sign = 1  # check: 1 if it is"}
    (right,) = {"angle", "torque"} - {wrong}
    settled(tmp_path / "m.toml", sign=(marks[right], marks[right].replace("= 1 ", "= -1 ")))
    # Without g1 = 0 the amplifier's noise, rectified, would stand in for a constant force.
    done = run(
        "fit",
        "--model",
        "muscle",
        "m.toml",
        "--fixed",
        "g1=0",
        "--starts",
        "2",
        "--output",
        "f.json",
    )
    assert done.code == 0, done
    assert load("f.json").vaf < 70.0


def test_measured_gait_files(shared, run, tmp_path):
    files = [shared / "gait" / "walk36" / f"{name}.sto" for name in ("ik", "id", "emgFilt")]
    done = run("inspect", *files, "--output", "m.toml")
    assert done.code == 0, done
    assert "side = right" in done.out
    mine = tomllib.loads((tmp_path / "m.toml").read_text(encoding="utf-8"))
    theirs = tomllib.loads((shared / "gait" / "walk36.toml").read_text(encoding="utf-8"))
    assert mine["emg"] == theirs["emg"]
    for role, entry in theirs["channels"].items():
        assert mine["channels"][role]["column"] == entry["column"]
        assert mine["channels"][role]["unit"] == entry["unit"]
