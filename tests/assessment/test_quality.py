"""Goodness of fit by hand, and the whiteness of a residual."""

import numpy as np
import pytest

from surae.assessment import autocorrelation, rmse, vaf


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


def direct(residual, lags):
    e = residual - residual.mean()
    return np.array([e[: len(e) - k] @ e[k:] for k in range(lags + 1)]) / (e @ e)


@pytest.mark.parametrize("n", [2, 3, 17, 64, 1000])
def test_autocorrelation_equals_the_direct_sum(n):
    residual = np.random.default_rng(n).standard_normal(n) + 5.0
    lags = min(n - 1, 40)
    found = autocorrelation(residual, lags)
    assert found.shape == (lags + 1,)
    np.testing.assert_allclose(found, direct(residual, lags), atol=1e-12)
    assert found[0] == 1.0


def test_autocorrelation_of_white_noise_is_small():
    residual = np.random.default_rng(1).standard_normal(4096)
    outside = np.abs(autocorrelation(residual, 100)[1:]) > 1.96 / np.sqrt(4096)
    assert outside.mean() < 0.12


def test_autocorrelation_of_a_constant():
    np.testing.assert_array_equal(autocorrelation(np.full(10, 0.1), 3), [1.0, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(autocorrelation(np.full(7, 1e6 / 3), 2), [1.0, 0.0, 0.0])
