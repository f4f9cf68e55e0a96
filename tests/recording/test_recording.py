"""Recordings from arrays."""

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.recording import Recording

TIME = [0.0, 0.1, 0.2]
ANGLE = [0.1, 0.2, 0.3]


def test_from_arrays():
    emg = np.arange(12.0).reshape(3, 4)
    recording = Recording.from_arrays(
        TIME, ANGLE, [1, 2, 3], emg, name="x", emg_kind="envelope", velocity=[1, 1, 1]
    )
    assert list(recording.channels) == [
        *("angle", "torque", "emg_ta", "emg_gl", "emg_sol", "emg_gm", "angular_velocity")
    ]
    np.testing.assert_array_equal(recording.channels["emg_gl"].values, [1, 5, 9])
    assert recording.channels["angular_velocity"].unit == "rad/s"
    assert (recording.name, recording.emg) == ("x", "envelope")
    assert recording.files == ()
    emg[:] = 7
    np.testing.assert_array_equal(recording.channels["emg_gl"].values, [1, 5, 9])
    with pytest.raises(ValueError, match="read-only"):
        recording.channels["angle"].values[0] = 0


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"time": [0.0, 0.1, 0.1]}, r"x: time, sample 3: time doesn't increase"),
        ({"time": [0.0, np.nan, 0.1]}, r"x: time, sample 2: nan"),
        ({"time": [0.0, 0.1]}, "angle has 3 samples but time has 2"),
        ({"time": 1.0}, "time is a single number"),
        ({"time": [[0.0], [0.1], [0.2]]}, "time has 2 dimensions"),
        ({"time": [0.0], "angle": [0.0]}, "angle has one sample"),
        ({"time": [], "angle": []}, "angle has no samples"),
        ({"angle": [0.1, np.inf, 0.3]}, "angle, sample 2: inf"),
        ({"angle": ["a", "b", "c"]}, "angle is not an array of numbers"),
        ({"torque": [0.1, 0.2]}, "torque has 2 samples but time has 3"),
        ({"acceleration": [0.1, 0.2, np.nan]}, "angular_acceleration, sample 3: nan"),
        ({"emg": np.zeros((4, 3))}, r"emg has shape \(4, 3\); it must be \(3, 4\).*ta, gl, sol"),
        ({"emg": np.full((3, 4), np.nan)}, "emg_ta, sample 1: nan"),
        ({"emg_kind": "filtered"}, "'filtered' is not known; use one of: raw, envelope"),
    ],
)
def test_from_arrays_refuses(arguments, says):
    with pytest.raises(InputError, match=says):
        Recording.from_arrays(**({"time": TIME, "angle": ANGLE, "name": "x"} | arguments))
