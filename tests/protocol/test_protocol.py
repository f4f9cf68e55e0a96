"""Protocols: settings in, trajectory out."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surae.base.errors import InputError
from surae.protocol import PROFILES, Protocol, generate

EVERY = pytest.mark.parametrize("name", PROFILES)
AMPLITUDE = pytest.mark.parametrize("amplitude", [0.0, 0.2])


@settings(max_examples=40)
@given(
    name=st.sampled_from(sorted(PROFILES)),
    amplitude=st.floats(0.0, 0.45),
    rate=st.floats(0.02, 0.6),
    low=st.floats(-1.0, -0.5),
    rom=st.floats(0.95, 1.6),
)
def test_never_leaves_the_range_of_motion_and_spans_it(name, amplitude, rate, low, rom):
    protocol = Protocol(
        profile=name,
        chirp_amplitude=amplitude,
        chirp_rate=rate,
        angle_range=(low, low + rom),
        rate_hz=2000.0,
    )
    angle = generate(protocol).angle
    assert angle.min() >= low - 1e-9
    assert angle.max() <= low + rom + 1e-9
    assert angle.min() <= low + 1e-3
    assert angle.max() >= low + rom - 1e-3


@EVERY
@AMPLITUDE
def test_velocity_and_acceleration_are_the_derivatives_of_the_angle(name, amplitude):
    trajectory = generate(Protocol(profile=name, chirp_amplitude=amplitude, rate_hz=4000.0))
    h, inner = 1 / 4000.0, slice(2, -2)

    def slope(signal: np.ndarray) -> np.ndarray:
        return (signal[:-4] - 8 * signal[1:-3] + 8 * signal[3:-1] - signal[4:]) / (12 * h)

    np.testing.assert_allclose(trajectory.velocity[inner], slope(trajectory.angle), atol=1e-5)
    np.testing.assert_allclose(
        trajectory.acceleration[inner], slope(trajectory.velocity), atol=5e-3
    )


def test_a_coarser_rate_samples_the_same_motion():
    fine = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.2, rate_hz=2000.0))
    coarse = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.2, rate_hz=125.0))
    np.testing.assert_allclose(coarse.angle, fine.angle[::16], atol=1e-12)
    np.testing.assert_allclose(coarse.effort, fine.effort[::16], atol=1e-12)


def test_shapes_and_time_axis():
    trajectory = generate(Protocol(profile="multiple-holds", rate_hz=125.0))
    n = 35 * 125 + 1
    assert trajectory.time.shape == trajectory.angle.shape == (n,)
    assert trajectory.effort.shape == (n, 4)
    assert trajectory.time[-1] == 35.0
    assert trajectory.adaptation is None
    assert not trajectory.angle.flags.writeable
    assert not trajectory.effort.flags.writeable


def test_chirp_is_added_to_the_narrowed_profile():
    plain = generate(Protocol(profile="multiple-holds"))
    added = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5))
    rest = added.angle - 0.2 * np.sin(np.pi * 0.5 * added.time**2)
    gain, offset = np.polyfit(plain.angle, rest, 1)
    np.testing.assert_allclose(rest, gain * plain.angle + offset, atol=1e-9)
    assert 1 - 2 * 0.2 / 1.5 <= gain < 1.0


def test_chirp_rate_is_irrelevant_without_amplitude():
    slow = generate(Protocol(profile="sine", chirp_rate=0.05))
    fast = generate(Protocol(profile="sine", chirp_rate=0.6))
    np.testing.assert_array_equal(slow.angle, fast.angle)


def test_another_duration_plays_the_profile_slower():
    own = generate(Protocol(profile="multiple-holds", rate_hz=100.0))
    slower = generate(Protocol(profile="multiple-holds", duration=70.0, rate_hz=50.0))
    np.testing.assert_allclose(slower.angle, own.angle, atol=1e-12)
    np.testing.assert_allclose(slower.velocity, own.velocity / 2, atol=1e-6)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"profile": "steps"}, "profile 'steps' is not known"),
        ({"task": "random"}, "task 'random' is not known"),
        ({"chirp_amplitude": 0.75}, r"chirp amplitude 0\.75 rad: .* less than half .*0\.75 rad"),
        ({"chirp_amplitude": -0.1}, "use 0 or more"),
        ({"chirp_amplitude": float("nan")}, "chirp amplitude nan rad"),
        ({"chirp_rate": 0.0}, "chirp rate 0 Hz/s: use more than 0"),
        ({"chirp_rate": 5.0}, r"ends at 175 Hz, .* use a rate above 350 Hz"),
        ({"angle_range": (0.6, -0.9)}, "full plantarflexion must be below dorsiflexion"),
        ({"duration": -1.0}, "duration -1 s"),
        ({"duration": 10.0}, r"passive to 11 s, the whole of 10 s; use a longer duration"),
        ({"rate_hz": 0.0}, "rate 0 Hz"),
    ],
)
def test_wrong_settings_are_refused_in_one_line(change, message):
    right = {"profile": "multiple-holds", "chirp_amplitude": 0.2}
    with pytest.raises(InputError, match=message) as refused:
        generate(Protocol(**(right | change)))
    assert "\n" not in str(refused.value)
