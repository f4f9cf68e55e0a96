"""OpenSim storage files read back to the same numbers."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from surae.errors import InputError
from surae.recording import Recording, read, write_sto

numbers = st.floats(-1e12, 1e12, allow_nan=False)


def recording(n=5, emg_kind="raw", name="trial"):
    time = np.arange(n) / 7.0
    emg = np.outer(np.sin(time), [1e-4, 2e-4, 3e-4, 4e-4])
    return Recording.from_arrays(time, np.cos(time), time**2, emg, name=name, emg_kind=emg_kind)


def assert_same(first, other):
    assert first.channels.keys() == other.channels.keys()
    for role, channel in first.channels.items():
        np.testing.assert_array_equal(channel.time, other.channels[role].time)
        np.testing.assert_array_equal(channel.values, other.channels[role].values)
        assert channel.unit == other.channels[role].unit
    assert first.emg == other.emg


@settings(max_examples=50)
@given(st.data(), st.integers(2, 40), st.sampled_from(["raw", "envelope"]))
def test_round_trip(tmp_path, data, n, emg_kind):
    steps = data.draw(arrays(np.float64, n, elements=st.floats(1e-3, 1e3)))
    angle, torque = (data.draw(arrays(np.float64, n, elements=numbers)) for _ in range(2))
    emg = data.draw(arrays(np.float64, (n, 4), elements=numbers))
    recording = Recording.from_arrays(np.cumsum(steps), angle, torque, emg, emg_kind=emg_kind)
    write_sto(tmp_path / "a.sto", recording)
    assert_same(recording, read(tmp_path / "a.sto"))


def test_layout(tmp_path):
    write_sto(tmp_path / "a.sto", recording(name="a\nb"))
    lines = (tmp_path / "a.sto").read_text(encoding="utf-8").splitlines()
    assert lines[:7] == [
        *("a b", "version=1", "nRows=5", "nColumns=7", "inDegrees=no", "emg=raw", "endheader")
    ]
    assert lines[7].split("\t")[:3] == ["time", "angle_rad", "torque_Nm"]
    assert len(lines) == 8 + 5


def test_many_rows(tmp_path):
    measured = recording(40_000)
    write_sto(tmp_path / "a.sto", measured)
    assert_same(measured, read(tmp_path / "a.sto"))


def test_channels_with_times_of_their_own_are_refused(tmp_path):
    measured = recording()
    late = replace(measured.channels["torque"], time=measured.channels["torque"].time + 1e-4)
    apart = replace(measured, channels={**measured.channels, "torque": late})
    with pytest.raises(InputError, match=r"angle and torque have times of their own.*--prepare"):
        write_sto(tmp_path / "a.sto", apart)
    assert list(tmp_path.iterdir()) == []


def test_a_title_that_would_end_the_header_is_refused(tmp_path):
    with pytest.raises(InputError, match="title of an OpenSim file"):
        write_sto(tmp_path / "a.sto", recording(name="EndHeader"))
