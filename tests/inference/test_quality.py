"""Goodness of fit by hand, and the whiteness of a residual."""

import numpy as np
import pytest

from surae.inference import rmse, vaf


def test_vaf_by_hand():
    # 100·(1 − (1 + 4)/(9 + 16)) = 80 %
    assert vaf(np.array([3.0, 4.0]), np.array([1.0, -2.0])) == pytest.approx(80.0, rel=1e-15)


def test_vaf_does_not_subtract_the_mean():
    # Equation (31): an offset in the torque counts as torque, in the residual as residual.
    assert vaf(np.full(4, 10.0), np.full(4, 1.0)) == pytest.approx(99.0, rel=1e-14)


def test_vaf_of_a_perfect_and_a_useless_model():
    torque = np.array([1.0, -2.0, 3.0])
    assert vaf(torque, np.zeros(3)) == 100.0
    assert vaf(torque, torque) == 0.0
    assert vaf(torque, -2 * torque) == -300.0


def test_rmse_by_hand():
    assert rmse(np.array([3.0, -4.0, 0.0, 0.0])) == 2.5
