"""Every measured file that is kept beside the repository, read by its content."""

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.recording import inspect, mapping_text, read
from surae.recording.formats import open_table
from surae.recording.source import open_source
from surae.recording.table import sampling_of
from surae.signals import prepare


def every(table):
    return table.load(list(table.names))


#: File: format, columns, then of one column: name, unit, samples, rate, least and greatest value.
FILES = {
    "devices/EMG_recording.Poly5": (
        *("Poly5", 3),
        *("Bip2", "uV", 172576, 2048.0, 6856.756, 12813.021),
    ),
    "devices/isokinetic_knee.c3d": ("C3D", 4, "Torque", "Nm", 36250, 1250.0, -83.0059, 121.601),
    "devices/eb015pi.c3d": ("C3D", 94, "FZ1", "nt", 1800, 200.0, -838.488, -18.6),
    "c3d/gait_points_and_analog.c3d": (
        *("C3D", 261),
        *("FZ2", "N", 2272, 800.0, -677.464, 1.43531),
    ),
    "c3d/evart.c3d": ("C3D", 94, "F1X1", "V", 4131, 1020.0, -3.25141, 1.03987),
    "c3d/kyowadengyo.c3d": ("C3D", 57, "1FX1", "N", 152, 60.0, -44.2097, 31.4646),
    "c3d/basketball.c3d": ("C3D", 66, "2000.Z", None, 34, 25.0, 1.63067, 2.15040),
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


@pytest.mark.parametrize("name", FILES)
def test_channels_units_rates_and_ranges(shared, tmp_path, name):
    form, count, column, unit, n, rate, least, greatest = FILES[name]
    # By content: the name says nothing.
    path = tmp_path / "data"
    path.write_bytes((shared / name).read_bytes())
    table = open_table(open_source(path))
    assert (table.format, len(table.names)) == (form, count)
    loaded = table.load([column])[column]
    sampling = sampling_of(loaded.time)
    assert (table.units.get(column), sampling.n) == (unit, n)
    assert sampling.rate_hz == pytest.approx(rate, rel=1e-5)
    values = loaded.values
    assert values.min() == pytest.approx(least, rel=1e-5)
    assert values.max() == pytest.approx(greatest, rel=1e-5)
    assert np.isfinite(values).all()


@pytest.mark.parametrize(
    "name",
    ["devices/isokinetic_knee", "devices/eb015pi", "c3d/gait_points_and_analog", "c3d/basketball"],
)
def test_c3d_is_what_ezc3d_reads_where_header_and_parameters_agree(shared, name):
    ezc3d = pytest.importorskip("ezc3d")
    path = shared / f"{name}.c3d"
    columns = list(every(open_table(open_source(path))).values())
    data = ezc3d.c3d(str(path))["data"]
    analogs = data["analogs"][0]
    for column, values in zip(columns, analogs, strict=False):
        np.testing.assert_allclose(column.values, values, rtol=1e-6, atol=1e-9)
    coordinates = data["points"][:3].transpose(1, 0, 2).reshape(-1, data["points"].shape[2])
    for column, values in zip(columns[len(analogs) :], coordinates, strict=True):
        seen = values[np.isfinite(values)]
        if seen.size:  # ezc3d believes that every frame of a file may be lost
            np.testing.assert_allclose(column.values, seen, rtol=1e-6)


@pytest.mark.parametrize(("name", "analog"), [("evart", 24), ("kyowadengyo", 24)])
def test_c3d_is_smooth_where_ezc3d_reads_noise(shared, name, analog):
    """Header and size of these files contradict the parameters, which ezc3d believes."""
    ezc3d = pytest.importorskip("ezc3d")
    path = shared / "c3d" / f"{name}.c3d"
    table = open_table(open_source(path))
    names = [column for column in table.names[:analog] if "scale is 0" not in table.remarks[column]]
    ours = [column.values for column in table.load(names).values()]
    theirs = ezc3d.c3d(str(path))["data"]["analogs"][0][: len(ours)]
    assert np.median([roughness(x) for x in ours]) < 0.15
    assert np.median([roughness(x) for x in theirs if x.std() > 0]) > 0.3


def roughness(values):
    """How much successive samples differ, in standard deviations."""
    return np.abs(np.diff(values)).mean() / values.std()


def test_joint_angles_and_moments_are_channels_with_units_and_gaps(shared):
    path = shared / "c3d" / "gait_points_and_analog.c3d"
    table = open_table(open_source(path))
    columns = table.load(["A22:LAnkleAngles.X", "A22:LAnkleMoment.X"])
    angle, moment = columns["A22:LAnkleAngles.X"], columns["A22:LAnkleMoment.X"]
    units = [table.units[name] for name in columns]
    assert units == ["deg", "Nmm"]
    assert (len(angle.values), len(moment.values)) == (114, 110)
    assert (angle.values.min(), angle.values.max()) == pytest.approx((-23.79734, 14.40940))
    assert moment.values.max() == pytest.approx(1297.828)
    assert table.remarks["A22:LAnkleMoment.X"] == "only 110 of 142 frames have it"
    assert moment.time[0] == pytest.approx(2 / 50)
    inspection = inspect(path, side="left")
    assert {role: channel.column for role, channel in inspection.roles.items()} == {
        "angle": "A22:LAnkleAngles.X",
        "torque": "A22:LAnkleMoment.X",
    }
    assert inspection.roles["torque"].known_unit == "Nmm"


def test_points_and_analog_of_two_rates_are_one_recording(shared, tmp_path):
    path = (shared / "c3d" / "gait_points_and_analog.c3d").as_posix()
    (tmp_path / "map.toml").write_text(
        f'[channels.angle]\nfile = "{path}"\ncolumn = "A22:LAnkleAngles.X"\n'
        f'[channels.torque]\nfile = "{path}"\ncolumn = "A22:LAnkleMoment.X"\n'
        f'[channels.emg_ta]\nfile = "{path}"\ncolumn = "EMG1"\n'
    )
    channels = read(tmp_path / "map.toml").channels
    assert [round(channels[role].rate_hz) for role in ("angle", "emg_ta")] == [50, 800]
    assert channels["torque"].values.max() == pytest.approx(1.297828)
    assert "only 110 of 142 frames have it" in channels["torque"].source


def test_channels_without_a_scale_are_left_out_and_the_others_read(shared):
    inspection = inspect(shared / "c3d" / "evart.c3d")
    left_out = [channel.column for channel in inspection.channels if not channel.usable]
    assert left_out == ["F4Z", "M4X", "M4Y", "M4Z"]
    assert "states no scale" in next(c.remark for c in inspection.channels if c.column == "M4X")
    assert "the file states 1000 Hz, but 17 samples in each of 60 frames/s are 1020 Hz" in next(
        c.remark for c in inspection.channels if c.column == "F1X1"
    )


def test_markers_alone_are_said_to_be_so(shared):
    path = shared / "c3d" / "basketball.c3d"
    inspection = inspect(path)
    assert len(inspection.channels) == 66
    assert all("this file holds markers alone" in channel.remark for channel in inspection.channels)
    with pytest.raises(InputError, match="markers alone"):
        read(path)


@pytest.mark.parametrize("name", [name for name in FILES if name.endswith((".c3d", ".Poly5"))])
def test_a_truncated_copy_is_refused_or_says_what_it_lacks(shared, table, name):
    data = (shared / name).read_bytes()
    for part in (0.3, 0.9):
        try:
            cut = table(data[: int(part * len(data))])
        except InputError as error:
            assert any(w in str(error) for w in ("cut short", "contradicts itself", "damaged"))  # noqa: PT017
            continue
        assert all("it holds" in remark for remark in cut.remarks.values())
        assert cut.remarks.keys() == set(cut.names)


def test_poly5_emg_on_a_drifting_offset_is_raw(shared):
    inspection = inspect(shared / "devices" / "EMG_recording.Poly5")
    assert inspection.emg == "raw"
    # Once for each muscle that the channel may be.
    assert mapping_text(inspection).count("# offset = -8943.33  # check: never near zero") == 4


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
