"""Position profiles: range, smoothness, still periods."""

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.protocol.profiles import (
    BLEND,
    ISOMETRIC,
    MULTI_SINE_START,
    MULTIPLE_HOLDS,
    PROFILES,
    RAMP_AND_HOLD,
    Ramp,
    named_profile,
    ramps_and_holds,
)

EVERY = pytest.mark.parametrize("name", PROFILES)


def fine(name: str) -> tuple[np.ndarray, np.ndarray]:
    profile = PROFILES[name]
    t = np.linspace(0.0, profile.duration, int(1000 * profile.duration) + 1)
    return t, profile.position(t)


def test_the_profiles_and_durations_are_those_of_the_thesis():
    durations = {name: profile.duration for name, profile in PROFILES.items()}
    assert (
        durations.items()
        >= {
            "ramp-and-hold": 18.0,
            "sine": 30.0,
            "multiple-holds": 35.0,
            "multi-sine": 40.0,
            "multi-sine-holds": 40.0,
            "scaled-chirp": 40.0,
        }.items()
    )


@EVERY
def test_a_robot_can_follow_it(name):
    # In ranges of motion per second: at most 3.5 rad/s and 20 rad/s² for the default range.
    t, position = fine(name)
    speed = np.gradient(position, t)
    assert np.abs(speed).max() < 3.5 / 1.5
    assert np.abs(np.gradient(speed, t)).max() < 20.0 / 1.5
    assert np.abs(speed[[0, -1]]).max() < 0.01


@EVERY
def test_a_slow_period_lets_the_muscle_relax(name):
    t, position = fine(name)
    slow = np.abs(np.gradient(position, t)) < 0.15
    edges = np.flatnonzero(np.diff(np.concatenate([[0], slow.astype(int), [0]])))
    longest = np.max(edges[1::2] - edges[::2]) / 1000.0
    # The sine has none; the thesis keeps it to see whether a simple profile is enough.
    assert longest > (0.3 if name == "sine" else 2.0)


def test_sine_has_the_frequency_of_the_thesis():
    t, position = fine("sine")
    np.testing.assert_allclose(position, 0.5 - 0.5 * np.cos(0.4 * np.pi * t), atol=1e-12)


def test_scaled_chirp_gets_faster_and_rests_at_mid_range():
    t, position = fine("scaled-chirp")
    crossings = t[np.flatnonzero(np.diff(np.sign(position - 0.5)))]
    assert np.sum(crossings < 10) < np.sum(crossings > 30)
    assert np.abs(position[np.abs(t - 20.0) < 1.0] - 0.5).max() < 0.05


def test_multi_sine_holds_is_slow_first_and_holds_at_many_positions():
    t, position = fine("multi-sine-holds")
    speed = np.abs(np.gradient(position, t))
    assert speed[t < 11].max() < 0.5 * speed[t > 11].max()
    turns = position[1:-1][np.diff(np.sign(np.diff(position))) != 0]
    assert len(turns) >= 8
    assert np.ptp(turns) > 0.8
    assert np.min(np.diff(np.sort(turns))) > 1e-3


@pytest.mark.parametrize("ramps", [RAMP_AND_HOLD, MULTIPLE_HOLDS, MULTI_SINE_START, ISOMETRIC])
def test_every_ramp_comes_to_rest_before_the_next_starts(ramps):
    origin, starts = 0.0, [ramp.start for ramp in ramps[1:]] + [np.inf]
    for ramp, following in zip(ramps, starts, strict=True):
        assert abs(ramp.to - origin) / ramp.speed > BLEND
        assert ramp.end(origin) < following
        origin = ramp.to


def test_ramp_has_its_speed_and_stops_at_its_target():
    ramp = Ramp(1.0, 0.2, 0.4)
    t = np.linspace(0.0, 6.0, 60001)
    position = ramps_and_holds(t, (ramp,), origin=1.0)
    speed = np.gradient(position, t)
    assert speed.min() == pytest.approx(-0.4, abs=1e-9)
    assert ramp.end(1.0) == pytest.approx(3.2)
    np.testing.assert_allclose(position[t <= 1.0], 1.0, atol=1e-14)
    np.testing.assert_allclose(position[t >= 3.2], 0.2, atol=1e-12)


def test_isometric_holds_eight_angles():
    t, position = fine("isometric")
    still = np.abs(np.gradient(position, t)) < 1e-6
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still.astype(int), [0]])))
    long = (edges[1::2] - edges[::2]) > 11e3
    held = position[edges[::2][long]]
    np.testing.assert_allclose(np.sort(held), np.arange(8) / 7, atol=1e-9)


def test_unknown_profile_is_named_with_what_there_is():
    known = ", ".join(PROFILES)
    with pytest.raises(InputError, match=f"'steps' is not known; use one of: {known}"):
        named_profile("steps")
