"""Exports of programs: names, units, rates and samples come out, whichever program wrote them."""

import io

import numpy as np
import program_files as files
import pytest
from program_files import DATA, NAMES, RATE, UNITS, N

from surae.base.errors import InputError
from surae.base.units import spelled
from surae.recording import inspect, mapping_text, read
from surae.recording.formats import open_table
from surae.recording.source import Source
from surae.recording.table import sampling_of


def table(data: bytes, name: str = "x"):
    return open_table(Source(name, data, ""), timed=False)


WHOLE = {
    "LabVIEW": (files.lvm_file(), 0.5),
    "LabVIEW with times": (files.lvm_file(x_columns="One"), 0.5),
    "TDMS": (files.tdms_file(), 0.5),
    "Parquet": (files.parquet_file(), 0.0),
    "Parquet with instants": (files.parquet_file(clock=True), 0.0),
    "Feather": (files.parquet_file(feather=True), 0.0),
    "FILELB": (files.flb_file(), 0.5),
    "FILELB 2": (files.flb_file(version=2), 0.5),
    "LabChart": (files.labchart_file(), 0.0),
    "AcqKnowledge": (files.acq_file(), 0.0),
    "AcqKnowledge in MATLAB": (files.acqknowledge_mat(), 0.0),
    "OT BioLab": (files.otbiolab_file(), 0.0),
    "Qualisys": (files.qualisys_file(), 0.0),
    "nldat": (files.nldat_file(), 0.5),
}


@pytest.mark.parametrize("program", WHOLE)
def test_all_channels_come_out(program):
    data, start = WHOLE[program]
    opened = table(data)
    plain = [name.rpartition(".")[2].partition(" [")[0] for name in opened.names]
    assert [name.split(": ")[-1] for name in plain] == list(NAMES)
    columns = opened.load(opened.names)
    for index, name in enumerate(opened.names):
        sampling = sampling_of(columns[name].time)
        assert (sampling.n, sampling.rate_hz) == (N, pytest.approx(RATE, rel=1e-9))
        assert sampling.start_s == pytest.approx(start)
        assert columns[name].values == pytest.approx(DATA[:, index], rel=1e-6, abs=1e-12)
    if program not in ("FILELB", "FILELB 2", "Qualisys"):  # which state none
        assert [spelled(opened.units[name]) for name in opened.names] == list(UNITS)


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_nexus_writes_sections(tmp_path, delimiter):
    path = tmp_path / "x.csv"
    path.write_bytes(files.vicon_file(delimiter=delimiter, first=26))
    inspection = inspect(path)
    assert inspection.formats[str(path)] == "Vicon Nexus CSV"
    assert inspection.roles.keys() >= {"angle", "torque", "emg_ta", "emg_gl", "emg_sol", "emg_gm"}
    angle = inspection.roles["angle"]
    assert (angle.column, angle.known_unit, angle.n) == ("Dyno - Angle: Angle", "deg", N)
    assert (angle.rate_hz, angle.start_s) == (pytest.approx(100.0), pytest.approx(1.0))
    marker = next(c for c in inspection.channels if c.column == "LANK: Z")
    assert (marker.n, marker.rate_hz, marker.unit) == (N // 4, pytest.approx(25.0), "mm")


def test_a_frame_that_nexus_left_out_is_said():
    lines = files.vicon_file().decode().splitlines(keepends=True)
    opened = table("".join((*lines[:20], *lines[21:])).encode())
    with pytest.raises(InputError, match="Devices: frames are missing"):
        opened.load(opened.names[:1])


@pytest.mark.parametrize("by_rows", [False, True])
@pytest.mark.parametrize("version73", [False, True])
def test_a_matrix_gives_its_channels_whichever_way_it_lies(tmp_path, by_rows, version73):
    path = tmp_path / "x.mat"
    path.write_bytes(files.matrix_mat(by_rows=by_rows, version73=version73))
    inspection = inspect(path)
    assert not inspection.missing
    assert not inspection.open
    assert inspection.roles["emg_sol"].column == "emg: SOL"
    opened = table(path.read_bytes())
    assert opened.load(["emg: SOL"])["emg: SOL"].values == pytest.approx(files.EMG[:, 2])
    with pytest.raises(InputError, match=r"'emg: TA', .*: EMG by name, but not called emg_ta_V"):
        read(path)  # left out, its muscles would pass for silent ones


def test_a_matrix_without_names_is_open_and_never_fixed_at_0(tmp_path):
    path = tmp_path / "x.mat"
    path.write_bytes(files.matrix_mat(by_rows=True, named=False))
    inspection = inspect(path)
    assert {"emg_ta", "emg_gl", "emg_sol", "emg_gm"} <= inspection.open.keys()
    text = mapping_text(inspection, tmp_path)
    assert "\nfixed" not in text
    assert 'open = ["emg_ta", "emg_gl", "emg_sol", "emg_gm"]' in text
    (tmp_path / "m.toml").write_text(text)
    with pytest.raises(InputError, match="not settled"):
        read(tmp_path / "m.toml")


def test_signals_without_times_are_there(tmp_path):
    import scipy.io

    n = 400
    scipy.io.savemat(
        tmp_path / "x.mat",
        {"time": np.arange(n) / 100, "angle_rad": np.arange(n) * 1e-3, "emg": np.ones((4 * n, 4))},
    )
    inspection = inspect(tmp_path / "x.mat")
    assert "emg_sol" in inspection.open
    assert any("no times: give start_s and rate_hz" in c.remark for c in inspection.channels)


def test_a_case_of_filelb_is_a_trial_of_its_own():
    opened = table(files.flb_file(cases=2))
    assert opened.names[:2] == ("case 1: Ankle Angle", "case 1: Ankle Torque")
    assert len(opened.names) == 2 * len(NAMES)
    with pytest.raises(InputError, match="cut short"):
        table(files.flb_file(cases=2)[:-4])
    counts = table(files.flb_file(counts=True))
    assert "without a scale" in counts.remarks["TA"]


# ------------------------------------------------------------------ text


ROWS = "\n".join(f"{k / 100:.2f},{0.01 * k:.3f},{k},{k}e-6" for k in range(30))
HEAD = "Time (s),Ankle Angle (rad),Ankle Torque (Nm),TA (µV)\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16", "utf-16-le-bom"])
def test_texts_of_any_encoding(encoding):
    text = HEAD + ROWS
    data = b"\xff\xfe" + text.encode("utf-16-le") if "bom" in encoding else text.encode(encoding)
    opened = table(data)
    assert opened.names[-1] == "TA (µV)"
    assert opened.load(["TA (µV)"])["TA (µV)"].values[29] == pytest.approx(29e-6)


def test_columns_apart_by_white_space():
    body = "time   angle_rad  torque_Nm\n" + "\n".join(
        f" {k / 10}   {k}.5  {2 * k}" for k in range(9)
    )
    opened = table(body.encode())
    assert opened.names == ("angle_rad", "torque_Nm")
    assert opened.load(["torque_Nm"])["torque_Nm"].values.tolist() == [2.0 * k for k in range(9)]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("09:41:00.000", "09:41:00.010"),
        ("23:59:59.995", "00:00:00.005"),
        ("2024-05-01 09:41:00.000", "2024-05-01 09:41:00.010"),
        ("12:59:59.995 PM", "1:00:00.005 PM"),
        ("59:59.995", "60:00.005"),
        ("23:59:59:995", "00:00:00:005"),
        ("2024-05-01T09:41:00.000+02:00", "2024-05-01T09:41:00.010+02:00"),
        ("07-Mar-2024 09:41:00.000", "07-Mar-2024 09:41:00.010"),
        ("0 days 23:59:59.995000", "1 days 00:00:00.005000"),
    ],
)
def test_times_of_a_clock_are_seconds_from_the_first(first, second):
    opened = table(f"Time,angle_rad\n{first},1\n{second},2\n".encode())
    column = opened.load(["angle_rad"])["angle_rad"]
    assert column.time == pytest.approx([0.0, 0.01])
    assert "clock's" in column.remark


def test_a_time_of_no_clock_that_is_known_says_how_to_write_it():
    with pytest.raises(InputError, match="row 2: '9:41:00:07' is not a number; write seconds, or"):
        table(b"Time,angle_rad\n9:41:00:07,1\n9:41:00:08,2\n").load(["angle_rad"])  # frames


@pytest.mark.parametrize(
    "name",
    [
        "Time (%)",
        "time [%]",
        "Time (fortnights)",
        "% cycle",
        "Gait cycle (%)",
        "stance_percent",
        "%",
        "Normalised time",
    ],
)
def test_a_time_that_is_none_in_seconds_is_refused(name):
    with pytest.raises(InputError, match=r"is not known for time|has no speed"):
        table(f"{name},angle_rad\n0,1\n1,2\n".encode())
    with pytest.raises(InputError, match=r"is not known for time|has no speed"):
        table(b"Time,angle_rad\n%,rad\n0,1\n1,2\n")


def rounded(rate, decimals, n=1000, jitter=0.0):
    time = np.arange(n) / rate + jitter * np.random.default_rng(1).normal(size=n)
    return "time_s,angle_rad\n" + "".join(f"{t:.{decimals}f},{k}\n" for k, t in enumerate(time))


@pytest.mark.parametrize(("rate", "decimals"), [(1500, 3), (2048, 3), (300, 3), (148.148148, 2)])
def test_rounded_stamps_are_read_as_uniform_and_said_so(rate, decimals):
    column = table(rounded(rate, decimals).encode()).load(["angle_rad"])["angle_rad"]
    assert column.time == pytest.approx(np.arange(1000) / rate, abs=10.0**-decimals)
    assert np.ptp(np.diff(column.time)) < 1e-9
    assert f"times rounded to {10 ** (3 - decimals):g} ms: read as uniform" in column.remark


@pytest.mark.parametrize(("rate", "n", "digits"), [(1024, 15000, 5), (512, 60000, 6)])
def test_stamps_of_few_digits_are_read_as_uniform(rate, n, digits):
    time = np.arange(n) / rate
    text = "time_s,angle_rad\n" + "".join(f"{t:.{digits}g},1\n" for t in time)
    column = table(text.encode()).load(["angle_rad"])["angle_rad"]
    assert column.time == pytest.approx(time, abs=1e-9)
    assert f"times rounded to {digits} digits: read as uniform" in column.remark


@pytest.mark.parametrize(
    "text",
    [
        rounded(1000, 3),  # exact
        rounded(1024, 6),  # as good as exact
        rounded(100, 3, jitter=0.002),  # a clock that trembles
        rounded(1500, 3).replace("\n0.301,", "\n0.201,", 1),  # one that goes back
    ],
)
def test_stamps_that_are_not_of_a_uniform_clock_stay(text):
    column = table(text.encode()).load(["angle_rad"])["angle_rad"]
    stamps = [float(line.partition(",")[0]) for line in text.splitlines()[1:]]
    assert column.time.tolist() == stamps
    assert not column.remark


def workbook(rows) -> bytes:
    import openpyxl

    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    buffer = io.BytesIO()
    book.save(buffer)
    return buffer.getvalue()


@pytest.mark.parametrize("name", ["t.csv", "t.xlsx", "t.mat"])
def test_a_mapping_says_the_same_of_every_format(tmp_path, name):
    import scipy.io

    path = tmp_path / name
    heads = ("ankle_angle", "ankle_torque")
    rows = [[0.01 * k, 1.0 * k] for k in range(200)]
    if name.endswith("csv"):
        lines = (heads, *rows)
        path.write_text("".join(",".join(map(str, row)) + "\n" for row in lines))
    elif name.endswith("xlsx"):
        path.write_bytes(workbook([heads, *rows]))
    else:
        scipy.io.savemat(path, dict(zip(heads, np.array(rows).T, strict=True)))
    text = mapping_text(inspect(path), tmp_path)
    assert text.count("# rate_hz") == 2
    toml = tmp_path / "m.toml"
    toml.write_text(
        text.replace('# unit = "rad"', 'unit = "rad"').replace('# unit = "Nm"', 'unit = "Nm"')
    )
    with pytest.raises(InputError, match="no times of 'ankle_angle'"):
        read(toml)
    toml.write_text(
        toml.read_text()
        .replace("# rate_hz = 1000.0", "rate_hz = 50")
        .replace("# start_s = 0.0", "start_s = 2")
    )
    angle = read(toml).channels["angle"]
    assert angle.time == pytest.approx(2 + np.arange(200) / 50)
    assert angle.values == pytest.approx([row[0] for row in rows])


def test_a_folder_names_what_is_set_aside(tmp_path):
    for k in range(3):
        (tmp_path / f"trial_{k}.csv").write_text("time_s,angle_rad,torque_Nm\n0,1,1\n1,2,2\n")
    (tmp_path / "notes.txt").write_text("Notes of the session\nelectrode fell off\n")
    (tmp_path / "events.tsv").write_text("onset\tduration\n1\t2\n")
    (tmp_path / "broken.csv").write_text("time_s,angle_rad\n0,1\n1\n")
    (tmp_path / "weather.csv").write_text("time_s,rain\n0,1\n1,2\n")
    from surae.recording.formats import data_files
    from surae.recording.inspected_trials import inspect_trials

    found = inspect_trials(data_files(tmp_path))
    assert found.trials == ("trial_0", "trial_1", "trial_2")
    said = [line for line in found.typical.advice if line.startswith("set aside")]
    assert [any(name in line for line in said) for name in ("notes", "events", "weather")] == [
        True
    ] * 3
    assert any("broken" in line for line in (*said, *(d.trial for d in found.differences)))


def test_rows_that_a_header_states_are_counted():
    rows = "".join(f"{k / 10}\t{k}\n" for k in range(5))
    head = "x\nnRows={}\nnColumns=2\ninDegrees=yes,,\nendheader,,\ntime\tankle_angle_r\n"
    assert not table((head.format(5) + rows).encode()).remarks
    remark = table((head.format(9) + rows).encode()).remarks["ankle_angle_r"]
    assert remark == "the header states 9 rows, the file holds 5: it was cut short"


def lvm_variant(change, **kind) -> bytes:
    return change(files.lvm_file(**kind).decode()).encode()


def multi(text: str) -> str:
    """A column of times for each channel, as LabVIEW writes where they differ."""
    head, names = text.split("X_Value", 1)
    rows = [line.split("\t")[1:-1] for line in names.splitlines()[1:]]
    lines = ["\t".join(f"X_Value\t{name}" for name in files.NAMES) + "\tComment"]
    lines += [
        "\t".join(f"{0.5 + k / 100:.4f}\t{x}" for x in row) + "\t" for k, row in enumerate(rows)
    ]
    return head.replace("X_Columns\tNo", "X_Columns\tMulti") + "\r\n".join(lines) + "\r\n"


@pytest.mark.parametrize(
    "change",
    [
        multi,
        lambda text: "\ufeff" + text,
        lambda text: text.replace(".", ",").replace("Separator\t,", "Separator\t,"),
    ],
)
def test_variants_of_labview_have_all_channels(change):
    opened = table(lvm_variant(change))
    assert opened.names == files.NAMES
    columns = opened.load(opened.names)
    for index, name in enumerate(files.NAMES):
        np.testing.assert_allclose(columns[name].values, files.DATA[:, index], rtol=1e-6)
        np.testing.assert_allclose(columns[name].time, 0.5 + files.TIME, atol=1e-9)
        assert opened.units[name] == files.UNITS[index]


def test_segments_of_labview_are_all_read_and_a_short_one_is_said():
    text = files.lvm_file().decode()
    again = text[text.index("Channels") :]
    opened = table((text + again).encode())  # no blank line between them
    assert len(opened.names) == 2 * len(files.NAMES)
    assert opened.names[-1] == "segment 2: GM"
    short = table("\r\n".join(text.split("\r\n")[:-5]).encode() + b"\r\n")
    assert (
        "the header states 64 samples, the file holds 60: it was cut short" in (short.remarks["TA"])
    )


def test_nexus_with_decimal_commas_and_quotes_is_read(tmp_path):
    path = tmp_path / "trial.csv"
    plain = files.vicon_file()
    path.write_bytes(plain)
    right = {role: c.low for role, c in inspect(path).roles.items()}
    comma = files.vicon_file(delimiter=";").replace(b".", b",")
    quoted = b"\r\n".join(
        b",".join(b'"' + cell + b'"' for cell in line.split(b",")) if line else b""
        for line in plain.split(b"\r\n")
    )
    for other in (comma, quoted):
        path.write_bytes(other)
        assert {role: c.low for role, c in inspect(path).roles.items()} == right
    assert len(right) >= 3


def test_a_channel_that_is_vague_and_unusable_is_not_missing(tmp_path):
    path = tmp_path / "trial.csv"
    rows = "".join(f"{k / 100},{k},{'' if k == 7 else 1e-4 * (-1) ** k}\n" for k in range(50))
    path.write_text(f"Time,Ankle Angle (deg),GAS (V)\n{rows}", encoding="utf-8")
    inspection = inspect(path)
    assert "emg_gl" not in inspection.missing
    assert "row 9: the cell is blank" in inspection.unusable["emg_gl"]
