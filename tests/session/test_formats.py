"""Formats that people asked for: Excel, few digits of time, other joints, Noraxon's exports."""

import io
import tracemalloc
import zipfile

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.recording import Channel, inspect, read
from surae.recording.programs import excel
from surae.signals.timebase import timing

openpyxl = pytest.importorskip("openpyxl")


def workbook(path, sheets):
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def test_a_sheet_with_a_preface_and_units(tmp_path):
    rows = [
        ["Laboratory of today"],
        [],
        ["Time", "Ankle angle", "Torque", "EMG TA"],
        ["ms", "deg", "Nmm", "µV"],
    ]
    rows += [[10.0 * k, k, 1000.0 * k, 5] for k in range(5)]
    path = workbook(tmp_path / "lab.xlsx", {"Data": rows, "Notes": [["a patient's name"]]})
    found = inspect(path)
    assert {role: c.column for role, c in found.roles.items()} == {
        "angle": "Ankle angle",
        "torque": "Torque",
        "emg_ta": "EMG TA",
    }
    assert found.roles["torque"].known_unit == "Nmm"
    assert found.roles["angle"].rate_hz == pytest.approx(100.0)
    (tmp_path / "map.toml").write_text(
        "[channels.angle]\ncolumn='Ankle angle'\n[channels.torque]\ncolumn='Torque'\n"
    )
    recording = read(path, mapping=tmp_path / "map.toml")
    np.testing.assert_allclose(recording.channels["torque"].values, [0, 1, 2, 3, 4])
    np.testing.assert_allclose(recording.channels["angle"].time, [0, 0.01, 0.02, 0.03, 0.04])


def test_two_sheets_of_their_own_rates(tmp_path):
    slow = [["time_s", "angle_deg"], *([k / 10, k] for k in range(3))]
    fast = [["time_s", "emg_ta_V"], *([k / 20, 0.1] for k in range(6))]
    found = inspect(workbook(tmp_path / "x.xlsx", {"robot": slow, "emg": fast}))
    assert [c.column for c in found.channels] == ["robot: angle_deg", "emg: emg_ta_V"]
    assert [c.n for c in found.channels] == [3, 6]


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ([["a", "b"], [1, 2]], "missing column time_s"),
        ([["time_s", "angle_deg"], [0, 1], [1, "x"], [2, 3]], "row 3: 'x' is not a number"),
        ([["time_s", "angle_deg"], [0, 1], [1, None], [2, 3]], "row 3: the cell is blank"),
        ([["time_s", "angle_deg"], [0, 1], [None, 1], [2, 3]], "column 'time_s', row 3"),
        ([["time_s", "angle_deg"]], "no samples"),
        ([["time_s", "angle_deg"], [0, 1], [0, 1]], "time doesn't increase"),
    ],
)
def test_what_is_wrong_in_a_sheet(tmp_path, rows, says):
    with pytest.raises(InputError, match=says):
        read(workbook(tmp_path / "x.xlsx", {"Data": rows}))


def test_an_archive_that_is_no_workbook(tmp_path):
    buffer = io.BytesIO(b"PK\x03\x04 and xl/workbook.xml but nothing else")
    (tmp_path / "x.xlsx").write_bytes(buffer.getvalue())
    with pytest.raises(InputError, match="damaged"):
        read(tmp_path / "x.xlsx")


@pytest.mark.parametrize("cell", ["XFD3", "A9999999"])
def test_a_sheet_with_cells_far_away_is_refused_before_the_way_there_is_filled(
    tmp_path, monkeypatch, cell
):
    """Each row of cells at Excel's last column would take 131 kB, of 7 bytes in the file."""
    monkeypatch.setattr(excel, "_LONGEST", 4096)
    path = workbook(tmp_path / "x.xlsx", {"Data": [["time_s", "angle_deg"], [0, 1]]})
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    name = next(name for name in parts if "sheet1.xml" in name)
    far = f'<row r="{cell.strip("ADFX")}"><c r="{cell}"><v>1</v></c></row></sheetData>'
    parts[name] = parts[name].replace(b"</sheetData>", far.encode())
    with zipfile.ZipFile(path, "w") as archive:
        for part, data in parts.items():
            archive.writestr(part, data)
    tracemalloc.start()
    with pytest.raises(InputError, match="beyond the 4096 rows and 1024 columns"):
        excel.parse(path.read_bytes(), "x.xlsx")
    assert tracemalloc.get_traced_memory()[1] < 10e6
    tracemalloc.stop()


def stamped(time):
    return timing(Channel("angle", np.asarray(time), np.zeros(len(time)), "rad", "x"), "r")


WRITTEN = {
    "5 decimals": lambda t: np.round(t, 5),
    "cut at 5 decimals": lambda t: np.floor(t * 1e5) / 1e5,
    "6 digits": lambda t: np.array([float(f"{x:.6g}") for x in t]),
    "7 digits": lambda t: np.array([float(f"{x:.7g}") for x in t]),
    "single precision": lambda t: t.astype(np.float32).astype(float),
}


@pytest.mark.parametrize("how", WRITTEN)
def test_stamps_as_programs_write_them_are_uniform(how):
    for rate in (128.0, 256.0, 1259.259):
        for start in (0.0, 12.345678):
            made = stamped(WRITTEN[how](start + np.arange(5000) / rate))
            assert made.uniform
            assert made.axis.rate_hz == pytest.approx(rate, rel=2e-6)  # as 0.1 ms in 4 s tell it
            assert made.axis.start == pytest.approx(start, abs=2e-5)


@pytest.mark.parametrize("how", WRITTEN)
def test_few_digits_hide_no_lost_sample_and_no_jitter(how):
    time = np.arange(2000) / 256
    rng = np.random.default_rng(0)
    with pytest.raises(InputError, match=r"no samples from 2\.73"):
        stamped(WRITTEN[how](np.delete(time, 700)))
    assert not stamped(WRITTEN[how](time + rng.uniform(-0.2, 0.2, 2000) / 256)).uniform
    late = np.concatenate([time[:1000], time[1000:] + 0.4 / 256])
    assert not stamped(WRITTEN[how](late)).uniform


def test_a_knee_is_not_guessed_as_an_ankle(shared):
    found = inspect(shared / "devices" / "isokinetic_knee.c3d")
    assert "angle" not in found.roles
    assert "torque" not in found.roles
    assert "the muscles are of the knee: is it the ankle's?" in found.open["angle"][0].guess.rule
    assert any("only a guess (the word angle" in line for line in found.advice)


def test_other_joints_are_named(shared):
    found = inspect(shared / "c3d" / "gait_points_and_analog.c3d")
    remarks = {c.column: c.remark for c in found.channels}
    assert "of the knee, not the ankle" in remarks["A22:LKneeAngles.X"]
    assert "of the hip, not the ankle" in remarks["A22:RHipMoment.X"]
    assert "not the ankle" not in remarks["A22:LAnkleAngles.X"]


def test_moments_of_force_plates_are_named_as_such(shared):
    found = inspect(shared / "c3d" / "gait_points_and_analog.c3d")
    channels = {c.column: c for c in found.channels}
    for number in (1, 2):
        for axis in "XYZ":
            moment = channels[f"M{axis}{number}"]
            assert moment.guess is None
            assert f"force plate {number}" in moment.remark
            assert "not the ankle's" in moment.remark
    assert "not the ankle's" not in channels["FX1"].remark
    assert {c.column for c in found.open["torque"]} == {"A22:LAnkleMoment.X", "A22:RAnkleMoment.X"}


def test_an_ankle_beside_a_thigh_stays_the_ankle(tmp_path):
    lines = ["time,Angle,Torque,TA,Vastus medialis"] + [f"{k / 10},{k},1,0,0" for k in range(9)]
    (tmp_path / "x.csv").write_text("\n".join(lines))
    found = inspect(tmp_path / "x.csv")
    assert {"angle", "torque"} <= found.roles.keys()
