"""Our CSV: what is accepted, and one clear line for everything that isn't."""

import hashlib
import math
import os
import re
from pathlib import Path

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.recording import inspect, read
from surae.recording.formats import open_table
from surae.recording.rows import Rows
from surae.recording.source import open_source
from surae.recording.times import is_time
from surae.signals.timebase import timing

HEADER = "time_s,angle_rad,torque_Nm,emg_ta_V"
GOOD = f"{HEADER}\n0,0.1,1,1e-6\n0.5,0.2,2,2e-6\n1,0.3,3,3e-6\n"


@pytest.fixture
def csv(tmp_path):
    def write(text: str | bytes, name: str = "trial.csv") -> Path:
        path = tmp_path / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    return write


def message(path) -> str:
    with pytest.raises(InputError) as caught:
        read(path)
    text = str(caught.value)
    assert "\n" not in text
    assert str(path) in text
    return text


def test_reads_channels_in_si_with_provenance(csv):
    path = csv(GOOD)
    recording = read(path)
    assert list(recording.channels) == ["angle", "torque", "emg_ta"]
    assert recording.name == "trial"
    assert recording.emg == "raw"
    torque = recording.channels["torque"]
    np.testing.assert_array_equal(torque.time, [0, 0.5, 1])
    np.testing.assert_array_equal(torque.values, [1, 2, 3])
    assert (torque.unit, torque.rate_hz) == ("Nm", 2.0)
    assert torque.source == "trial.csv: torque_Nm [Nm]"
    assert recording.files[0].path == str(path)
    assert recording.files[0].sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert not torque.values.flags.writeable
    assert not torque.time.flags.writeable


def test_units_in_the_names_are_converted(csv):
    recording = read(
        csv(
            "emg_sol_µV,angular_velocity_deg_s,time_ms,emg_gl_mV,angle_deg,torque_mNm\n"
            "1,180,0,2,90,500\n1,180,250,2,90,500\n"
        )
    )
    first = {role: channel.values[0] for role, channel in recording.channels.items()}
    assert first == pytest.approx(
        {
            "angle": math.pi / 2,
            "torque": 0.5,
            "emg_gl": 2e-3,
            "emg_sol": 1e-6,
            "angular_velocity": math.pi,
        }
    )
    np.testing.assert_allclose(recording.channels["angle"].time, [0, 0.25])


def test_normalised_emg_keeps_its_unit(csv):
    recording = read(csv("time_s,angle_rad,emg_ta_1\n0,0,0.2\n1,0,0.4\n"))
    assert recording.channels["emg_ta"].unit == "1"


@pytest.mark.parametrize(
    "text",
    [
        GOOD.replace("\n", "\r\n"),
        GOOD.replace("\n", "\r"),
        GOOD.replace(",", ";"),
        GOOD.replace(",", "\t"),
        GOOD.replace(",", " , "),
        "\ufeff" + GOOD,
        "\n  \n# a comment\n" + GOOD.replace("\n0.5", "\n# in the middle\n\n  # another\n0.5"),
        GOOD.rstrip("\n"),
        re.sub(r"[^,\n]+", r'"\g<0>"', GOOD),
        re.sub(r"$(?=\n)", ",# not a comment", GOOD, flags=re.MULTILINE),
    ],
    ids=[
        *("crlf", "cr", "semicolon", "tab", "spaces", "bom", "comments", "no-final-newline"),
        *("quoted", "text-column"),
    ],
)
def test_equivalent_files(csv, text):
    recording = read(csv(text))
    np.testing.assert_array_equal(recording.channels["angle"].values, [0.1, 0.2, 0.3])
    np.testing.assert_array_equal(recording.channels["emg_ta"].values, [1e-6, 2e-6, 3e-6])


def test_other_columns_are_ignored_whatever_they_hold(csv):
    recording = read(
        csv(
            "comment,time_s,tissue_Nm,angle_rad,torque_passive_Nm,angle_rad_target,emg_per_V\n"
            'start,0,nan,0.1,,x,"a,b"\nend,1,inf,0.2,,x,c\n'
        )
    )
    assert list(recording.channels) == ["angle"]
    np.testing.assert_array_equal(recording.channels["angle"].values, [0.1, 0.2])


def test_comments_before_the_header_set_name_and_emg(csv):
    recording = read(csv("# emg: envelope (2 Hz)\n#name = subject 3\n" + GOOD))
    assert (recording.emg, recording.name) == ("envelope", "subject 3")
    assert read(csv("# emg = raw\n" + GOOD)).emg == "raw"
    assert read(csv(GOOD + "# emg: envelope\n")).emg == "raw"


def test_the_content_decides_not_the_name(csv):
    assert read(csv(GOOD, "trial.toml")).channels["angle"].values[0] == 0.1


def test_reference_files(references):
    for path in sorted(references.glob("*.csv")):
        recording = read(path)
        assert len(recording.channels) == 6
        table = np.loadtxt(path, delimiter=",", skiprows=1)
        np.testing.assert_array_equal(recording.channels["angle"].values, table[:, 1])
        np.testing.assert_array_equal(recording.channels["emg_gm"].values, table[:, 6])


def row(number: int, old: str, new: str) -> str:
    """GOOD with one change in line `number`, two comment and blank lines above the rows."""
    lines = GOOD.splitlines()
    lines[1:1] = ["# comment", ""]
    assert old in lines[number - 1]
    lines[number - 1] = lines[number - 1].replace(old, new)
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (row(1, "time_s,", "t_end,"), ["row 1", "missing column time_s", "time_ms", "'angle_rad'"]),
        (row(1, "time_s", "time_d"), ["'time_d'", "row 1", "'d'", "time_s or time_ms"]),
        (row(1, "time_s", "time"), ["'time'", "row 1", "time_s or time_ms"]),
        (row(1, "time_s", "Zeit [ms]"), ["'Zeit [ms]'", "row 1", "time_s or time_ms"]),
        (
            "Zeit [ms];Winkel [deg];Moment [Nm]\n0;1,5;2\n1;2,5;3\n",
            ["'Winkel [deg]' seems to be the angle", "surae inspect"],
        ),
        (row(1, "emg_ta_V", "time_ms"), ["row 1", "'time_s', 'time_ms'", "keep one"]),
        (row(1, "angle_rad", "hoek"), ["row 1", "'hoek' seems to be the angle", "TOML"]),
        (row(1, "angle_rad", "angle_grad"), ["'angle_grad'", "row 1", "'grad'", "rad, deg"]),
        (row(1, "angle_rad", "angle"), ["'angle'", "row 1", "angle_rad, angle_deg"]),
        (row(1, "emg_ta_V", "emg_ta_kV"), ["'emg_ta_kV'", "row 1", "V, mV, uV, 1"]),
        (row(1, "emg_ta_V", "EMG_TA_V"), ["'EMG_TA_V'", "row 1", "emg_ta_V"]),
        (row(1, "torque_Nm", "torque_nm"), ["'torque_nm'", "row 1", "Nm, mNm"]),
        (row(1, "torque_Nm", "angle_rad"), ["'angle_rad'", "row 1", "twice"]),
        (row(1, "torque_Nm", "angle_deg"), ["'angle_deg'", "row 1", "'angle_rad'", "keep one"]),
        (row(1, HEADER, "0,1,2,3"), ["row 1", "numbers where the names"]),
        (row(5, "0.2", ""), ["'angle_rad'", "row 5", "blank"]),
        (row(5, "0.2", "abc"), ["'angle_rad'", "row 5", "'abc' is not a number"]),
        (row(5, "0.2", "0_2"), ["'angle_rad'", "row 5", "'0_2' is not a number"]),
        (row(5, "0.2", "nan"), ["'angle_rad'", "row 5", "nan is not a finite number"]),
        (row(5, ",2,", ",-inf,"), ["'torque_Nm'", "row 5", "-inf is not a finite number"]),
        (row(5, "0.5", "nan"), ["'time_s'", "row 5", "nan is not a finite number"]),
        (row(5, "0.5", "0"), ["'time_s'", "row 5", "doesn't increase", "0 s after 0 s"]),
        (row(6, "1,", "-1,"), ["'time_s'", "row 6", "doesn't increase", "-1 s after 0.5 s"]),
        (row(5, ",2e-6", ""), ["row 5", "3 cells", "4 columns", "none for column 'emg_ta_V'"]),
        (row(5, "2e-6", "2e-6,7"), ["row 5", "5 cells", "4 columns", "'emg_ta_V'"]),
        (
            row(5, "0.2", "0,2").replace(",", ";").replace("0;2", "0,2"),
            ["'angle_rad'", "row 5", "decimal comma", "'0.2'"],
        ),
        (HEADER + "\n", ["row 1", "no samples"]),
        (HEADER + "\n0,1,2,3\n", ["'angle_rad'", "one sample"]),
        ("", ["empty"]),
        (" \r\n\n", ["empty"]),
        ("# only\n# comments\n", ["no header"]),
        ("# emg: filtered\n" + GOOD, ["row 1", "'filtered'", "raw, envelope"]),
        (GOOD.replace("emg_ta_V", "emg_ta_V,emg_sol_1").replace("e-6", "e-6,1"), ["'V'", "'1'"]),
    ],
)
def test_errors_name_column_and_row(csv, text, says):
    path = csv(text)
    with pytest.raises(InputError) as caught:
        read(path)
    text = str(caught.value)
    assert "\n" not in text
    assert "trial" in text
    for part in says:
        assert part in text


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (bytes(range(256)) * 20, "binary"),
        (b"# 5 \x81V\n" + GOOD.encode(), "row 1: byte 0x81 is not UTF-8"),
        (b"\x89PNG\r\n\x1a\n\0\0", "binary"),
        (b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + bytes(100), "the file is damaged"),
    ],
)
def test_binary_files_are_refused(csv, data, says):
    assert says in message(csv(data))


def test_files_that_cannot_be_read(tmp_path, csv, monkeypatch):
    assert "folder" in message(tmp_path)
    assert "no such file" in message(tmp_path / "none.csv")
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    assert "pipe" in message(pipe)
    assert "device" in message("/dev/zero")
    path = csv(GOOD)

    def refuse(*_args, **_kwargs):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    assert message(path).endswith("permission denied")


def test_a_file_with_a_zero_byte_in_its_name_is_refused():
    with pytest.raises(InputError, match="cannot read"):
        read("a\0b.csv")


def test_fast_and_careful_parsing_agree(csv):
    rng = np.random.default_rng(5)
    numbers = rng.normal(size=(500, 4)) * 10.0 ** rng.integers(-300, 300, size=(500, 4))
    body = "\n".join(",".join(map(repr, line)) for line in numbers.tolist())
    source = open_source(csv(f"{HEADER}\n{body}\n"))
    rows = Rows(source=source, header=1, names=tuple(HEADER.split(",")), delimiter=",")
    fast = rows.load([2, 0])
    np.testing.assert_array_equal(fast, numbers[:, [2, 0]].T)
    np.testing.assert_array_equal(rows._load([2, 0]), fast)


@pytest.mark.parametrize(
    ("name", "time"),
    [
        *((name, True) for name in ("temps", "tijd [ms]", "Tiempo (s)", "tempo", "Uhrzeit")),
        *((name, True) for name in ("t", "T [s]", "Time", "time of day", "unix time", "t (h)")),
        *((name, False) for name in ("Zeit (%)", "timex", "temperature", "torque", "t (d)")),
    ],
)
def test_times_of_other_languages_are_known_and_no_unit_is_made_of_their_letters(name, time):
    assert is_time(name) is time


def test_a_european_csv_has_semicolons_and_decimal_commas(tmp_path):
    path = tmp_path / "t.csv"
    text = "Zeit [ms];Winkel Ankle Angle (deg);Torque (N.mm);TA (µV)\n"
    path.write_text(
        text + "0;1;-2000;3,5\n3,90625;1,5;-1,5e3;-4\n7,8125;-2,25;+500;5\n", encoding="utf-8"
    )
    table = open_table(open_source(path))
    columns = table.load(table.names)
    np.testing.assert_array_equal(columns["TA (µV)"].values, [3.5, -4, 5])
    np.testing.assert_array_equal(columns["TA (µV)"].time, [0, 3.90625e-3, 7.8125e-3])
    roles = inspect(path).roles
    assert {role: channel.known_unit for role, channel in roles.items()} == {
        "angle": "deg",
        "torque": "Nmm",
        "emg_ta": "uV",
    }
    ours = "time_s;angle_deg;torque_Nmm\n0,0;1,0;1000,0\n0,1;2,5;-500\n"
    path.write_text(ours, encoding="utf-8")
    channels = read(path).channels
    np.testing.assert_allclose(channels["angle"].values, np.radians([1.0, 2.5]))
    np.testing.assert_array_equal(channels["torque"].values, [1.0, -0.5])


def test_decimal_commas_beside_points_or_between_commas_are_refused(csv):
    assert "has a decimal comma" in message(csv("time_s;angle_rad\n0.0;1,5\n0.1;2,5\n"))
    assert "cells where the header" in message(csv("time_s,angle_rad\n0,0,1,5\n0,1,2,5\n"))


def test_a_preface_and_a_row_of_units_as_noraxon_exports_them(tmp_path):
    path = tmp_path / "t.tsv"
    rows = "".join(f"{i / 1500:.6f}\t{i}.5\t{-i}\t{i % 7}\n" for i in range(50))
    path.write_text(
        "Type:\tEMG\nRecord name:\tFlexion 1\nMeasurement date:\t2024-01-01\n\n"
        "Time,s\tRT TIB.ANT.,uV\tAnkle Angle,deg\tNote\n" + rows,
        encoding="utf-8",
    )
    table = open_table(open_source(path))
    assert table.names == ("RT TIB.ANT.,uV", "Ankle Angle,deg", "Note")
    columns = table.load(table.names)
    np.testing.assert_array_equal(columns["Ankle Angle,deg"].values, -np.arange(50))
    assert columns["Note"].position(0) == "row 6"
    inspection = inspect(path)
    assert inspection.side == "right"
    assert {role: c.known_unit for role, c in inspection.roles.items()} == {
        "angle": "deg",
        "emg_ta": "uV",
    }
    path.write_text("Time\tTA\tAngle\n[ms]\tmV\tdeg\n" + "0\t1\t2\n4\t3\t4\n", encoding="utf-8")
    table = open_table(open_source(path))
    assert dict(table.units) == {"TA": "mV", "Angle": "deg"}
    np.testing.assert_array_equal(table.load(["TA"])["TA"].time, [0, 0.004])


@pytest.mark.parametrize(("rate", "decimals"), [(256, 5), (256, 3), (2048, 5), (1000 / 3, 5)])
def test_time_stamps_rounded_as_programs_write_them_are_uniform(tmp_path, rate, decimals):
    time = np.arange(20 * round(rate)) / rate
    rows = "".join(f"{t:.{decimals}f},{np.sin(t):.6f}\n" for t in time)
    (tmp_path / "t.csv").write_text("time_s,angle_rad\n" + rows, encoding="utf-8")
    axis = timing(read(tmp_path / "t.csv").channels["angle"], "t")
    assert axis.uniform
    np.testing.assert_allclose(axis.axis.time, time, atol=10**-decimals)


def test_a_table_of_more_columns_than_a_recording_has_is_refused_at_its_header(tmp_path) -> None:
    path = tmp_path / "x.csv"
    names = ",".join(f"c{k}" for k in range(10_001))
    path.write_text(f"time_s,{names}\n" + "0" + ",1" * 10_001 + "\n")
    with pytest.raises(InputError, match="10001 columns, more than the 10000 that are read"):
        inspect(path)
