"""TOML mappings: scaling, several files, and a clear line for each mistake."""

import math

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.recording import mapping as mapping_module
from surae.recording import read
from surae.recording.mapping import Description
from surae.recording.source import open_source
from surae.trials import trial_files

ROBOT = "Time,crank,load,marker,marker\n0,10,1,a,b\n1,20,2,a,b\n2,30,3,a,b\n"
AMPLIFIER = "time_ms;ch1\n0;100\n500;200\n1000;300\n1500;400\n"
MAPPING = """\
name = "two boxes"
emg = "raw"
fixed = { m = 2, beta = 1.0 }
side = "left"
[channels.angle]
file = "robot.csv"
column = "crank"
unit = "deg"
sign = -1
[channels.torque]
file = "robot.csv"
column = "load"
unit = "Nm"
scale = 2.0
offset = 0.5
sign = -1
[channels.emg_sol]
file = "amplifier.csv"
column = "ch1"
unit = "µV"
[device]
name = "Achilles"
torque_limit = 100
[prepare]
lowpass_hz = 2.5
notch = [50, 150]
"""


@pytest.fixture
def mapping(tmp_path):
    def write(text: str = MAPPING, robot: str = ROBOT):
        (tmp_path / "robot.csv").write_text(robot)
        (tmp_path / "amplifier.csv").write_text(AMPLIFIER)
        path = tmp_path / "trial.toml"
        path.write_text(text)
        return path

    return write


def test_scaling_sign_unit_and_own_time_axes(mapping):
    path = mapping()
    recording = read(path)
    channels = recording.channels
    np.testing.assert_allclose(channels["angle"].values, -np.deg2rad([10, 20, 30]))
    np.testing.assert_array_equal(channels["torque"].values, [-2.5, -4.5, -6.5])
    np.testing.assert_allclose(channels["emg_sol"].values, [1e-4, 2e-4, 3e-4, 4e-4])
    np.testing.assert_array_equal(channels["angle"].time, [0, 1, 2])
    np.testing.assert_array_equal(channels["emg_sol"].time, [0, 0.5, 1, 1.5])
    assert channels["torque"].source == ("robot.csv: load [Nm], scale 2, offset 0.5, sign reversed")
    assert (recording.name, recording.emg, recording.side) == ("two boxes", "raw", "left")
    assert dict(recording.fixed) == {"m": 2.0, "beta": 1.0}
    assert dict(recording.prepare) == {"lowpass_hz": 2.5, "notch": (50, 150)}
    assert dict(recording.device) == {"name": "Achilles", "torque_limit": 100}
    assert [file.path for file in recording.files] == [
        str(path),
        str(path.with_name("robot.csv")),
        str(path.with_name("amplifier.csv")),
    ]


def test_defaults(mapping):
    text = '[channels.angle]\nfile = "robot.csv"\ncolumn = "crank"\nunit = "rad"\n'
    recording = read(mapping("# only the angle\n\n" + text))
    assert (recording.name, recording.emg, recording.side) == ("trial", "raw", None)
    assert not recording.fixed
    assert not recording.prepare


def test_absolute_paths_and_parents_are_allowed(mapping, tmp_path):
    path = mapping()
    inner = tmp_path / "inner"
    inner.mkdir()
    text = MAPPING.replace("robot.csv", "../robot.csv").replace(
        "amplifier.csv", str(tmp_path / "amplifier.csv")
    )
    moved = inner / "trial.toml"
    moved.write_text(text)
    np.testing.assert_array_equal(
        read(moved).channels["emg_sol"].values, read(path).channels["emg_sol"].values
    )


def test_a_csv_column_with_our_name_brings_its_unit(mapping):
    text = '[channels.angle]\nfile = "robot.csv"\ncolumn = "angle_deg"\n'
    robot = ROBOT.replace("crank", "angle_deg")
    assert read(mapping(text, robot)).channels["angle"].values[0] == pytest.approx(math.radians(10))
    with pytest.raises(InputError, match=r"'rad' contradicts .*robot\.csv.*'deg'"):
        read(mapping(text + 'unit = "rad"\n', robot))


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (
            "side",
            "leg",
            [
                "'leg'",
                "side, date, condition, notes, effort, use, name, emg, fixed, device, prepare, "
                "swap, open, time, trial, channels, trials",
            ],
        ),
        ("scale = 2.0", "gain = 2.0", ["channels.torque", "'gain'", "file, column, unit, sign"]),
        ("[channels.torque]", "[channels.moment]", ["channels", "'moment'", "angle, torque, emg"]),
        ("[channels.angle]", "[channels.angular_velocity]", ["channels.angle is missing"]),
        ('"left"', '"links"', ["side", "'links'", "left, right"]),
        ('emg = "raw"', 'emg = "filtered"', ["emg", "'filtered'", "raw, envelope"]),
        ('emg = "raw"', "emg = 1", ["emg: 1", "raw, envelope"]),
        ('name = "two boxes"', "name = 3", ["name: 3", "text"]),
        ("m = 2,", 'm = "two",', ["fixed.m", "'two'", "number"]),
        ("m = 2,", "m = nan,", ["fixed.m", "nan", "finite"]),
        ("m = 2,", "m = true,", ["fixed.m", "True", "number"]),
        ("fixed = { m = 2, beta = 1.0 }", "fixed = 3", ["fixed: 3 is no table"]),
        ("notch = [50, 150]", "notch = 2020-01-01", ["prepare.notch", "list"]),
        ('file = "amplifier.csv"\n', "", ["channels.emg_sol", "file is missing"]),
        ('column = "ch1"\n', "", ["channels.emg_sol", "column is missing"]),
        ('column = "ch1"', "column = 1", ["channels.emg_sol.column: 1"]),
        ('"ch1"', '"ch2"', ["channels.emg_sol", "amplifier.csv", "'ch2'", "'ch1'"]),
        ('"load"', '"weight"', ["channels.torque", "robot.csv", "'weight'", "it has: 'crank'"]),
        ('"load"', '"marker"', ["channels.torque", "robot.csv", "2 columns 'marker'"]),
        ('"amplifier.csv"', '"amp.csv"', ["channels.emg_sol", "amp.csv", "no such file"]),
        ('"amplifier.csv"', '"."', ["channels.emg_sol", "folder"]),
        ('unit = "Nm"\n', "", ["channels.torque", "unit is missing", "Nm, mNm"]),
        ('unit = "Nm"', 'unit = "lbft"', ["channels.torque", "'lbft'", "Nm, mNm"]),
        ("scale = 2.0", "scale = 0", ["channels.torque", "scale is 0"]),
        ("scale = 2.0", "scale = 1e400", ["channels.torque", "scale", "finite"]),
        ("scale = 2.0", "scale = 1e308", ["robot.csv", "'load'", "row 3", "not a finite"]),
        ("offset = 0.5\nsign = -1", "sign = 2", ["channels.torque.sign", "2", "1, -1"]),
        ("[channels.angle]", "[channels.angle", ["not valid TOML", "line 5"]),
        ('name = "two boxes"', "name = " + "[" * 5000, ["not valid TOML"]),
        ("m = 2,", f"m = {'9' * 5000},", ["not valid TOML"]),
        ("m = 2,", f"m = 0x{'f' * 5000},", ["fixed.m", "64 bits"]),
    ],
)
def test_errors_say_where_and_what_is_allowed(mapping, old, new, says):
    assert old in MAPPING
    with pytest.raises(InputError) as caught:
        read(mapping(MAPPING.replace(old, new)))
    text = str(caught.value)
    assert "\n" not in text
    for part in says:
        assert part in text


def test_a_toml_that_is_no_recording(mapping):
    with pytest.raises(InputError, match=r"trial\.toml: no channels.*\[channels\.angle\]"):
        read(mapping('name = "grid"\nmodel = ["muscle"]\n'))
    with pytest.raises(InputError, match="channels: 3 is no table"):
        read(mapping("channels = 3\n"))
    with pytest.raises(InputError, match=r"channels\.angle: 3 is no table"):
        read(mapping("channels = { angle = 3 }\n"))


def test_a_wrong_sample_in_a_described_file(mapping):
    with pytest.raises(InputError, match=r"robot\.csv: column 'load', row 3: nan"):
        read(mapping(robot=ROBOT.replace("20,2", "20,nan")))
    with pytest.raises(InputError, match=r"robot\.csv: column 'Time', row 4: time doesn't"):
        read(mapping(robot=ROBOT.replace("2,30", "1,30")))


def test_a_message_does_not_repeat_a_name_of_any_length(mapping):
    long = "x" * 5000
    for wrong in (f"{long} = 1\n{MAPPING}", MAPPING.replace('"crank"', f'"{long}"')):
        with pytest.raises(InputError, match=r"'x+\.\.\.") as caught:
            read(mapping(wrong))
        assert len(str(caught.value)) < 500


def test_thousands_of_trials_are_looked_through_once(tmp_path, monkeypatch) -> None:
    text = '[channels.angle]\ncolumn = "a"\nfile = "{trial}.csv"\nunit = "deg"\n'
    text += "".join(f'[trials.t{i}]\neffort = "active"\n' for i in range(500))
    (tmp_path / "map.toml").write_text(text)
    for i in range(500):
        (tmp_path / f"t{i}.csv").write_text("x")
    description = Description.of(open_source(tmp_path / "map.toml"))
    read, made = mapping_module.from_plain, []
    monkeypatch.setattr(mapping_module, "from_plain", lambda *a: made.append(1) or read(*a))
    assert len(trial_files(tmp_path, description)) == 500
    assert len(made) <= 1
