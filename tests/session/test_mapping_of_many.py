"""One mapping for many files: which file, what differs in one trial, where the zero is."""

import shutil

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.recording import read
from surae.recording.mapping import Description
from surae.recording.reading import open_mapping

MAPPING = """\
name = "leg A"
side = "left"
date = 2024-05-01
condition = "before"
fixed = { g2 = 0.0, g3 = 0.0, g4 = 0.0 }
[channels.angle]
column = "crank"
unit = "deg"
sign = -1
[channels.torque]
column = "load"
unit = "Nm"
[channels.emg_ta]
column = "muscle"
unit = "mV"
"""


@pytest.fixture
def leg(tmp_path, table):
    """Three trials in one folder, of which the last is called as a comment might be."""
    for number, name in enumerate(("a", "b", "Pas_-5")):
        (tmp_path / f"{name}.csv").write_text(table(torque=5.0 + number))
    return tmp_path


def mapped(folder, text=MAPPING):
    path = folder / "map.toml"
    path.write_text(text)
    return path


def test_each_file_is_a_trial_with_its_own_name(leg):
    mapping = mapped(leg)
    trials = [read(leg / f"{name}.csv", mapping=mapping) for name in ("a", "b", "Pas_-5")]
    assert [trial.name for trial in trials] == ["a", "b", "Pas_-5"]
    assert [float(t.channels["torque"].values[0]) for t in trials] == [5.0, 6.0, 7.0]
    assert all(trial.side == "left" for trial in trials)
    assert [file.name for file in trials[1].files] == ["b.csv", "map.toml"]
    assert trials[1].where.endswith("b.csv")  # messages name the trial's file


def test_files_in_folders_of_their_own(tmp_path, table):
    for trial in ("walk", "run"):
        (tmp_path / trial).mkdir()
        (tmp_path / trial / "robot.csv").write_text(table())
        (tmp_path / trial / "amp.csv").write_text(table(emg=1.0))
    text = MAPPING.replace('column = "crank"', 'file = "{trial}/robot.csv"\ncolumn = "crank"')
    text = text.replace('column = "load"', 'file = "{trial}/robot.csv"\ncolumn = "load"')
    text = text.replace('column = "muscle"', 'file = "{trial}/amp.csv"\ncolumn = "muscle"')
    mapping = mapped(tmp_path, text)
    trial = read(tmp_path / "walk" / "robot.csv", mapping=mapping)
    assert trial.name == "walk"
    assert trial.channels["emg_ta"].source.startswith("amp.csv")
    shutil.copy(tmp_path / "walk" / "robot.csv", tmp_path / "other.csv")
    with pytest.raises(InputError, match=r"other\.csv.*is none of them"):
        read(tmp_path / "other.csv", mapping=mapping)


def patterned(folder, file):
    text = MAPPING.replace("column", f'file = "{file}"\ncolumn')
    return Description.of(open_mapping(mapped(folder, text)))


def test_signs_in_a_pattern_stand_for_themselves(tmp_path, table):
    for name in (
        "[left] walk.csv",
        "l walk.csv",
        "[left] run.csv",
        ".[left] x.csv",
        "._[left] walk.csv",
        "[left] ._a.csv",
    ):
        (tmp_path / name).write_text(table())
    names = {path.name for path in patterned(tmp_path, "[left] {trial}.csv").files(tmp_path)}
    assert names == {"[left] walk.csv", "[left] run.csv", "[left] ._a.csv"}
    assert "._[left] walk.csv" not in {
        path.name for path in patterned(tmp_path, "{trial} walk.csv").files(tmp_path)
    }


@pytest.mark.parametrize("file", ["/data/{trial}.csv", "../{trial}.csv", "{trial}/../x.csv"])
def test_a_pattern_stays_within_its_folder(tmp_path, file):
    with pytest.raises(InputError, match="leads out of the folder of the trials"):
        patterned(tmp_path, file)


def test_what_differs_in_one_trial_is_a_line(leg):
    text = MAPPING + '[trials]\nb.torque.sign = -1\n"Pas_-5".name = "rest"\nb.fixed.m = 1.0\n'
    text += 'a.emg_ta = false\n"Pas_-5".emg_ta.column = "muscle"\n'
    mapping = mapped(leg, text)
    a, b, rest = (read(leg / f"{name}.csv", mapping=mapping) for name in ("a", "b", "Pas_-5"))
    assert float(a.channels["torque"].values[0]) == 5.0
    assert float(b.channels["torque"].values[0]) == -6.0
    assert rest.name == "rest"
    assert "emg_ta" not in a.channels
    assert "emg_ta" in b.channels
    assert dict(b.fixed) == {"g2": 0.0, "g3": 0.0, "g4": 0.0, "m": 1.0}


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("b.torqe.sign = -1", "trials.b: key 'torqe' is not known"),
        ("b.torque = -1", "trials.b.torque is -1; write what differs"),
        (
            "b.effort = 'lazy'",
            "trials.b: effort: 'lazy' is none of: passive, active, isometric, maximal",
        ),
        ("b = 3", "trials.b: 3 is no table"),
        ("b.torque.sign = 2", "trials.b: channels.torque.sign: 2 is none of: 1, -1"),
    ],
)
def test_a_wrong_line_is_named(leg, line, says):
    with pytest.raises(InputError) as caught:
        read(leg / "b.csv", mapping=mapped(leg, f"{MAPPING}[trials]\n{line}\n"))
    assert says in str(caught.value)


def test_a_mapping_of_one_file_serves_the_others_of_its_layout(leg):
    text = MAPPING.replace("column", 'file = "a.csv"\ncolumn')
    mapping = mapped(leg, text)
    assert read(mapping).channels["torque"].values[0] == 5.0
    assert read(leg / "b.csv", mapping=mapping).channels["torque"].values[0] == 6.0


def test_one_file_of_two_is_never_taken_for_all_trials(leg):
    text = MAPPING.replace('column = "crank"', 'file = "a.csv"\ncolumn = "crank"')
    text = text.replace('column = "load"', 'file = "{trial}.csv"\ncolumn = "load"')
    with pytest.raises(InputError, match=r"file 'a\.csv' is one and the same"):
        read(
            leg / "b.csv",
            mapping=mapped(leg, text.replace('column = "mus', 'file="{trial}.csv"\ncolumn = "mus')),
        )


def test_a_mapping_of_many_is_no_recording(leg):
    with pytest.raises(InputError, match=r"file is missing: name the file, or .*--mapping"):
        read(mapped(leg))


def resting(folder, torque, name="rest.csv", swing=0.0):
    """A trial in which nothing happens but the noise of its sensors, and `swing` of torque."""
    time = np.arange(400) / 100
    load = torque + 0.2 * np.random.default_rng(1).standard_normal(400)
    load += swing * np.sin(2 * np.pi * 2 * time)  # over in a quarter of the trial
    lines = [f"{t:.3f},0.0,{v:.6f},0" for t, v in zip(time, load, strict=True)]
    (folder / name).write_text("time,crank,load,muscle\n" + "\n".join(lines))


def test_zero_from_a_quiet_trial(leg):
    resting(leg, 6.0)
    text = MAPPING.replace('unit = "Nm"', 'unit = "Nm"\nsign = -1\nscale = 2.0\nzero = "rest.csv"')
    torque = read(leg / "a.csv", mapping=mapped(leg, text)).channels["torque"]
    assert torque.values[0] == pytest.approx(2.0, abs=0.1)  # -(2·5 - 2·6)
    assert "zero 11.97" in torque.source
    assert "of rest.csv" in torque.source
    mean = read(leg / "rest.csv", mapping=mapped(leg, text)).channels["torque"].values.mean()
    assert mean == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("zero", ['"b.csv"', '"swing.csv"', "[0.0, 1.0]"])
def test_a_zero_in_which_something_happens_is_refused(leg, zero):
    """A movement that comes and goes, which the means of quarters do not show."""
    resting(leg, 6.0, "swing.csv", swing=3.0)
    text = MAPPING.replace('unit = "Nm"', f'unit = "Nm"\nzero = {zero}')
    data = "a.csv" if ".csv" in zero else "swing.csv"
    with pytest.raises(InputError, match=r"'load' is not quiet in .*in which nothing happens"):
        read(leg / data, mapping=mapped(leg, text))


def test_measured_holds_are_quiet_and_movements_are_not(shared, tmp_path):
    for part in ("dynamometer", "repeats"):
        for file in (shared / part).glob("*.mat"):
            shutil.copy(file, tmp_path)
    text = "[channels.angle]\ncolumn='Angle'\nunit='deg'\n[channels.torque]\ncolumn='Torque'\n"
    refused = set()
    for zero in sorted(tmp_path.glob("*.mat")):
        mapping = mapped(tmp_path, f"{text}unit='Nm'\nzero='{zero.name}'\n")
        try:
            read(tmp_path / "PL_50_01.mat", mapping=mapping)
        except InputError:
            refused.add(zero.stem)
    holds = {"Pas_5", "Pas_10", "Pas_-15", "Pas_20"}
    assert refused == {path.stem for path in tmp_path.glob("*.mat")} - holds


def test_zero_from_a_quiet_stretch(tmp_path):
    time = np.arange(400) / 100
    load = np.where(time < 1.0, 7.0, 7.0 + 20 * np.sin(time))
    lines = [f"{t:.3f},{10 * t:.3f},{v:.6f},0" for t, v in zip(time, load, strict=True)]
    (tmp_path / "a.csv").write_text("time,crank,load,muscle\n" + "\n".join(lines))
    text = MAPPING.replace('unit = "Nm"', 'unit = "Nm"\nzero = [0.0, 0.9]')
    torque = read(tmp_path / "a.csv", mapping=mapped(tmp_path, text)).channels["torque"]
    assert torque.values[0] == pytest.approx(0.0, abs=1e-9)
    assert torque.source.endswith("zero 7 ± 0 of 0 to 0.9 s")


@pytest.mark.parametrize(
    ("zero", "says"),
    [
        ("zero = [0.5, 3.0]", "is not quiet"),
        ("zero = [3.0, 0.5]", "is no stretch of time"),
        ("zero = [100.0, 101.0]", "holds no finite samples"),
        ('zero = "none.csv"', "no such file"),
        ("zero = 3.0", "3.0 is none of: a text, a list"),
        ("zero = [0.0, 1.0]\noffset = 2.0", "zero and offset both"),
    ],
)
def test_a_zero_that_cannot_be_one_is_refused(leg, zero, says):
    text = MAPPING.replace('unit = "Nm"', f'unit = "Nm"\n{zero}')
    with pytest.raises(InputError, match=says):
        read(leg / "a.csv", mapping=mapped(leg, text))


def test_commands_take_the_mapping(leg, run):
    mapped(leg)
    done = run("check", "a.csv", "b.csv", "--mapping", "map.toml", "--json")
    assert done.code == 0, done.err
    done = run("convert", "a.csv", "out.h5", "--mapping", "map.toml")
    assert done.code == 0, done.err
    assert read(leg / "out.h5").name == "a"
    done = run("fit", "a.csv", "--mapping", "a.csv")
    assert done.code == 2
    assert "this is no TOML mapping" in done.err
