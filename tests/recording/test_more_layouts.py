"""Layouts beside those of `test_layouts`: another program, language or unit of each kind."""

import numpy as np
import pytest
from layouts import ANGLE, DATA, EMG, MUSCLES, RATE, THEIRS, TIME, TORQUE, N, text, timed
from layouts_more import (
    BIDS_NOTES,
    acqknowledge_in_minutes,
    beside,
    edf,
    grouped,
    nwb,
    openbci,
    opensignals_two,
    spike2,
)

from surae.base.errors import InputError
from surae.recording import inspect, mapping_text, read
from surae.recording.inspected_trials import inspect_trials
from surae.recording.mapping import recognises
from surae.recording.reading import data_files_below, read_trials
from surae.recording.source import open_source


def mapped(*paths):
    """The recording that the mapping of an inspection reads."""
    toml = paths[0].with_name("map.toml")
    toml.write_text(mapping_text(inspect(paths), toml.parent), encoding="utf-8")
    return read(toml)


# Times.


@pytest.mark.parametrize(
    ("unit", "stamps"),
    [
        ("ms", [f"{round(1.7e12 + 1e3 * at)}" for at in TIME]),
        ("us", [f"{round(1.7e15 + 1e6 * at)}" for at in TIME]),
        ("ns", [f"{round(1.7e18 + 1e9 * at)}" for at in TIME]),
    ],
)
def test_stamps_since_1970_are_in_the_unit_that_makes_them_of_these_years(file, unit, stamps):
    rows = [
        ",".join([at, *(f"{x:.6g}" for x in row)]) for at, row in zip(stamps, DATA, strict=True)
    ]
    path = file("\n".join([",".join(["timestamp", *THEIRS]), *rows]) + "\n")
    found = inspect(path)
    angle = found.roles["angle"]
    assert angle.rate_hz == pytest.approx(RATE, rel=1e-3)
    assert angle.start_s == pytest.approx(1.7e9, abs=1.0)
    assert f"is taken as {unit}" in angle.remark


@pytest.mark.parametrize(
    ("name", "first", "per_second", "unit"),
    [("Date", 45352.4, 1 / 86400, "d"), ("Ticks", 638449e12, 1e7, "100ns")],
)
def test_days_and_ticks_are_offered_as_times(file, name, first, per_second, unit):
    stamps = [f"{first + at * per_second:.10f}" for at in TIME]
    rows = [
        ",".join([at, *(f"{x:.6g}" for x in row)]) for at, row in zip(stamps, DATA, strict=True)
    ]
    path = file("\n".join([",".join([name, *THEIRS]), *rows]) + "\n")
    found = inspect(path)
    (clock,) = found.clocks.values()
    assert (clock.column, clock.unit) == (name, unit)
    assert mapped(path).channels["angle"].rate_hz == pytest.approx(RATE, rel=1e-3)


@pytest.mark.parametrize(
    "line",
    [
        *("Sample interval: 2 ms", "Sampling period (s): 0.002", "Interval;0,002 s"),
        *("Capture Rate (Hz),500", "Sampling rate: 500", "Abtastrate 500", "Sampling: 0.5 kHz"),
    ],
)
def test_a_rate_or_an_interval_above_the_names_is_the_rate(file, line):
    found = inspect(file(text(THEIRS, (DATA,), above=f"{line}\n")))
    assert found.roles["angle"].rate_hz == pytest.approx(RATE)


@pytest.mark.parametrize("line", ["Number of samples: 500", "Samples: 500", "Rate of pay 500"])
def test_a_number_of_samples_is_no_rate(file, line):
    found = inspect(file(text(THEIRS, (DATA,), above=f"{line}\n")))
    assert found.roles["angle"].rate_hz is None


def test_percent_is_refused_by_its_name_where_no_sign_says_it_and_behind_a_count_of_cycles(file):
    n = 101
    percent = np.linspace(0, 100, n)
    cycle = text(("Normalized cycle", *THEIRS), (percent, DATA[:n]))
    several = text(
        ("Cycle", "Gait cycle (%)", *THEIRS),
        (np.repeat([1.0, 2.0], n), np.tile(percent, 2), DATA[: 2 * n]),
    )
    for content in (cycle, several):
        with pytest.raises(InputError, match="movement in percent has no speed"):
            inspect(file(content))


@pytest.mark.parametrize(
    "name", ["Elapsed Time [hh:mm:ss]", "Time (mm:ss.fff)", "Uhrzeit (hh:mm:ss)"]
)
def test_how_a_clock_is_written_is_no_unit(file, name):
    stamps = [f"{'00:' * ('hh' in name)}00:{at:09.6f}" for at in TIME]
    rows = [
        ",".join([at, *(f"{x:.6g}" for x in row)]) for at, row in zip(stamps, DATA, strict=True)
    ]
    path = file("\n".join([",".join([name, *THEIRS]), *rows]) + "\n")
    assert inspect(path).roles["angle"].rate_hz == pytest.approx(RATE, rel=1e-3)


@pytest.mark.parametrize("above", ["[channels]\nn = 6\n\n[data]\n", "[Header]\nfs = 500\n[Data]\n"])
def test_sections_of_an_ini_file_are_no_mapping(file, above):
    found = inspect(file(above + timed()))
    assert {"angle", "torque", "emg_ta"} <= found.roles.keys()


@pytest.mark.parametrize(
    "names",
    [
        ("Fotledsvinkel (grader)", "Vridmoment (Nm)", "TA (mV)", "GL (mV)", "SOL (mV)", "GM (mV)"),
        (
            *("Ángulo de tobillo (grados)", "Momento (N·m)", "Tibial anterior (mV)"),
            *("Gemelo externo (mV)", "Sóleo (mV)", "Gemelo interno (mV)"),
        ),
    ],
)
def test_channels_of_more_languages_are_found(file, names):
    path = file(timed(names=names))
    found = inspect(path)
    assert list(found.roles) == ["angle", "torque", *(f"emg_{m.lower()}" for m in MUSCLES)]
    assert np.ptp(mapped(path)["angle"].values) == pytest.approx(
        np.radians(np.ptp(ANGLE)), rel=1e-3
    )


# Starts of streams.


@pytest.mark.parametrize(
    ("starts", "attribute"),
    [
        ((1.7e9, 1.7e9 + 0.5), "start_time"),
        ((0.0, 0.5), "t0"),
        (("2024-03-01T10:00:00", "2024-03-01T10:00:00.500000"), "start"),
    ],
)
def test_groups_of_hdf5_begin_when_their_attributes_say(file, starts, attribute):
    found = inspect(file(grouped(starts, attribute), "x.h5"))
    assert found.roles["angle"].start_s == pytest.approx(0.0, abs=1e-6)
    assert found.roles["emg_sol"].start_s == pytest.approx(0.5, abs=1e-6)
    assert found.roles["emg_sol"].rate_hz == pytest.approx(RATE)


def test_a_first_sample_that_is_counted_is_no_start(file):
    found = inspect(file(grouped((0, 512), "start"), "x.h5"))
    assert found.roles["emg_sol"].start_s == 0.0


def test_series_of_nwb_begin_at_their_starting_time(file):
    recording = mapped(file(nwb(), "x.nwb"))
    assert recording.channels["emg_sol"].time[0] == pytest.approx(0.5)
    np.testing.assert_allclose(np.degrees(recording.channels["angle"].values), ANGLE, atol=1e-6)


def test_nwb_of_its_own_library_is_read(tmp_path):
    pynwb = pytest.importorskip("pynwb", reason="pynwb is not installed: NWB is tested by h5py")
    from datetime import UTC, datetime

    stored = pynwb.NWBFile("x", "x", datetime(2024, 3, 1, tzinfo=UTC))
    for name, values, unit in (("ankle_angle", ANGLE, "deg"), ("ankle_torque", TORQUE, "N*m")):
        series = pynwb.TimeSeries(name=name, data=values, unit=unit, starting_time=0.25, rate=RATE)
        stored.add_acquisition(series)
    path = tmp_path / "x.nwb"
    with pynwb.NWBHDF5IO(str(path), "w") as io_:
        io_.write(stored)
    found = inspect(path)
    assert found.roles["angle"].start_s == pytest.approx(0.25)
    assert found.roles["torque"].known_unit == "Nm"


def by_clock(file, name, first, names, data):
    stamps = [f"10:00:{first + at:09.6f}" for at in TIME]
    rows = [",".join([at, *(f"{x:.6g}" for x in r)]) for at, r in zip(stamps, data, strict=True)]
    return file("\n".join([",".join(["Time", *names]), *rows]) + "\n", name)


def test_two_files_with_times_of_day_are_on_one_clock(file):
    robot = by_clock(file, "robot.csv", 1.0, THEIRS[:2], DATA[:, :2])
    emg = by_clock(file, "emg.csv", 1.5, THEIRS[2:], DATA[:, 2:])
    found = inspect([robot, emg])
    assert found.roles["angle"].start_s == 0.0
    assert found.roles["emg_sol"].start_s == pytest.approx(0.5)
    assert "0.5 s after the other file's" in found.roles["emg_sol"].remark
    recording = mapped(robot, emg)
    assert recording.channels["angle"].time[0] == 0.0
    assert recording.channels["emg_sol"].time[0] == pytest.approx(0.5)
    # alone each begins at 0, also where a mapping says when the other clock shows its first sample
    assert inspect(emg).roles["emg_sol"].start_s == 0.0


def test_times_of_day_without_a_common_span_are_said(file):
    robot = by_clock(file, "robot.csv", 1.0, THEIRS[:2], DATA[:, :2])
    emg = by_clock(file, "emg.csv", 31.0, THEIRS[2:], DATA[:, 2:])
    assert "share no span of time" in " ".join(inspect([robot, emg]).advice)


def test_files_whose_headers_state_other_starts_are_said(file):
    pytest.importorskip("edfio")
    robot = file(edf(only=("angle", "torque")), "robot.edf")
    same = file(edf(only=MUSCLES), "same.edf")
    late = file(edf(only=MUSCLES, hour=(10, 0, 2)), "late.edf")
    said = " ".join(inspect([robot, late]).advice)
    assert "began 2 s after" in said
    assert "start_s = 2" in said
    assert "began" not in " ".join(inspect([robot, same]).advice)


# Trials.


@pytest.mark.parametrize("style", ["number", "suffix", "again", "before"])
def test_trials_side_by_side_are_told_apart(file, style):
    path = file(beside(style))
    found = inspect(path)
    (trials,) = found.trials.values()
    assert len(trials.names) == 3
    assert trials.line == '{ group = "*" }'
    toml = path.with_name("map.toml")
    toml.write_text(mapping_text(found, path.parent), encoding="utf-8")
    each = read_trials(toml)
    for k, recording in enumerate(each):
        own = ANGLE[200 * k : 200 * (k + 1)]
        np.testing.assert_allclose(np.degrees(recording.channels["angle"].values), own, atol=1e-3)


@pytest.mark.parametrize(
    "names",
    [
        ("Angle 1 (deg)", "Angle 2 (deg)", "EMG 1 (mV)", "EMG 2 (mV)"),
        ("Angle 1 (deg)", "Torque 1 (Nm)", "Torque 2 (Nm)", "SOL (mV)"),
        ("Angle 3 (deg)", "Torque 3 (Nm)", "SOL 3 (mV)", "TA 7 (mV)"),
    ],
)
def test_numbered_sensors_are_no_trials(file, names):
    assert not inspect(file(timed("Time (s)", TIME, names, DATA[:, :4]))).trials


# Programs.


@pytest.mark.parametrize("content", [spike2(), acqknowledge_in_minutes()])
def test_exports_are_read_with_names_units_and_rates(file, content):
    found = inspect(file(content, "x.txt"))
    units = {role: channel.known_unit for role, channel in found.roles.items()}
    assert units["angle"] == "deg"
    assert units["torque"] == "Nm"
    assert units["emg_sol"] == "mV"
    assert found.roles["angle"].rate_hz == pytest.approx(RATE, rel=1e-4)
    recording = mapped(file(content, "x.txt"))
    np.testing.assert_allclose(np.degrees(recording.channels["angle"].values), ANGLE, atol=1e-3)


def test_channels_of_spike2s_text_begin_at_their_start_at_the_summarys_rate(file):
    content = spike2().replace(f"{RATE:.6f}", f"{RATE * 1.001:.6f}")
    found = inspect(file(content, "x.txt"))
    assert found.roles["emg_sol"].start_s == pytest.approx(0.25)
    assert found.roles["angle"].rate_hz == pytest.approx(RATE * 1.001, rel=1e-6)


def test_opensignals_of_two_devices_has_the_channels_of_both(file):
    found = inspect(file(opensignals_two(), "x.txt"))
    assert found.roles["emg_sol"].column == "device 1: EMG SOL"
    assert found.roles["angle"].column == "device 2: GONIO Ankle angle"
    assert "nSeq" not in " ".join(found.advice)  # which counts, and is no torque


def test_channels_of_openbci_are_emg_of_no_known_muscle(file):
    found = inspect(file(openbci(), "x.txt"))
    assert set(found.open) == {f"emg_{m}" for m in ("ta", "gl", "sol", "gm")}
    said = " ".join(found.advice)
    assert "Timestamp" not in said
    assert "Sample Index" not in said


def test_a_matrix_under_the_texts_above_it_is_read(file):
    import io

    import scipy.io

    buffer = io.BytesIO()
    heads = np.array([["Time (s)", *THEIRS]], dtype=object)
    structure = {"data": np.column_stack([TIME, DATA]), "textdata": heads}
    scipy.io.savemat(buffer, {"S": structure})
    found = inspect(file(buffer.getvalue(), "s.mat"))
    assert found.roles["angle"].known_unit == "deg"
    assert found.roles["angle"].rate_hz == pytest.approx(RATE, rel=1e-3)


def test_a_structures_own_unit_is_that_of_its_signal(file):
    import io

    import scipy.io

    buffer = io.BytesIO()
    each = {"Angle": (ANGLE, "deg"), "Torque": (TORQUE, "Nm")}
    scipy.io.savemat(
        buffer,
        {name: {"data": x, "unit": unit, "fs": RATE} for name, (x, unit) in each.items()},
    )
    found = inspect(file(buffer.getvalue(), "s.mat"))
    assert found.roles["angle"].known_unit == "deg"
    assert found.roles["torque"].known_unit == "Nm"


def test_a_binary_file_without_signals_shows_none_of_its_bytes(file):
    import io

    import scipy.io

    buffer = io.BytesIO()
    scipy.io.savemat(buffer, {"S": {"data": DATA}})
    with pytest.raises(InputError) as error:
        inspect(file(buffer.getvalue(), "s.mat"))
    assert "looks like the names" not in str(error.value)


@pytest.mark.parametrize("binary", [False, True])
def test_recordings_of_a_bids_folder_are_trials_of_one_layout(file, tmp_path, binary):
    pytest.importorskip("edfio")
    ending = "bdf" if binary else "edf"
    for name, content in BIDS_NOTES.items():
        file(content, name)
    for run in (1, 2):
        start = f"sub-01/ses-1/emg/sub-01_ses-1_task-ankle_run-{run}_"
        file(edf(binary=binary), f"{start}emg.{ending}")
        file("name\ttype\tunits\nangle\tMISC\tdeg\n", f"{start}channels.tsv")
        file("onset\tduration\ttrial_type\n1.0\t2.0\tx\n", f"{start}events.tsv")
    paths = data_files_below(tmp_path)
    assert [path.suffix for path in paths] == [f".{ending}"] * 2
    found = inspect_trials(paths)
    assert len(found.trials) == 2
    assert found.typical.roles["torque"].known_unit == "Nm"


def test_a_table_of_bids_without_heading_says_where_its_names_are(file):
    path = file(text(["1", "2"], (ANGLE, TORQUE), between="\t"), "sub-01_task-x_motion.tsv")
    with pytest.raises(InputError, match=r"channels\.tsv"):
        inspect(path)


# Words.


@pytest.mark.parametrize("head", ["channels = 6\nrate = 500\n", "[Header]\nside = left\n[Data]\n"])
def test_keys_that_a_mapping_has_too_make_no_mapping(file, head):
    path = file(head + timed("Time (s)"))
    assert not recognises(open_source(path))
    assert inspect(path).roles["angle"].rate_hz == pytest.approx(RATE, rel=1e-3)


def test_units_behind_a_colon_are_read(file):
    names = ("Ankle angle:deg", "Ankle torque:Nm", *(f"{m}:mV" for m in MUSCLES))
    found = inspect(file(timed("Time:s", names=names)))
    assert found.roles["angle"].known_unit == "deg"
    assert found.roles["emg_sol"].known_unit == "mV"
    assert not found.clocks


def test_emg_alone_is_offered_as_maximum_contractions(file):
    path = file(timed("time_s", names=tuple(f"emg_{m.lower()}_mV" for m in MUSCLES), data=EMG))
    said = " ".join(inspect(path).advice)
    assert "--mvc" in said
    with pytest.raises(InputError, match="--mvc"):
        read(path)
    rows = timed("time_s", names=("angle_deg",), data=ANGLE[:, None])
    assert "--mvc" not in " ".join(inspect(file(rows, "angle.csv")).advice)


def test_blank_rows_below_are_said_to_be_blank(file):
    found = inspect(file(timed("Time (s)") + "," * len(THEIRS) + "\n"))
    assert f"from row {N + 2} on all cells are blank" in found.roles["angle"].remark


def test_rates_units_and_starts_of_single_datasets_are_their_own(tmp_path):
    """What an EMG dataset says of its rate is not the angle's, whose samples are half as many."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "x.h5", "w") as made:
        for name, values, rate, unit in (
            ("ankle_angle", ANGLE[::2], RATE / 2, "deg"),
            ("ankle_torque", TORQUE[::2], RATE / 2, "Nm"),
            *((f"EMG_{m}", EMG[:, k], RATE, "mV") for k, m in enumerate(MUSCLES)),
        ):
            made[name] = values
            made[name].attrs["fs"] = rate
            made[name].attrs["units"] = unit
            if name.startswith("EMG"):
                made[name].attrs["start_time"] = 0.25
    made = mapped(tmp_path / "x.h5")
    assert made["angle"].rate_hz == pytest.approx(RATE / 2)
    assert made["emg_sol"].rate_hz == pytest.approx(RATE)
    assert (made["angle"].time[0], made["emg_sol"].time[0]) == (0.0, 0.25)
    np.testing.assert_allclose(made["angle"].values, np.radians(ANGLE[::2]))


def test_one_rate_for_channels_of_other_lengths_is_doubted(tmp_path):
    savemat = pytest.importorskip("scipy.io").savemat
    path = tmp_path / "x.mat"
    savemat(path, {"fs": RATE, "ankle_angle": ANGLE[::5], "TA": EMG[:, 0]})
    found = inspect(path)
    assert "if it was sampled slower" in found.roles["angle"].remark
    assert "sampled slower" not in found.roles["emg_ta"].remark


def test_the_time_among_the_columns_of_a_matrix_is_offered(tmp_path):
    savemat = pytest.importorskip("scipy.io").savemat
    names = np.array(["t", "angle_deg", "torque_Nm", *MUSCLES], dtype=object)
    path = tmp_path / "x.mat"
    savemat(path, {"data": np.column_stack([TIME, ANGLE, TORQUE, EMG]), "names": names})
    (clock,) = inspect(path).clocks.values()
    assert (clock.column, clock.unit) == ("data: t", "s")


def test_json_is_refused_by_its_name(file):
    with pytest.raises(InputError, match="this is JSON"):
        inspect(file('{"time": [0.0, 0.1], "angle": [1, 2]}', "x.json"))
