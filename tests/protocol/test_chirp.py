"""The added chirp and the room made for it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surae.protocol.profiles import PROFILES, base_range, chirp, chirp_rate

T = np.linspace(0.0, 35.0, 350001)


def test_instantaneous_frequency_rises_with_the_rate():
    angle, _, _ = chirp(T, amplitude=0.2, rate=0.5)
    upward = T[1:][(angle[:-1] < 0) & (angle[1:] >= 0)]
    period, middle = np.diff(upward), 0.5 * (upward[1:] + upward[:-1])
    np.testing.assert_allclose(1.0 / period, 0.5 * middle, rtol=0.01)
    assert np.abs(angle).max() == pytest.approx(0.2, abs=1e-6)


def test_a_factor_of_the_thesis_is_a_sine_of_the_factor_times_t_squared():
    angle, _, _ = chirp(T, amplitude=0.2, rate=chirp_rate(0.5))
    np.testing.assert_allclose(angle, 0.2 * np.sin(0.5 * T**2), atol=1e-12)


@pytest.mark.parametrize(("amplitude", "rate"), [(0.1, 0.05), (0.2, 0.5), (0.3, 0.6)])
def test_derivatives_are_those_of_the_angle(amplitude, rate):
    h = 1e-4
    angle, velocity, acceleration = chirp(T, amplitude=amplitude, rate=rate)
    inner = slice(1, -1)
    by_angle = (angle[2:] - angle[:-2]) / (2 * h)
    by_velocity = (velocity[2:] - velocity[:-2]) / (2 * h)
    np.testing.assert_allclose(velocity[inner], by_angle, atol=1e-4 * np.abs(velocity).max())
    np.testing.assert_allclose(
        acceleration[inner], by_velocity, atol=1e-4 * np.abs(acceleration).max()
    )


@settings(max_examples=60)
@given(
    name=st.sampled_from(sorted(PROFILES)),
    amplitude=st.floats(0.0, 0.74),
    rate=st.floats(0.01, 1.0),
    low=st.floats(-1.2, -0.9),
)
def test_profile_and_chirp_span_exactly_the_range(name, amplitude, rate, low):
    profile, rom = PROFILES[name], (low, low + 1.5)
    t = np.linspace(0.0, profile.duration, 40001)
    fraction, (added, _, _) = profile.position(t), chirp(t, amplitude=amplitude, rate=rate)
    start, end = base_range(fraction, added, rom)
    total = start + (end - start) * fraction + added
    assert start < end
    assert total.min() == pytest.approx(rom[0], abs=1e-9)
    assert total.max() == pytest.approx(rom[1], abs=1e-9)
