"""Further siblings of the kinds of layouts: what differs in separator, language, unit or naming."""

import io

import layouts as made
import numpy as np
import pytest
from layouts import ANGLE, DATA, EMG, MUSCLES, OURS, RATE, THEIRS, TIME, TORQUE, N, text, timed

from surae.base.errors import InputError
from surae.recording import inspect, mapping_text, read
from surae.recording.reading import data_files_below, read_trials


def said(*paths) -> str:
    """All that an inspection has to say."""
    found = inspect(paths)
    return " ".join((*found.advice, *(channel.remark for channel in found.channels)))


def stamped(stamps, name="Time", names=THEIRS, data=DATA, between=",") -> str:
    """The trial with stamps that are texts."""
    rows = [
        between.join([at, *(f"{x:.6g}" for x in row)]) for at, row in zip(stamps, data, strict=True)
    ]
    return "\n".join([between.join([name, *names]), *rows]) + "\n"


# Starts of streams.

ROBOT = {"ankle_angle_deg": ANGLE, "ankle_torque_Nm": TORQUE}
ELECTRODES = {f"emg_{m.lower()}_mV": EMG[:, k] for k, m in enumerate(MUSCLES)}


def stored(robot: dict, emg: dict) -> bytes:
    """HDF5 of two groups with these attributes."""
    import h5py

    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as store:
        for name, attributes, columns in (("robot", robot, ROBOT), ("emg", emg, ELECTRODES)):
            group = store.create_group(name)
            group.attrs.update(attributes)
            for column, values in columns.items():
                group[column] = values
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("robot", "emg"),
    [
        (
            {"fs": RATE, "timestamp": "2024-03-01T10:00:00Z"},
            {"fs": RATE, "timestamp": "2024-03-01T10:00:00.5Z"},
        ),
        (
            {"fs": RATE, "t_start_ns": 1_700_000_000_000_000_000},
            {"fs": RATE, "t_start_ns": 1_700_000_000_500_000_000},
        ),
        ({"dt": 1 / RATE, "t0_ms": 0.0}, {"dt": 1 / RATE, "t0_ms": 500.0}),
        ({"rate_hz": RATE}, {"rate_khz": RATE / 1e3, "offset_s": 0.5}),
        ({"sample_interval_ms": 1e3 / RATE, "begin": 0.0}, {"fs": RATE, "begin": 0.5}),
    ],
)
def test_groups_begin_when_they_say_in_any_unit(file, robot, emg):
    found = inspect(file(stored(robot, emg), "x.h5"))
    assert found.roles["angle"].start_s == pytest.approx(0.0, abs=1e-6)
    assert found.roles["emg_sol"].start_s == pytest.approx(0.5, abs=1e-6)
    assert found.roles["emg_sol"].rate_hz == pytest.approx(RATE)


def test_structures_of_matlab_begin_when_they_say(file):
    import scipy.io

    buffer = io.BytesIO()
    robot = {"angle_deg": ANGLE, "torque_Nm": TORQUE, "fs": RATE, "start": 0.0}
    scipy.io.savemat(
        buffer, {"robot": robot, "emg": {"SOL_mV": EMG[:, 2], "fs": RATE, "start": 0.5}}
    )
    found = inspect(file(buffer.getvalue(), "x.mat"))
    assert (found.roles["angle"].start_s, found.roles["emg_sol"].start_s) == (0.0, 0.5)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("# start: 2024-03-01 10:00:00.000", "# start: 2024-03-01 10:00:00.500"),
        ("Aufnahmebeginn: 01.03.2024 10:00:00", "Aufnahmebeginn: 01.03.2024 10:00:00.5"),
        ("Recorded;2024/03/01 9:59:59", "Recorded;2024/03/01 9:59:59.5"),
    ],
)
def test_texts_whose_first_lines_state_other_starts_are_said(file, first, second):
    rate = "\n# Sample rate: 500 Hz\n"
    robot = file(text(THEIRS[:2], (DATA[:, :2],), above=first + rate), "robot.csv")
    emg = file(text(THEIRS[2:], (DATA[:, 2:],), above=second + rate), "emg.csv")
    assert "emg.csv says that it began 0.5 s after" in said(robot, emg)
    assert "began" not in said(robot)


@pytest.mark.parametrize("line", ["Date of birth: 1.3.1960", "Exported: 2024-03-01 10:00:00"])
def test_other_dates_are_no_start(file, line):
    other = "# start: 2024-03-01 10:00:00.5\n# Sample rate: 500 Hz\n"
    robot = file(
        text(THEIRS[:2], (DATA[:, :2],), above=f"{line}\n# Sample rate: 500 Hz\n"), "r.csv"
    )
    emg = file(text(THEIRS[2:], (DATA[:, 2:],), above=other), "emg.csv")
    assert "began" not in said(robot, emg)


@pytest.mark.parametrize(
    ("robot", "emg", "factor"),
    [
        ("robot time (s)", "emg time (s)", 1.0),
        ("t_robot_time_s", "EMG timestamp [ms]", 1e3),
        ("time_s", "Delsys Zeit (us)", 1e6),
    ],
)
def test_two_tables_side_by_side_have_their_own_times(file, robot, emg, factor):
    names = (robot, *THEIRS[:2], emg, *THEIRS[2:])
    columns = (TIME, DATA[:, :2], (TIME + 0.5) * factor, DATA[:, 2:])
    path = file(text(names, columns, form="{:.9g}"))
    found = inspect(path)
    assert found.roles["angle"].start_s == 0.0
    assert found.roles["emg_sol"].start_s == pytest.approx(0.5)
    assert f"its times are those of column '{emg}'" in said(path)
    toml = path.with_name("map.toml")
    toml.write_text(mapping_text(found, path.parent), encoding="utf-8")
    assert read(toml)["emg_sol"].time[0] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("second", "values"),
    [("EMG time (ms)", TIME * 1e3), ("emg time to peak (s)", np.full(N, 0.3))],
)
def test_the_same_times_once_more_and_other_columns_are_no_second_clock(file, second, values):
    names = ("time_s", *THEIRS[:2], second, *THEIRS[2:])
    path = file(text(names, (TIME, DATA[:, :2], values, DATA[:, 2:]), form="{:.9g}"))
    assert inspect(path).roles["emg_sol"].start_s == 0.0
    assert "its times are" not in said(path)


# Trials.


def test_columns_of_matrices_are_trials_with_their_units(file):
    import scipy.io

    buffer = io.BytesIO()
    signals = {"angle_deg": ANGLE, "torque_Nm": TORQUE, "emg_sol_mV": EMG[:, 2]}
    half = {name: np.stack([x[: N // 2], x[N // 2 :]], 1) for name, x in signals.items()}
    scipy.io.savemat(buffer, {"fs": RATE, **half})
    found = inspect(file(buffer.getvalue(), "x.mat"))
    assert len(next(iter(found.trials.values())).names) == 2
    assert found.roles["angle"].column == "angle_deg"
    assert found.roles["emg_sol"].known_unit == "mV"


def test_frames_that_begin_again_are_trials_and_never_joined(file):
    half = N // 2
    frames = np.tile(np.arange(1, half + 1), 2)
    path = file(text(("Frame", *OURS), (frames, DATA)))
    found = inspect(path)
    (trials,) = found.trials.values()
    assert trials.text.endswith("the count of frames falls back once")
    fixed = "fixed = { g1 = 0.0, g2 = 0.0, g3 = 0.0, g4 = 0.0 }\n"
    channels = "".join(
        f'[channels.{role}]\nfile = "trial.csv"\ncolumn = "{name}"\nstart_s = 0.0\nrate_hz = 500\n'
        for role, name in (("angle", "angle_deg"), ("torque", "torque_Nm"))
    )
    toml = file(fixed + channels, "map.toml")
    with pytest.raises(InputError, match="2 trials, whose times or frames fall back"):
        read(toml)
    toml.write_text(f'trial = {{ index = "*" }}\n{fixed}{channels}')
    each = read_trials(toml)
    assert [len(r["angle"].values) for r in each] == [half, half]
    np.testing.assert_allclose(np.degrees(each[1]["angle"].values), ANGLE[half:], atol=1e-3)


def test_counters_of_packets_are_no_frames(file):
    path = file(text(("nSeq", *OURS), (np.arange(N) % 16, DATA)))
    assert not inspect(path).trials


# Times.


@pytest.mark.parametrize(
    ("name", "factor"),
    [
        *(("tid (ms)", 1e3), ("Čas [s]", 1.0), ("Aika (min)", 1 / 60), ("Zaman (s)", 1.0)),
        *(("時間 (s)", 1.0), ("Время, с", 1.0), ("micros()", 1e6), ("SecondsSinceStart", 1.0)),
    ],
)
def test_times_of_more_languages_and_units_are_read_or_offered(file, name, factor):
    path = file(timed(f'"{name}"', TIME * factor))
    angle = inspect(path).roles["angle"]
    assert angle.rate_hz == pytest.approx(RATE, rel=1e-3)


@pytest.mark.parametrize("name", ["Datum/Uhrzeit", "Messpunkt", "When"])
@pytest.mark.parametrize(
    "form", ["01.03.2024 10:00:{:06.3f}", "2024-03-01T10:00:{:06.3f}+01:00", "10:00:{:06.3f}"]
)
def test_cells_that_are_times_of_day_are_the_time_under_any_name(file, name, form):
    path = file(stamped([form.format(at) for at in TIME], name, between=";"))
    angle = inspect(path).roles["angle"]
    assert (angle.start_s, angle.rate_hz) == (0.0, pytest.approx(RATE, rel=1e-3))


def test_a_rate_beside_a_count_of_samples_is_the_rate(file):
    path = file(timed("Sample (500 Hz)", np.arange(N)))
    assert inspect(path).roles["angle"].rate_hz == pytest.approx(RATE)
    assert "500 Hz, as column 'Sample (500 Hz)' says" in said(path)


@pytest.mark.parametrize(
    ("name", "end"),
    [("normalized stance", 1.0), ("Zancada [%]", 100.0), ("gait_cycle", 1.0), ("Fase (%)", 100.0)],
)
def test_a_part_of_a_movement_is_no_time_whether_it_ends_at_1_or_100(file, name, end):
    n = 101
    path = file(text((name, *THEIRS), (np.linspace(0.0, end, n), DATA[:n])))
    with pytest.raises(InputError, match="in percent has no speed"):
        inspect(path)


# Programs.


def test_labcharts_comments_and_decimal_commas_are_read(file):
    lines = made.labchart().split("\n")
    lines[20] += "\t#1 contraction begins"
    commented = file("\n".join(lines), "a.txt")
    german = file(made.labchart().replace(".", ","), "b.txt")
    for path in (commented, german):
        found = inspect(path)
        assert found.roles["angle"].known_unit == "deg"
        assert found.roles["angle"].n == N
        assert found.roles["angle"].rate_hz == pytest.approx(RATE, rel=1e-3)


def test_columns_that_are_called_after_their_units_are_offered(file):
    names = ("mSec", "N-M", "Degrees", "DEG/SEC")
    velocity = np.gradient(ANGLE, 1 / RATE)
    found = inspect(file(text(names, (TIME * 1e3, TORQUE, ANGLE, velocity))))
    assert [c.column for c in found.open["torque"]] == ["N-M"]
    assert [c.column for c in found.open["angle"]] == ["Degrees"]


# What is there.


@pytest.mark.parametrize("name", ["Last (kg)", "Crank force (N)", "Zug [kgf]"])
def test_a_force_is_offered_by_its_unit_alone(file, name):
    found = inspect(file(text(("time_s", "angle_deg", name), (TIME, ANGLE, TORQUE))))
    assert [c.column for c in found.open["torque"]] == [name]
    assert "lever arm" in " ".join(found.advice)


@pytest.mark.parametrize("name", ["Body weight (kg)", "GRF (N)", "mass (kg)"])
def test_weights_and_plates_are_no_force_of_a_load_cell(file, name):
    found = inspect(file(text(("time_s", "angle_deg", name), (TIME, ANGLE, TORQUE))))
    assert "torque" not in found.open


@pytest.mark.parametrize(
    ("angle", "torque"),
    [
        ("Ayak bileği açısı (derece)", "Tork (Nm)"),
        ("Nilkan kulma (astetta)", "Vääntömomentti (Nm)"),
        ("Голеностоп (градусов)", "Момент (Nm)"),
    ],
)
def test_units_of_more_languages_say_what_a_column_may_be(file, angle, torque):
    found = inspect(file(timed("Time (s)", names=(angle, torque, *THEIRS[2:]))))
    assert {"angle", "torque"} <= {*found.roles, *found.open}
    assert "add its file" not in " ".join(found.advice)


def test_accelerometers_and_gyroscopes_are_no_angle_or_torque(file):
    names = ("time_s", *(f"emg_{m.lower()}_mV" for m in MUSCLES), "ACC.X (g)", "GYRO.X (deg/s)")
    path = file(text(names, (TIME, EMG, ANGLE, TORQUE)))
    assert "angle and torque are missing: as a recording of maximum contractions" in said(path)


# Below the numbers.


@pytest.mark.parametrize(
    "below", [",".join(["NaN"] * 7) + "\n", ",".join(["n/a"] * 7), "Max,1,2,3,4,5,6\n</data>\n"]
)
def test_a_last_row_without_numbers_is_left_out_aloud(file, below):
    path = file(timed("time_s", names=OURS) + below)
    found = inspect(path)
    assert found.roles["angle"].n == N
    assert f"from row {N + 2} on no numbers" in said(path)


def test_a_samples_own_gap_is_no_end(file):
    rows = timed("time_s", names=OURS).splitlines()
    at, *others = rows[-1].split(",")
    rows[-1] = ",".join([at, *["NaN"] * len(others)])
    assert "angle" in inspect(file("\n".join(rows) + "\n")).unusable


def test_what_dos_ends_files_with_is_no_row(file):
    path = file(timed("time_s", names=OURS) + "\x1a")
    assert inspect(path).roles["angle"].n == N
    assert "cut short" not in said(path)


def test_a_row_of_zeros_below_is_said_to_fall_back(file):
    path = file(timed("time_s", names=OURS) + ",".join(["0"] * 7) + "\n")
    assert "it falls back; leave out the rows" in said(path)
    assert "share no span" not in said(path)


def test_commas_of_thousands_are_not_taken_for_decimals(file):
    rows = [f'"{2 * i:,}",{ANGLE[i]:.4f},{TORQUE[i]:.4f}' for i in range(N)]
    path = file("\n".join(["time_ms,angle_deg,torque_Nm", *rows]) + "\n")
    assert "of thousands or of decimals" in said(path)
    assert "write '1.000'" not in said(path)


# Maximum contractions, folders.


def test_torque_without_an_angle_may_be_a_maximum_contraction(file):
    path = file(timed("time_s", names=OURS[1:], data=DATA[:, 1:]))
    assert "--mvc" in said(path)


def test_a_data_set_with_notes_beside_one_recording_is_that_recording(file, tmp_path):
    file("x", "ds/README")
    file("participant_id\tscore\nsub-A\t3\n", "ds/phenotype/a.tsv")
    own = file(timed("time_s", names=OURS, between="\t"), "ds/sub-A/beh/sub-A_task-x_beh.tsv")
    assert own in data_files_below(tmp_path / "ds")


def test_a_table_of_bids_physio_says_where_its_names_are(file):
    path = file(text(["1", "2"], (ANGLE, TORQUE), between="\t"), "sub-01_task-x_physio.tsv")
    with pytest.raises(InputError, match=r"\.json"):
        inspect(path)
