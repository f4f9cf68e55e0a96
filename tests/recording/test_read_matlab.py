"""MATLAB 7.3 exports of Spike2 channels."""

import h5py
import numpy as np
import pytest

from surae.base.errors import InputError
from surae.recording import read
from surae.recording.formats import open_table
from surae.recording.source import open_source


def group(file, name, values, *, interval=0.5, start=0.25, units="Deg", scale=2.0, offset=1.0):
    channel = file.create_group(name)
    channel["values"] = np.asarray(values)[np.newaxis]
    for key, number in [("scale", scale), ("offset", offset), ("start", start)]:
        channel[key] = [[number]]
    channel["interval"] = [[interval]]
    channel["units"] = np.array([[ord(letter)] for letter in units], dtype=np.uint16)
    return channel


@pytest.fixture
def mat(tmp_path):
    def write(build, roles=("angle",)):
        with h5py.File(tmp_path / "trial.mat", "w", userblock_size=512) as file:
            build(file)
        path = tmp_path / "trial.toml"
        path.write_text(
            "".join(f'[channels.{r}]\nfile = "trial.mat"\ncolumn = "{r}"\n' for r in roles)
        )
        return path

    return write


def test_units_and_time_axis_come_from_the_file(mat):
    def build(file):
        group(file, "angle", [10.0, 20.0, 30.0])
        group(file, "torque", np.array([1, 2], dtype=np.int16), units="N.m", start=0.0)

    channels = read(mat(build, ("angle", "torque"))).channels
    np.testing.assert_allclose(channels["angle"].values, np.deg2rad([10, 20, 30]))
    np.testing.assert_array_equal(channels["angle"].time, [0.25, 0.75, 1.25])
    # Whole numbers are the converter's counts: scale and offset still apply.
    np.testing.assert_array_equal(channels["torque"].values, [3, 5])


def test_columns_of_a_matrix_are_signals(mat):
    matrix = np.arange(12, dtype=np.float32).reshape(4, 3) ** 2

    def build(file):
        file["t"] = np.arange(4.0)[np.newaxis]
        file.create_dataset("x", data=matrix.T, compression="gzip")
        file["y"] = matrix.T.astype("f8")
        file["z"] = matrix.T[:, np.newaxis]

    table = open_table(open_source(mat(build).with_suffix(".mat")))
    columns = table.load(table.names)
    assert len(columns) == 9
    for name, column in columns.items():
        np.testing.assert_array_equal(column.values, matrix[:, int(name[-2]) - 1])


def test_the_users_unit_must_agree_but_may_normalise(mat):
    def build(file):
        group(file, "angle", [1.0, 2.0])
        group(file, "emg_ta", [1.0, 2.0], units="mV")

    path = mat(build, ("angle", "emg_ta"))
    path.write_text(path.read_text() + 'unit = "V"\n')
    with pytest.raises(InputError, match=r"'V' contradicts .*trial\.mat, which states 'mV'"):
        read(path)
    path.write_text(path.read_text().replace('"V"', '"1"'))
    assert read(path).channels["emg_ta"].unit == "1"


@pytest.mark.parametrize(
    ("values", "settings", "says"),
    [
        ([1.0, np.nan], {}, r"trial\.mat: column 'angle', sample 2: nan"),
        ([1.0], {}, "one sample"),
        ([1.0, 2.0], {"interval": 0.0}, "not a time axis"),
        ([1.0, 2.0], {"start": np.inf}, "not a time axis"),
        ([1.0, 2.0], {"units": "furlong"}, "unit is missing"),
        (["a", "b"], {}, "not plain numbers"),
    ],
)
def test_errors(mat, values, settings, says):
    values = np.array(values, dtype="S1") if isinstance(values[0], str) else np.array(values)
    with pytest.raises(InputError, match=says):
        read(mat(lambda file: group(file, "angle", values, **settings)))


def test_links_elsewhere_are_not_followed(mat):
    def build(file):
        group(file, "angle", [1.0, 2.0])
        file["torque"] = h5py.ExternalLink("other.mat", "/torque")
        file["emg_ta"] = h5py.SoftLink("/angle")

    with pytest.raises(InputError, match="no column 'torque'"):
        read(mat(build, ("angle", "torque")))


def test_a_file_without_channels_and_a_damaged_one(mat):
    path = mat(lambda file: file.create_dataset("x", data=[1.0, 2.0]))
    with pytest.raises(InputError, match=r"no channels.*values and interval"):
        read(path)
    data = path.with_name("trial.mat")
    data.write_bytes(data.read_bytes()[:600])
    with pytest.raises(InputError, match="damaged"):
        read(data)


def test_measured_dynamometer(shared):
    recording = read(shared / "dynamometer" / "PL_50_01.toml")
    assert dict(recording.fixed) == {"g2": 0.0, "g3": 0.0, "g4": 0.0}
    assert list(recording.channels) == ["angle", "torque", "emg_ta"]
    for channel in recording.channels.values():
        assert channel.rate_hz == pytest.approx(2000)
        assert len(channel.time) == 34000
    # The channels are sampled one after the other: each has its own first time.
    assert recording.channels["angle"].time[0] == 0.000472
    assert recording.channels["torque"].time[0] == pytest.approx(0.000422)
    assert np.rad2deg(recording.channels["angle"].values.max()) == pytest.approx(19.83642578125)
    with pytest.raises(InputError, match=r"TOML mapping.*'Angle'.*'EMG_TA'"):
        read(shared / "dynamometer" / "Pas_10.mat")
