"""Inspections, and the mappings that follow from them."""

import re
import tomllib

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.base.files import write_atomic
from surae.recording import inspect, mapping_text, read, write_csv
from surae.recording.emg_kind import contradiction, emg_contradictions, look_of


def write_mapping(inspection, path):
    write_atomic(path, mapping_text(inspection, path.parent))


def emg(n=4000, rate=2000.0, seed=0, offset=0.0):
    rng = np.random.default_rng(seed)
    burst = 1.0 + np.sin(2 * np.pi * np.arange(n) / rate) ** 2
    return offset + 1e-4 * burst * rng.standard_normal(n)


@pytest.fixture
def dynamometer(tmp_path):
    """Columns of somebody else's: names, but no units."""
    time = np.arange(4000) / 2000.0
    angle = 20.0 * np.sin(2 * np.pi * time)
    table = {"time": time, "Angle": angle, "Torque": -0.3 * angle - 5.0, "EMG_TA": emg()}
    write_csv(tmp_path / "trial.csv", table | {"Trigger": np.zeros(4000)})
    return tmp_path / "trial.csv"


def test_channels_roles_and_what_is_missing(dynamometer):
    inspection = surae.inspect(dynamometer)
    assert [channel.column for channel in inspection.channels] == [
        "Angle",
        "Torque",
        "EMG_TA",
        "Trigger",
    ]
    assert {role: channel.column for role, channel in inspection.roles.items()} == {
        "angle": "Angle",
        "torque": "Torque",
        "emg_ta": "EMG_TA",
    }
    assert inspection.missing == ("emg_gl", "emg_sol", "emg_gm")
    assert inspection.emg == "raw"
    angle = inspection.roles["angle"]
    assert (angle.n, angle.rate_hz, angle.start_s) == (4000, pytest.approx(2000.0), 0.0)
    assert (angle.low, angle.high) == (pytest.approx(-20.0), pytest.approx(20.0))
    assert "opposite signs" in inspection.direction
    assert any("emg_gl, emg_sol, emg_gm" in line for line in inspection.advice)
    with pytest.raises(AttributeError):
        inspection.emg = "envelope"


def test_an_unknown_unit_is_left_to_the_user(dynamometer):
    inspection = inspect(dynamometer)
    write_mapping(inspection, dynamometer.with_name("map.toml"))
    text = dynamometer.with_name("map.toml").read_text(encoding="utf-8")
    toml = tomllib.loads(text)
    assert toml["emg"] == "raw"
    assert toml["fixed"] == {"g2": 0.0, "g3": 0.0, "g4": 0.0}
    assert "unit" not in toml["channels"]["torque"]
    assert '# unit = "rad"  # state it: rad, deg' in text
    with pytest.raises(InputError, match=r"channels\.angle: unit is missing"):
        read(dynamometer.with_name("map.toml"))


def test_inspect_map_read(dynamometer):
    path = dynamometer.with_name("map.toml")
    text = mapping_text(inspect(dynamometer), dynamometer.parent)
    assert text.count("sign = 1  # check") == 2
    text = text.replace('# unit = "rad" ', 'unit = "deg" ').replace('# unit = "Nm"', 'unit = "Nm"')
    path.write_text(text.replace('# unit = "V"', 'unit = "V"'), encoding="utf-8")
    recording = read(path)
    assert recording.emg == "raw"
    assert recording.channels["angle"].values.max() == pytest.approx(np.deg2rad(20.0))
    np.testing.assert_array_equal(recording.channels["emg_ta"].values, emg())


def test_raw_emg_on_an_offset_gets_it_taken_away(tmp_path):
    time = np.arange(4000) / 2000.0
    table = {"time_s": time, "angle_deg": np.sin(time), "torque_Nm": time}
    write_csv(tmp_path / "t.csv", table | {"emg_ta_V": emg(offset=0.02)})
    inspection = inspect(tmp_path / "t.csv")
    assert inspection.emg == "raw"
    toml = tomllib.loads(mapping_text(inspection, tmp_path))
    assert toml["channels"]["emg_ta"]["offset"] == pytest.approx(-0.02, abs=1e-5)
    write_mapping(inspection, tmp_path / "m.toml")
    signal = read(tmp_path / "m.toml").channels["emg_ta"].values
    assert abs(signal.mean()) < 1e-7
    surae.prepare(read(tmp_path / "m.toml"))  # which refuses raw EMG without a negative sample


@pytest.mark.parametrize(
    ("signal", "kind"),
    [
        (emg(), "raw"),
        (emg(offset=0.02), "raw"),
        (emg(offset=-0.02), "raw"),
        (-np.abs(emg()), None),
        (np.abs(np.sin(np.linspace(0, 9, 4000))), "envelope"),
        (emg(offset=0.02) + 0.005 * np.sin(np.linspace(0, 9, 4000)), "raw"),
        (0.3 + 0.01 * np.sin(np.linspace(0, 60, 4000)), "envelope"),
        (np.abs(emg()), None),
        (np.zeros(4000), None),
    ],
)
def test_what_emg_looks_like(tmp_path, signal, kind):
    time = np.arange(4000) / 2000.0
    write_csv(tmp_path / "t.csv", {"time_s": time, "angle_rad": time, "emg_ta_V": signal})
    assert inspect(tmp_path / "t.csv").emg == kind


def test_what_a_csv_states_of_its_emg_is_taken(tmp_path):
    time = np.arange(4000) / 2000.0
    table = {"time_s": time, "angle_rad": time, "emg_ta_V": np.abs(emg())}
    write_csv(tmp_path / "t.csv", table, ["emg: envelope"])
    inspection = inspect(tmp_path / "t.csv")
    assert (inspection.emg, inspection.emg_rule) == ("envelope", "as the file states")


def test_emg_that_is_declared_wrongly_is_named_in_one_set_of_words(tmp_path):
    time = np.arange(4000) / 2000.0
    smooth = 1e-4 * np.abs(np.sin(np.linspace(0, 9, 4000)))
    for signal, declared, says in (
        (smooth, "raw", r"declared raw but looks like an envelope .*# emg: envelope"),
        (emg(), "envelope", r"declared an envelope but looks raw .*# emg: raw"),
    ):
        table = {"time_s": time, "angle_rad": time, "emg_ta_V": signal}
        write_csv(tmp_path / "t.csv", table, [f"emg: {declared}"])
        (line,) = [line for line in inspect(tmp_path / "t.csv").advice if "declared" in line]
        assert re.search(says, line)
        assert emg_contradictions(read(tmp_path / "t.csv")) == {
            "emg_ta": line.replace("'emg_ta_V'", "emg_ta")
        }
    for signal, declared in ((smooth, "envelope"), (emg(), "raw"), (np.abs(emg()), "envelope")):
        table = {"time_s": time, "angle_rad": time, "emg_ta_V": signal}
        write_csv(tmp_path / "t.csv", table, [f"emg: {declared}"])
        assert emg_contradictions(read(tmp_path / "t.csv")) == {}


def columns(tmp_path, name, *names):
    time = np.arange(50) / 100.0
    write_csv(tmp_path / name, {"time_s": time, **{each: np.sin(time) for each in names}})
    return tmp_path / name


def test_both_legs_leave_the_roles_open_until_the_side_is_said(tmp_path):
    names = ("ankle_angle_r", "ankle_angle_l", "ankle_moment_r", "ankle_moment_l")
    path = columns(tmp_path, "t.csv", *names)
    inspection = inspect(path)
    assert inspection.side is None
    assert set(inspection.open) == {"angle", "torque"}
    assert any("--side" in line for line in inspection.advice)
    assert "angle" not in tomllib.loads(mapping_text(inspection, tmp_path)).get("channels", {})
    left = inspect(path, side="left")
    assert left.roles["angle"].column == "ankle_angle_l"
    assert tomllib.loads(mapping_text(left, tmp_path))["side"] == "left"
    with pytest.raises(InputError, match="side 'both' is not known; use one of: left, right"):
        inspect(path, side="both")


def test_the_side_follows_from_channels_of_one_leg_only(tmp_path):
    path = columns(tmp_path, "t.csv", "ankle_angle_r", "ankle_angle_l", "tib_ant_r")
    inspection = inspect(path)
    assert inspection.side == "right"
    assert "emg_ta" in inspection.side_rule
    assert inspection.roles["angle"].column == "ankle_angle_r"


def test_two_plain_candidates_are_never_decided(tmp_path):
    inspection = inspect(columns(tmp_path, "t.csv", "Angle", "Position", "TA"))
    assert [channel.column for channel in inspection.open["angle"]] == ["Angle", "Position"]
    assert inspection.roles.keys() == {"emg_ta"}


def test_a_channel_by_its_unit_alone_is_only_offered(tmp_path):
    path = columns(tmp_path, "t.csv", "angle_rad")
    (tmp_path / "g.sto").write_text("x\ninDegrees=no\nendheader\ntime\tGastroc\n0\t1\n1\t2\n")
    inspection = inspect([path, tmp_path / "g.sto"])
    assert [channel.column for channel in inspection.open["emg_gl"]] == ["Gastroc"]
    assert "emg_gl" not in inspection.missing
    text = mapping_text(inspection, tmp_path)
    assert "# emg_gl is open" in text
    assert "emg_gl" not in tomllib.loads(text)["channels"]


def test_channels_that_cannot_be_used_say_why(tmp_path):
    (tmp_path / "t.csv").write_text(
        "time_s,angle_rad,note,TA,TA\n0,1,a,1,1\n1,2,b,2,2\n", encoding="utf-8"
    )
    inspection = inspect(tmp_path / "t.csv")
    remarks = {channel.column: channel.remark for channel in inspection.channels}
    assert "not a number" in remarks["note"]
    assert "2 columns have this name" in remarks["TA"]
    assert inspection.unusable == {"emg_ta": "'TA': 2 columns have this name: rename one"}
    assert "emg_ta" not in inspection.missing


def test_samples_that_are_no_numbers_are_counted(tmp_path):
    (tmp_path / "t.csv").write_text("time_s,angle_rad\n0,1\n1,nan\n2,3\n", encoding="utf-8")
    channel = inspect(tmp_path / "t.csv").channels[0]
    assert channel.remark == "row 3: nan is not a finite number (1 unreadable sample, 2 s)"
    assert not channel.usable
    assert (channel.low, channel.high) == (1.0, 3.0)


def test_a_mapping_and_nothing_are_refused(tmp_path):
    (tmp_path / "m.toml").write_text('name = "x"\n', encoding="utf-8")
    with pytest.raises(InputError, match="mapping already"):
        inspect(tmp_path / "m.toml")
    with pytest.raises(InputError, match="no file"):
        inspect([])


def test_the_mapping_finds_files_from_its_own_folder(tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "maps").mkdir()
    path = columns(tmp_path / "data", 'a "b".csv', "angle_rad", "torque_Nm")
    write_mapping(inspect(path), tmp_path / "maps" / "m.toml")
    recording = read(tmp_path / "maps" / "m.toml")
    assert recording.channels.keys() == {"angle", "torque"}


def test_whatever_the_names_a_mapping_is_toml(tmp_path):
    from hypothesis import given, settings
    from hypothesis import strategies as st

    letters = st.characters(blacklist_categories=("Cs",), blacklist_characters="\n\r")
    path = tmp_path / "t.sto"

    @settings(max_examples=150)
    @given(st.lists(st.text(letters, min_size=1, max_size=12), min_size=1, max_size=4))
    def check(words):
        names = ["time", "ankle_angle", *(word.replace("\t", " ") for word in words)]
        path.write_text(
            "x\nendheader\n" + "\t".join(names) + "\n" + "\t".join("0" * len(names)) + "\n",
            encoding="utf-8",
        )
        try:
            inspection = inspect(path)
        except InputError:
            return
        text = mapping_text(inspection, tmp_path)
        assert isinstance(tomllib.loads(text), dict)

    check()


def test_as_plain_data(dynamometer):
    data = inspect(dynamometer).to_json()
    angle = data["roles"]["angle"]
    assert (angle["file"], angle["column"]) == (str(dynamometer), "Angle")
    assert data["channels"][1]["guess"]["roles"] == ["torque"]
    assert data["channels"][3]["guess"] is None
    assert data["missing"] == ["emg_gl", "emg_sol", "emg_gm"]


def test_an_emg_without_a_muscle_is_offered_for_every_muscle(tmp_path):
    time = np.arange(4000) / 2000.0
    write_csv(tmp_path / "t.csv", {"time_s": time, "angle_rad": time, "EMG 1": emg()})
    inspection = inspect(tmp_path / "t.csv")
    assert inspection.open.keys() == {"emg_ta", "emg_gl", "emg_sol", "emg_gm"}
    assert inspection.emg == "raw"
    assert sum("are open: 'EMG 1'" in line for line in inspection.advice) == 1
    assert "fixed" not in tomllib.loads(mapping_text(inspection, tmp_path))


@pytest.mark.parametrize("size", [5e-324, 1e-300, 1.0, 1e300, 1.7e308])
def test_absurd_numbers_are_no_accident(tmp_path, size):
    time = np.arange(400) / 1000.0
    wave = size * np.sin(300 * time)
    table = {"time_s": time, "angle_rad": wave, "torque_Nm": -wave, "emg_ta_V": wave / 2 + size / 2}
    write_csv(tmp_path / "t.csv", table)
    toml = tomllib.loads(mapping_text(inspect(tmp_path / "t.csv"), tmp_path))
    assert np.isfinite(toml["channels"]["emg_ta"].get("offset", 0.0))


def test_units_in_headings_are_units_that_the_file_states(tmp_path):
    time = np.arange(4000) / 2000.0
    angle = 20.0 * np.sin(2 * np.pi * time)
    table = {"Time (s)": time, "Angle (deg)": angle, "Moment [N.m]": angle, "TA (mV)": 1e3 * emg()}
    write_csv(tmp_path / "lab.csv", table)
    inspection = inspect(tmp_path / "lab.csv")
    assert {role: channel.known_unit for role, channel in inspection.roles.items()} == {
        "angle": "deg",
        "torque": "Nm",
        "emg_ta": "mV",
    }
    write_mapping(inspection, tmp_path / "map.toml")
    recording = read(tmp_path / "map.toml")
    np.testing.assert_allclose(recording.channels["angle"].values, np.radians(angle), atol=1e-12)
    np.testing.assert_allclose(recording.channels["emg_ta"].values, emg(), rtol=1e-9)
    text = (tmp_path / "map.toml").read_text(encoding="utf-8")
    (tmp_path / "map.toml").write_text(text.replace('unit = "deg"', 'unit = "rad"'))
    with pytest.raises(InputError, match=r"unit 'rad' contradicts .* states 'deg'"):
        read(tmp_path / "map.toml")


def c3d_of(tmp_path, labels, descriptions, signals):
    import ezc3d

    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    analog = file["parameters"]["ANALOG"]
    analog["RATE"]["value"] = [1000.0]
    analog["LABELS"]["value"], analog["UNITS"]["value"] = labels, ["V"] * len(labels)
    analog["DESCRIPTIONS"] = {
        "type": -1,
        "description": "",
        "is_locked": False,
        "value": descriptions,
    }
    file["data"]["analogs"] = np.stack(signals)[None]
    file["data"]["points"] = np.ones((4, 0, len(signals[0]) // 10))
    file.write(str(tmp_path / "x.c3d"))
    return inspect(tmp_path / "x.c3d")


def test_the_descriptions_of_a_c3d_say_roles_and_dead_inputs_are_told_apart(tmp_path):
    rng = np.random.default_rng(3)
    labels = [f"Voltage.{k}" for k in range(1, 5)]
    signals = [np.zeros(1000), 1e-4 * rng.normal(size=1000), np.zeros(1000), np.zeros(1000)]
    signals[3][::7] = 1e-6  # the last step of a converter
    inspection = c3d_of(tmp_path, labels, ["Analog EMG::Voltage [1,1]"] * 4, signals)
    assert {c.column for c in inspection.open["emg_sol"]} == {"Voltage.2"}
    assert [c.alive for c in inspection.channels] == [False, True, False, False]
    assert "not connected?" in inspection.channels[0].remark
    assert not {"emg_ta", "emg_sol"} & {*inspection.missing}
    described = ["Analog EMG::Soleus", "Tibialis anterior", "x", "y"]
    named = c3d_of(tmp_path, labels, described, [*signals[1:2]] * 4)
    assert named.roles["emg_sol"].column == "Voltage.1"
    assert named.roles["emg_ta"].column == "Voltage.2"
    assert "in its description" in named.roles["emg_sol"].guess.rule


@pytest.mark.parametrize(
    ("name", "data", "says"),
    [
        ("x.adicht", b"\0" * 200, "LabChart.*MATLAB"),
        ("x.smr", b"\0\0(C) CED 87" + b"\0" * 100, "Spike2"),
        ("x.npy", b"\x93NUMPY\x01\0" + b"\0" * 100, "savetxt"),
        ("x.csv.gz", b"\x1f\x8b\x08\0" + b"\0" * 100, "unpack"),
        ("x.pkl", b"\x80\x04\x95" + b"\0" * 100, "may run code"),
        ("x.vhdr", b"Brain Vision Data Exchange Header File Version 1.0\n", "EDF"),
    ],
)
def test_what_is_not_read_is_named_with_how_to_export_it(tmp_path, name, data, says):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match=says):
        inspect(tmp_path / name)


def test_columns_of_a_matrix_without_names_ask_which_muscle_they_are(tmp_path):
    from scipy.io import savemat

    time = np.arange(0.0, 4.0, 1 / 500)
    noise = np.random.default_rng(1).standard_normal((len(time), 4))
    moved = {"angle": 0.3 * np.sin(time), "torque": 5.0 * np.cos(time), "fs": 500.0}
    savemat(tmp_path / "trial.mat", {**moved, "emg": 1e-4 * noise})
    asked = [line for line in inspect(tmp_path / "trial.mat").advice if "which muscle" in line]
    assert len(asked) == 1
    assert "TA, SOL, GM, GL that of its figures" in asked[0]
    named = {f"emg_{m}": 1e-4 * noise[:, k] for k, m in enumerate(("ta", "gl", "sol", "gm"))}
    savemat(tmp_path / "named.mat", {**moved, **named})
    assert not any("which muscle" in line for line in inspect(tmp_path / "named.mat").advice)


def test_an_envelope_at_rest_that_answers_a_few_stretches_is_no_raw_emg() -> None:
    """The recorder's noise on a level, and four bursts: raw EMG goes down as far as up."""
    rng, time = np.random.default_rng(7), np.arange(0.0, 35.0, 1 / 128)
    noise = 2.7e-6 * (1.0 + 0.08 * rng.standard_normal(len(time)))
    bursts = sum(np.exp(-0.5 * ((time - at) / 0.15) ** 2) for at in (5.0, 13.0, 21.0, 29.0))
    envelope = look_of(time, noise + 3e-5 * bursts)
    assert contradiction("emg_gl", envelope, "envelope") == ""
    raw = look_of(time, 2e-4 + 3e-5 * bursts * rng.standard_normal(len(time)) + noise)
    assert raw.kind == "raw"
