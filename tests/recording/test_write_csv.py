"""Writing CSV: every number comes back, and a file is written whole or not at all."""

import os
import stat
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from surae.base.errors import InputError
from surae.base.files import atomic_file, read_bytes, sha256, write_atomic
from surae.recording import Channel, Recording, read, write_csv
from surae.recording.writing import shared_time

#: Columns and the largest values that a channel takes, see `Channel`.
ROLES = {
    "angle_rad": 1e5,
    "torque_Nm": 1e6,
    "emg_ta_V": 1e9,
    "emg_gm_V": 1e9,
    "angular_velocity_rad_s": 1e7,
}


@st.composite
def tables(draw):
    times = st.lists(st.floats(-4e5, 4e5), min_size=2, max_size=30, unique=True)
    time = draw(times.filter(lambda t: max(t) - min(t) > 1e-6 * len(t)))
    columns = {"time_s": np.sort(np.array(time))}
    for role, most in ROLES.items():
        values = arrays(np.float64, len(time), elements=st.floats(-most, most))
        columns[role] = draw(values.filter(lambda v: not 0.0 < np.abs(v).max() < 1e-9))
    names = draw(st.permutations(list(columns)))
    return {name: columns[name] for name in names}


@settings(max_examples=25)
@given(columns=tables(), comments=st.lists(st.text(max_size=20), max_size=3))
def test_round_trip(tmp_path, columns, comments):
    path = tmp_path / "out.csv"
    comments = [text for text in comments if text.isprintable()]
    write_csv(path, columns, [*comments, "emg: envelope"])
    recording = read(path)
    assert recording.emg == "envelope"
    for name, role in zip(
        ROLES, ("angle", "torque", "emg_ta", "emg_gm", "angular_velocity"), strict=True
    ):
        channel = recording.channels[role]
        np.testing.assert_array_equal(channel.time, columns["time_s"])
        np.testing.assert_array_equal(channel.values, columns[name])


def test_layout(tmp_path):
    path = tmp_path / "out.csv"
    write_csv(path, {"time_s": [0, 1], "torque_Nm": [0.1, 1e-7]}, ["two\nlines", ""])
    assert path.read_text() == "# two\n# lines\ntime_s,torque_Nm\n0.0,0.1\n1.0,1e-07\n"


def test_many_rows(tmp_path):
    time = np.arange(40000) / 2048
    write_csv(tmp_path / "out.csv", {"time_s": time, "angle_rad": np.sin(time)})
    np.testing.assert_array_equal(read(tmp_path / "out.csv").channels["angle"].values, np.sin(time))


@pytest.mark.parametrize(
    ("columns", "says"),
    [
        ({}, "no columns"),
        ({"a": [1.0], "b": [1.0, 2.0]}, r"column 'b' has shape \(2,\); the first has \(1,\)"),
        ({"a": [[1.0], [2.0]]}, r"column 'a' has shape \(2, 1\)"),
        ({"a": [1.0, np.nan]}, "column 'a', sample 2: nan"),
        ({"a,b": [1.0]}, "'a,b' cannot be the name"),
        ({"": [1.0]}, "'' cannot be the name"),
        ({"a\n": [1.0]}, "cannot be the name"),
    ],
)
def test_refuses_what_would_not_read_back(tmp_path, columns, says):
    with pytest.raises(InputError, match=says):
        write_csv(tmp_path / "out.csv", columns)
    assert not list(tmp_path.iterdir())


def test_what_cannot_be_written(tmp_path):
    columns = {"a": [1.0]}
    with pytest.raises(InputError, match=r"cannot write .*none/out\.csv: no such file"):
        write_csv(tmp_path / "none" / "out.csv", columns)
    with pytest.raises(InputError, match=r"cannot write .*: it is a folder"):
        write_csv(tmp_path, columns)
    with pytest.raises(InputError, match="zero byte"):
        write_csv("a\0b", columns)
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match=r"cannot write .*: not a directory"):
        write_csv(tmp_path / "file" / "out.csv", columns)


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "out.txt"
    write_atomic(path, "old")

    def fail():
        with atomic_file(path) as handle:
            handle.write(b"new")
            raise OSError(28, "No space left on device")

    with pytest.raises(InputError, match=r"cannot write .*out\.txt: no space left on device"):
        fail()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_permissions_and_links_are_kept(tmp_path):
    path, link = tmp_path / "out.txt", tmp_path / "link"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    write_atomic(link, "µ")
    assert link.is_symlink()
    assert path.read_bytes() == "µ".encode()
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_devices_and_pipes_are_written_to_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    received = []
    reader = threading.Thread(target=lambda: received.append(pipe.read_bytes()))
    reader.start()
    write_atomic(pipe, b"through")
    reader.join(60)
    assert received == [b"through"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_reading_is_bounded(tmp_path):
    path = tmp_path / "big"
    path.write_bytes(b"12345")
    assert read_bytes(path, limit=5) == b"12345"
    assert sha256(b"12345").startswith("5994471abb01112a")
    with pytest.raises(InputError, match="larger than"):
        read_bytes(path, limit=4)


def test_channels_with_times_of_their_own_are_refused():
    time = np.arange(10) / 10
    channels = {
        role: Channel(role, own, np.sin(own), unit, "x")
        for role, own, unit in (("angle", time, "rad"), ("torque", time[::2], "Nm"))
    }
    with pytest.raises(InputError, match="angle and torque have times of their own"):
        shared_time(Recording("two", channels), "cannot write a.csv")
