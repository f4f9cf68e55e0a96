"""What is in a file but cannot be used is never taken for what was not measured."""

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.recording import inspect, mapping_text, read
from surae.recording.recording import MUSCLES

NAMES = ("Ankle Angle (rad)", "Ankle Torque (Nm)", "TA (V)", "GL (V)", "SOL (V)", "GM (V)")
RATE, N = 1000.0, 400


def table() -> list[list[str]]:
    rng = np.random.default_rng(2)
    time = np.arange(N) / RATE
    columns = [time, 0.3 * np.sin(6 * time), 5 * np.sin(6 * time)]
    columns += [1e-5 * rng.normal(size=N) for _ in MUSCLES]
    return [[f"{x:.7g}" for x in row] for row in zip(*columns, strict=True)]


def written(path, rows, names=("Time (s)", *NAMES)):
    path.write_text("\n".join(",".join(row) for row in (names, *rows)) + "\n", encoding="utf-8")
    return path


def mapped(path, change=lambda text: text):
    """The mapping that inspect writes, after what a user does with it."""
    text = change(mapping_text(inspect(path), path.parent))
    toml = path.with_suffix(".toml")
    toml.write_text(text, encoding="utf-8")
    return toml, text


def uncommented(text: str, role: str) -> str:
    """The mapping with the lines of a channel taken in."""
    lines, inside = [], False
    for line in text.splitlines():
        inside = (inside or line.startswith(f"# [channels.{role}]")) and line.startswith("# ")
        lines.append(line[2:] if (inside and "=" in line) or line[2:].startswith("[") else line)
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("cell", "says"),
    [("", "the cell is blank"), ("OVL", "'OVL' is not a number"), ("nan", "not a finite number")],
)
@pytest.mark.parametrize(("column", "role"), [(5, "emg_sol"), (2, "torque"), (1, "angle")])
def test_one_cell_leaves_its_role_open(tmp_path, cell, says, column, role):
    rows = table()
    rows[200][column] = cell
    path = written(tmp_path / "t.csv", rows)
    inspection = inspect(path)
    assert says in inspection.unusable[role]
    assert "row 202" in inspection.unusable[role]
    assert role not in inspection.missing
    toml, text = mapped(path)
    assert "fixed" not in text.replace("in fixed = { … }", "")
    with pytest.raises(InputError, match=f"open: {role} is in the files but not settled"):
        read(toml)


@pytest.mark.parametrize(("lost", "helps"), [(1, True), (40, False)])
def test_who_reads_a_short_gap_is_told_how_to_bridge_it(tmp_path, lost, helps):
    time = np.arange(200) / 500.0
    rows = [[f"{t:.4f}", f"{np.sin(t):.4f}", "1" if k % 2 else "2"] for k, t in enumerate(time)]
    for row in rows[100 : 100 + lost]:
        row[2] = ""
    lines = ["time_s,angle_rad,torque_Nm", *map(",".join, rows)]
    (tmp_path / "t.csv").write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match="the cell is blank") as refused:
        read(tmp_path / "t.csv")
    assert ("bridge_s = 0.00" in str(refused.value)) is helps


def test_short_gaps_are_bridged_aloud_when_the_user_says_so(tmp_path):
    rows = table()
    for index in (100, 101, 250):
        rows[index][5] = ""
    path = written(tmp_path / "t.csv", rows)
    toml, _ = mapped(path, lambda text: uncommented(text, "emg_sol"))
    channel = read(toml).channels["emg_sol"]
    assert "3 unreadable samples in 2 gaps, the longest 3 ms bridged by straight" in channel.source
    finding = next(each for each in surae.check(read(toml)).findings if each.code == "as-read")
    assert (finding.severity, finding.channel) == ("info", "emg_sol")
    assert "3 unreadable samples in 2 gaps" in finding.message
    before, after = (float(rows[i][5]) for i in (99, 102))
    assert channel.values[100] == pytest.approx(before + (after - before) / 3)
    assert len(channel.values) == N


def test_a_long_gap_is_not_bridged(tmp_path):
    rows = table()
    for index in range(100, 200):
        rows[index][5] = ""
    toml, text = mapped(written(tmp_path / "t.csv", rows))
    assert "bridge_s" not in text
    text = uncommented(text, "emg_sol").replace("[channels.emg_sol]", "[channels.emg_sol]\n%s")
    toml.write_text(text % "bridge_s = 0.05", encoding="utf-8")
    with pytest.raises(InputError, match=r"row 102: the cell is blank; 99 more like it"):
        read(toml)
    toml.write_text(text % "bridge_s = 1.0", encoding="utf-8")
    with pytest.raises(InputError, match=r"0\.05 s at most"):
        read(toml)


def test_a_gap_at_an_end_is_not_bridged(tmp_path):
    rows = table()
    rows[0][5] = ""
    toml, text = mapped(written(tmp_path / "t.csv", rows))
    assert "bridge_s" not in text
    with pytest.raises(InputError, match="open: emg_sol"):
        read(toml)


def test_a_muscle_may_be_left_out_aloud(tmp_path):
    rows = table()
    rows[7][5] = ""
    toml, text = mapped(written(tmp_path / "t.csv", rows))
    toml.write_text(text.replace("\n[channels.angle]", "\nfixed = { g3 = 0.0 }\n[channels.angle]"))
    assert "emg_sol" not in read(toml).channels


def test_what_is_not_there_is_missing_as_before(tmp_path):
    rows = [[*row[:5], row[6]] for row in table()]
    path = written(tmp_path / "t.csv", rows, ("Time (s)", *NAMES[:4], NAMES[5]))
    inspection = inspect(path)
    assert inspection.missing == ("emg_sol",)
    assert not inspection.unusable
    assert "fixed = { g3 = 0.0 }" in mapped(path)[1]


def test_a_unit_that_is_not_known_keeps_the_role_and_asks(tmp_path):
    names = ("Time", "Ankle Angle", "Ankle Torque", *MUSCLES)
    for unit in ("N", "foo", "Nm/kg"):
        units = ["s", "rad", unit, "V", "V", "V", "V"]
        path = written(tmp_path / "t.csv", [units, *table()], names)
        inspection = inspect(path)
        assert inspection.roles["torque"].known_unit is None
        assert not inspection.missing
        toml, text = mapped(path)
        assert f"{unit!r}" in text.partition("[channels.torque]")[2].partition("[channels")[0]
        with pytest.raises(InputError, match="torque: unit is missing"):
            read(toml)


def test_imperial_units_are_converted(tmp_path):
    names = ("Time", "Ankle Angle", "Ankle Torque", *MUSCLES)
    rows = [["s", "deg", "ft-lbs", "uV", "uV", "uV", "uV"], *table()]
    toml, text = mapped(written(tmp_path / "t.csv", rows, names))
    assert "scale = 1.35" in text
    raw = np.array([float(row[2]) for row in table()])
    assert read(toml).channels["torque"].values == pytest.approx(raw * 1.3558179483)


def test_a_fault_of_every_channel_is_said_once(tmp_path) -> None:
    rows = table()
    rows[200][0] = "later"
    path = written(tmp_path / "t.csv", rows)
    (fault,) = inspect(path).faults
    assert fault.startswith("angle, torque, emg_ta, emg_gl, emg_sol and emg_gm are there, but")
    assert "column 'Time (s)', row 202: 'later' is not a number; correct the file" in fault
    names = [name.partition(" (")[0] for name in NAMES]
    path = written(tmp_path / "u.csv", table(), ("Time (s)", *names))
    with pytest.raises(InputError, match=r"unit of 'Ankle Angle', .* 'GM' is not known") as caught:
        surae.check(path)
    assert str(caught.value).count("not known") == 1


def test_a_channel_in_microvolts_is_not_taken_for_silence(tmp_path) -> None:
    """Its name says no muscle that is known, but it is there."""
    names = ("Time (s)", *NAMES[:2], "Muskel 1 (uV)", *NAMES[3:])
    inspection = inspect(written(tmp_path / "t.csv", table(), names))
    assert "emg_ta" not in inspection.missing
    assert [channel.column for channel in inspection.open["emg_ta"]] == ["Muskel 1 (uV)"]


def test_a_number_that_is_written_otherwise_is_not_bridged(tmp_path) -> None:
    rows = table()
    rows[200][5] = '"1,25"'
    (fault,) = inspect(written(tmp_path / "t.csv", rows)).faults
    assert "has a decimal comma" in fault
    assert "bridge" not in fault
    rows[200][5] = '"-1,250.5"'
    assert inspect(written(tmp_path / "t.csv", rows)).roles["emg_sol"].low == -1250.5


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "sep=,\n" + text,
        lambda text: text.replace("\n", ",\n").replace(",\n", "\n", 1),
        lambda text: "Date/Time,07.03.2024 09:41:00\n" + text,
    ],
)
def test_what_programs_add_to_a_table(tmp_path, change) -> None:
    path = written(tmp_path / "t.csv", table())
    text = path.read_text(encoding="utf-8")
    path.write_text(change(text), encoding="utf-8")
    inspection = inspect(path)
    assert len(inspection.roles) == 6
    assert inspection.roles["angle"].rate_hz == pytest.approx(RATE)
    path.write_bytes(change(text).encode("utf-16-le"))
    assert inspect(path).roles["angle"].n == N
