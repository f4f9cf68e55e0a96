"""A valley that is flatter than its quadratic is told from one that is not."""

import numpy as np
import pytest

from surae.estimation.flatness import flatness
from surae.estimation.mode import Mode

COVARIANCE = np.array([[1.0, 0.95], [0.95, 1.0]])
LEAST = Mode(np.zeros(2), 10.0)


class Surface:
    """A target whose searches end where they are told to."""

    def __init__(self, ends):
        self.ends = list(ends)
        self.begun = []

    def descend(self, z, **_limits):
        self.begun.append(z)
        return self.ends.pop(0)


def test_searches_that_come_back_widen_nothing():
    surface = Surface([Mode(np.full(2, 0.02), 10.001), Mode(np.full(2, -0.02), 10.001)])
    flat = flatness(surface, LEAST, COVARIANCE)
    assert flat.mode is LEAST
    assert not flat.shifts.any()
    # they begin one standard deviation to either side, along the least certain direction
    begun = np.abs(np.array(surface.begun))
    assert begun == pytest.approx(np.full((2, 2), np.sqrt(1.95 / 2.0)))


def test_searches_that_end_as_high_as_the_quadratic_says_widen_nothing():
    away = np.array([1.0, 1.0])
    risen = float(away @ np.linalg.inv(COVARIANCE) @ away)
    surface = Surface([Mode(away, 10.0 + risen), Mode(-away, 10.0 + 1.5 * risen)])
    assert flatness(surface, LEAST, COVARIANCE).shifts == pytest.approx(np.zeros((2, 2)), abs=1e-6)


def test_a_flat_valley_is_as_wide_as_the_rise_along_it_says():
    away = np.array([1.0, 1.0])
    expected = float(away @ np.linalg.inv(COVARIANCE) @ away)
    risen = expected / 3.0  # three times the variance
    surface = Surface([Mode(away, 10.0 + risen), Mode(-away, 10.0 + risen)])
    shifts = flatness(surface, LEAST, COVARIANCE).shifts
    wider = COVARIANCE + shifts.T @ shifts
    assert away @ np.linalg.inv(wider) @ away == pytest.approx(risen)


def test_the_lowest_end_is_the_mode():
    lower = Mode(np.array([0.5, 0.5]), 9.0)
    flat = flatness(Surface([lower, LEAST]), LEAST, COVARIANCE)
    assert flat.mode is lower
