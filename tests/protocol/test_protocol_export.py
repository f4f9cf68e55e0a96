"""Export to CSV and MATLAB."""

import csv

import numpy as np
import pytest
from scipy.io import loadmat

from surae.base.errors import InputError
from surae.protocol import Protocol, generate, read_protocol, write_protocol_csv, write_protocol_mat

TRAJECTORY = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.2, rate_hz=125.0))
HEADER = ["time_s", "angle_rad", "emg_ta", "emg_gl", "emg_sol", "emg_gm"]


def test_csv_round_trip(tmp_path):
    path = tmp_path / "P.csv"
    write_protocol_csv(TRAJECTORY, path)
    with path.open() as file:
        rows = list(csv.reader(file))
    assert rows[0] == HEADER
    values = np.array(rows[1:], dtype=float)
    np.testing.assert_allclose(values[:, 0], TRAJECTORY.time, atol=1e-10)
    np.testing.assert_allclose(values[:, 1], TRAJECTORY.angle, atol=1e-11)
    np.testing.assert_allclose(values[:, 2:], TRAJECTORY.effort, atol=1e-11)


def test_mat_round_trip(tmp_path):
    path = tmp_path / "P.mat"
    write_protocol_mat(TRAJECTORY, path)
    assert path.read_bytes().startswith(b"MATLAB 5.0 MAT-file")
    read = loadmat(path)
    np.testing.assert_array_equal(read["angle_rad"], TRAJECTORY.angle[:, None])
    np.testing.assert_array_equal(read["angular_velocity_rad_s"][:, 0], TRAJECTORY.velocity)
    np.testing.assert_array_equal(
        read["angular_acceleration_rad_s2"][:, 0], TRAJECTORY.acceleration
    )
    for k, name in enumerate(HEADER[2:]):
        np.testing.assert_array_equal(read[name][:, 0], TRAJECTORY.effort[:, k])
    assert read["rate_hz"].item() == 125.0


@pytest.mark.parametrize("write", [write_protocol_csv, write_protocol_mat])
def test_where_it_cannot_be_written_is_said(tmp_path, write):
    with pytest.raises(InputError, match="cannot write"):
        write(TRAJECTORY, tmp_path / "missing" / "P.out")
    assert list(tmp_path.iterdir()) == []


def test_a_protocol_of_names_alone_is_refused_without_a_warning(tmp_path) -> None:
    (tmp_path / "p.csv").write_text("time_s,angle_rad,emg_ta,emg_gl,emg_sol,emg_gm\n")
    with pytest.raises(InputError, match="no samples"):
        read_protocol(tmp_path / "p.csv")
