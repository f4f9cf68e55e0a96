"""Every measured file that is kept beside the repository, read by its content."""

import numpy as np
import pytest

from surae.recording import inspect, mapping_text, read
from surae.recording.describe import sampling_of
from surae.recording.formats import open_table
from surae.recording.source import open_source
from surae.signals import prepare

#: File: format, columns, then of one column: name, unit, samples, rate, least and greatest value.
FILES = {
    "devices/EMG_recording.Poly5": (
        *("Poly5", 3),
        *("Bip2", "uV", 172576, 2048.0, 6856.756, 12813.021),
    ),
    "devices/isokinetic_knee.c3d": ("C3D", 4, "Torque", "Nm", 36250, 1250.0, -83.0059, 121.601),
    "devices/eb015pi.c3d": ("C3D", 16, "FZ1", "nt", 1800, 200.0, -838.488, -18.6),
    "devices/trigno_truncated.csv": (
        *("Trigno", 14),
        *("Mini sensor 10: EMG 10", "V", 2519, 1259.259, -0.000461585, 0.00047451),
    ),
    "dynamometer/PL_50_01.mat": ("MATLAB", 6, "Torque", "Nm", 34000, 2000.0, -18.3716, 34.6069),
    "dynamometer/Pas_10.mat": ("MATLAB", 6, "Angle", "Deg", 34000, 2000.0, 7.17163, 8.52966),
    "dynamometer/Pas_Sho2Long.mat": (
        *("MATLAB", 6),
        *("Angle", "Deg", 34000, 2000.0, -20.462, 21.0571),
    ),
    "dynamometer/Ref_Long_01.mat": (
        *("MATLAB", 6),
        *("EMG_TA", "V", 34000, 2000.0, -2.46613, 3.61328),
    ),
    "gait/walk36/ik.sto": ("OpenSim", 23, "ankle_angle_r", None, 6097, 100.0, -15.0246, 13.1366),
    "gait/walk36/id.sto": (
        *("OpenSim", 23),
        *("ankle_angle_r_moment", None, 6097, 100.0, -81.7085, 60.6069),
    ),
    "gait/walk36/emgFilt.sto": (
        *("OpenSim", 9),
        *("tib_ant_r", None, 6097, 100.0, -0.005437, 0.360975),
    ),
    "gait/run81/ik.sto": ("OpenSim", 23, "ankle_angle_r", None, 5838, 100.0, -30.3855, 34.0648),
    "gait/run81/id.sto": (
        *("OpenSim", 23),
        *("ankle_angle_r_moment", None, 5838, 100.0, -430.6, 12.7588),
    ),
    "gait/run81/emgFilt.sto": ("OpenSim", 9, "soleus_r", None, 5838, 100.0, 0.000147, 1.00391),
}


def test_every_measured_file_is_listed_here(shared):
    found = {
        str(path.relative_to(shared))
        for folder in ("devices", "dynamometer", "gait")
        for path in (shared / folder).rglob("*")
        if path.is_file() and not path.name.startswith("LICENSE") and path.suffix != ".toml"
    }
    assert found == set(FILES)


@pytest.mark.parametrize("name", FILES)
def test_channels_units_rates_and_ranges(shared, tmp_path, name):
    form, count, column, unit, n, rate, least, greatest = FILES[name]
    # By content: the name says nothing.
    path = tmp_path / "data"
    path.write_bytes((shared / name).read_bytes())
    table = open_table(open_source(path))
    assert (table.format, len(table.names)) == (form, count)
    one = table.load([column])[column]
    sampling = sampling_of(one.time)
    assert (table.units.get(column), sampling.n) == (unit, n)
    assert sampling.rate_hz == pytest.approx(rate, rel=1e-5)
    values = one.values
    assert values.min() == pytest.approx(least, rel=1e-5)
    assert values.max() == pytest.approx(greatest, rel=1e-5)
    assert np.isfinite(values).all()


@pytest.mark.parametrize("name", ["isokinetic_knee", "eb015pi"])
def test_c3d_is_what_ezc3d_reads(shared, name):
    ezc3d = pytest.importorskip("ezc3d")
    path = shared / "devices" / f"{name}.c3d"
    table = open_table(open_source(path))
    columns = table.load(list(table.names))
    expected = ezc3d.c3d(str(path))
    analogs = expected["data"]["analogs"][0]
    labels = expected["parameters"]["ANALOG"]["LABELS"]["value"]
    assert list(table.names) == labels[: len(analogs)]
    for column, values in zip(columns.values(), analogs, strict=True):
        np.testing.assert_allclose(column.values, values, rtol=1e-6, atol=1e-9)


def test_poly5_emg_on_a_drifting_offset_is_raw(shared):
    found = inspect(shared / "devices" / "EMG_recording.Poly5")
    assert found.emg == "raw"
    # Once for each muscle that the channel may be.
    assert mapping_text(found).count("# offset = -8943.33  # check: never near zero") == 4


def test_channels_of_two_rates_come_on_one_time_base(shared, tmp_path):
    file = shared / "devices" / "trigno_truncated.csv"
    (tmp_path / "map.toml").write_text(
        f'[channels.angle]\nfile = "{file.as_posix()}"\ncolumn = "Mini sensor 10: GYRO.X 10"\n'
        f'unit = "deg"\n[channels.emg_ta]\nfile = "{file.as_posix()}"\n'
        'column = "Mini sensor 10: EMG 10"\n'
    )
    recording = read(tmp_path / "map.toml")
    assert recording.channels["emg_ta"].rate_hz == pytest.approx(1259.259, rel=1e-5)
    assert "cut short: the header states 81141" in recording.channels["emg_ta"].source
    inputs = prepare(recording)
    assert inputs.rate_hz == pytest.approx(148.148, rel=1e-5)
    assert inputs.time[[0, -1]] == pytest.approx([0.0, 1.998], abs=2e-3)
