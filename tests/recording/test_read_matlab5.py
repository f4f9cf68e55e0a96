"""MATLAB 5 files, and the ways in which a MATLAB file of any version says its rate."""

import io
import struct
import zlib

import h5py
import numpy as np
import pytest
import scipy.io
from reader_seeds import ANGLE, EMG, RATE, TIME, mat5_file

from surae.errors import InputError


def saved(variables, **options):
    buffer = io.BytesIO()
    scipy.io.savemat(buffer, variables, **options)
    return buffer.getvalue()


@pytest.mark.parametrize("compressed", [False, True])
def test_structures_vectors_and_matrices(table, compressed):
    found = table(mat5_file(compressed=compressed))
    assert set(found.names) == {"Angle", "torque", *(f"emg(:,{i})" for i in (1, 2, 3, 4))}
    columns = found.load(list(found.names))
    np.testing.assert_array_equal(columns["torque"].values, ANGLE)
    np.testing.assert_array_equal(columns["emg(:,3)"].values, EMG[:, 2])
    np.testing.assert_array_equal(columns["torque"].time, TIME)
    # Spike2's channel has a time axis of its own.
    np.testing.assert_allclose(columns["Angle"].time, 0.5 + 0.01 * np.arange(64))
    assert dict(found.units) == {"Angle": "Deg"}
    assert found.remarks["torque"] == "time is taken as seconds"


def test_a_rate_stands_for_times_and_structures_are_searched(table):
    trial = {"angle": ANGLE, "rate": 50.0, "deep": {"time_ms": 1000 * TIME[:9], "x": ANGLE[:9]}}
    found = table(saved({"trial": trial, "y": ANGLE, "Fs": RATE, "name": "a b"}))
    columns = found.load(list(found.names))
    assert set(columns) == {"trial.angle", "trial.deep.x", "y"}
    np.testing.assert_allclose(columns["trial.angle"].time, np.arange(64) / 50)
    np.testing.assert_allclose(columns["trial.deep.x"].time, TIME[:9])
    np.testing.assert_allclose(columns["y"].time, TIME)


def test_the_same_in_version_73(table, tmp_path):
    path = tmp_path / "x.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["emg"], file["fs"] = EMG.T, [[RATE]]
        file["Wave/values"], file["Wave/times"] = ANGLE[None], (TIME**2)[None]
    found = table(path.read_bytes())
    columns = found.load(list(found.names))
    np.testing.assert_array_equal(columns["emg(:,2)"].values, EMG[:, 1])
    np.testing.assert_array_equal(columns["Wave.values"].time, TIME**2)


def test_vectors_without_times_are_no_signals(table):
    with pytest.raises(InputError, match=r"no channels.*'time' or a sampling rate 'fs'"):
        table(saved({"angle": ANGLE, "torque": ANGLE}))
    with pytest.raises(InputError, match="fs and rate: not a sampling rate"):
        table(saved({"angle": ANGLE, "fs": 1.0, "rate": 2.0}))


def element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def variable(shape, data, kind=6, stored=9):
    return element(
        14,
        element(6, struct.pack("<II", kind, 0))
        + element(5, struct.pack(f"<{len(shape)}i", *shape))
        + element(1, b"x")
        + element(stored, data),
    )


HEADER = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"


@pytest.mark.parametrize(
    ("body", "says"),
    [
        (variable((1, 2**31 - 1), bytes(16)), "2147483647 values holds 16 bytes"),
        (variable((2**30, 2**30), bytes(16), kind=1), "elements"),
        (variable((1, -5), bytes(16)), "the shape of a variable"),
        # SciPy would look its type up beyond the end of a table.
        (variable((1, 2), bytes(16), stored=180), "an element of type 180"),
        (struct.pack("<II", 14, 2**31) + bytes(64), "cut short"),
        (element(15, zlib.compress(bytes(400 * 2**20), 9)), "it claims"),
        (element(15, b"no zlib at all"), "damaged"),
        (element(15, zlib.compress(struct.pack("<II", 14, 2**31))), "compressed variable"),
    ],
)
def test_claims_are_checked_before_anything_is_unpacked(table, body, says):
    with pytest.raises(InputError, match=says):
        table(HEADER + body)
