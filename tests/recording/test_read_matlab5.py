"""MATLAB 5 files, and the ways in which a MATLAB file of any version says its rate."""

import io
import struct
import zlib

import h5py
import numpy as np
import pytest
import scipy.io
from reader_seeds import ANGLE, EMG, RATE, TIME, mat5_file

from surae.base.errors import InputError
from surae.recording.programs import foreign, matlab


def saved(variables, **options):
    buffer = io.BytesIO()
    scipy.io.savemat(buffer, variables, **options)
    return buffer.getvalue()


@pytest.mark.parametrize("compressed", [False, True])
def test_structures_vectors_and_matrices(table, compressed):
    contents = table(mat5_file(compressed=compressed))
    assert set(contents.names) == {"Angle", "torque", *(f"emg(:,{i})" for i in (1, 2, 3, 4))}
    columns = contents.load(list(contents.names))
    np.testing.assert_array_equal(columns["torque"].values, ANGLE)
    np.testing.assert_array_equal(columns["emg(:,3)"].values, EMG[:, 2])
    np.testing.assert_array_equal(columns["torque"].time, TIME)
    # Spike2's channel has a time axis of its own.
    np.testing.assert_allclose(columns["Angle"].time, 0.5 + 0.01 * np.arange(64))
    assert dict(contents.units) == {"Angle": "Deg"}
    assert contents.remarks["torque"] == "time is taken as seconds"


def test_a_rate_stands_for_times_and_structures_are_searched(table):
    trial = {"angle": ANGLE, "rate": 50.0, "deep": {"time_ms": 1000 * TIME[:9], "x": ANGLE[:9]}}
    contents = table(saved({"trial": trial, "y": ANGLE, "Fs": RATE, "name": "a b"}))
    columns = contents.load(list(contents.names))
    assert set(columns) == {"trial.angle", "trial.deep.x", "y"}
    np.testing.assert_allclose(columns["trial.angle"].time, np.arange(64) / 50)
    np.testing.assert_allclose(columns["trial.deep.x"].time, TIME[:9])
    np.testing.assert_allclose(columns["y"].time, TIME)


def test_the_same_in_version_73(table, tmp_path):
    path = tmp_path / "x.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["emg"], file["fs"] = EMG.T, [[RATE]]
        file["Wave/values"], file["Wave/times"] = ANGLE[None], (TIME**2)[None]
    contents = table(path.read_bytes())
    columns = contents.load(list(contents.names))
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
    "body",
    [
        variable((1, 2**31 - 1), bytes(16)),
        variable((2**30, 2**30), bytes(16), kind=1),
        variable((1, -5), bytes(16)),
        # SciPy looks its type up beyond the end of a table.
        variable((1, 2), bytes(16), stored=180),
        struct.pack("<II", 14, 2**31) + bytes(64),
        element(15, b"no zlib at all"),
        element(15, zlib.compress(struct.pack("<II", 14, 2**31))),
    ],
)
def test_claims_that_the_file_does_not_hold_are_refused_wherever_scipy_notices(table, body):
    with pytest.raises(InputError, match=r"damaged|no channels"):
        table(HEADER + body)


def test_a_matlab_file_that_unpacks_without_end_meets_the_limit_of_memory(table, monkeypatch):
    monkeypatch.setattr(foreign, "_MEMORY", 600 * 2**20)
    with pytest.raises(InputError, match="damaged"):
        table(HEADER + element(15, zlib.compress(bytes(600 * 2**20), 1)))


def test_objects_are_named_with_how_to_save_them_plainly(tmp_path, table):
    path = tmp_path / "x.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, kind in (("T", "timetable"), ("note", "string")):
            file[name] = np.zeros((1, 6), dtype=np.uint32)
            file[name].attrs["MATLAB_class"] = np.bytes_(kind)
            file[name].attrs["MATLAB_object_decode"] = np.int32(3)
    with pytest.raises(InputError, match=r"'T': a MATLAB timetable, .*timetable2table\(T\).*save"):
        table(path.read_bytes())
    with h5py.File(path, "a") as file:
        file["x"], file["fs"] = ANGLE[None], [[RATE]]
    columns = table(path.read_bytes())
    assert columns.names == ("T", "x")
    np.testing.assert_array_equal(columns.load(["x"])["x"].values, ANGLE)
    with pytest.raises(InputError, match="column 'T': a MATLAB timetable"):
        columns.load(["T"])


def test_objects_of_version_5_are_named_too():
    opaque = np.array(
        [(b"trial", b"MCOS", b"table", np.zeros((6, 1), np.uint32))],
        dtype=[("s0", "O"), ("s1", "O"), ("s2", "O"), ("arr", "O")],
    ).view(scipy.io.matlab.MatlabOpaque)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scipy.io, "loadmat", lambda *_, **__: {"None": opaque, "__header__": b""})
        with pytest.raises(InputError, match=r"'trial': a MATLAB table, .*table2struct\(trial"):
            matlab.parse(b"MATLAB 5.0 MAT-file", "x")
