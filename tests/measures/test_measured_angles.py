"""Torque over angle as it was measured: holds and stretches, without a model."""

import numpy as np
import pytest

from surae.measures.torque_curve import HeldPoint, measured_slope, stretch


def held(angles, slope=0.21, noise=0.0):
    rng = np.random.default_rng(1)
    return [HeldPoint(f"h{a}", a, 9.0 + slope * a + noise * rng.standard_normal()) for a in angles]


def test_holds_on_a_line_have_its_slope_and_a_narrow_interval():
    seen = measured_slope(held([4.4, 12.0, 20.0]), [], 10.0)
    assert seen.value == pytest.approx(0.21)
    assert seen.interval == pytest.approx((0.21, 0.21))
    assert (seen.low, seen.high, seen.holds) == (4.4, 20.0, 3)


def test_the_interval_of_a_line_is_that_of_least_squares():
    from scipy.stats import linregress, t

    points = held([-20.0, -8.0, 4.0, 20.0], noise=0.5)
    line = linregress([p.angle for p in points], [p.torque for p in points])
    half = t.ppf(0.975, 2) * line.stderr
    seen = measured_slope(points, [], 10.0)
    assert seen.interval == pytest.approx((line.slope - half, line.slope + half))


def test_two_holds_have_a_slope_without_an_interval_and_close_ones_none():
    assert measured_slope(held([0.0, 10.0]), [], 10.0).interval is None
    assert measured_slope(held([9.0, 10.0, 11.0]), [], 10.0) is None


def moved(back):
    """A stretch from −20° to 20° and back, which lags by 1 Nm either way."""
    up = np.linspace(-20.0, 20.0, 4001)
    way = np.concatenate([up, up[::-1][::back]])
    velocity = np.gradient(way)
    torque = 0.3 * way + np.sign(velocity)
    return np.radians(way), velocity, torque


def test_a_stretch_is_averaged_by_angle_and_direction():
    seen = stretch("slow", *moved(1))
    inner = np.abs(seen.angle) < 19.0
    np.testing.assert_allclose(seen.loading[inner], 0.3 * seen.angle[inner] + 1.0, atol=0.01)
    np.testing.assert_allclose(seen.unloading[inner], 0.3 * seen.angle[inner] - 1.0, atol=0.01)
    slope = measured_slope([], [seen], 10.0)
    assert slope.value == pytest.approx(0.3, abs=0.005)
    assert slope.holds == 0


def test_a_quick_return_is_left_out():
    seen = stretch("quick", *moved(400))
    assert np.isnan(seen.unloading).all()
    assert measured_slope([], [seen], 10.0).interval is None
