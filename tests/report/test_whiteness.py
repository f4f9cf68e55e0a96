import numpy as np
import pytest

from surae.report.whiteness import whiteness


def test_white_noise_widens_nothing():
    white = whiteness(np.random.default_rng(0).standard_normal(4096), 256.0)
    assert abs(white.lag1) < white.band
    assert white.band == pytest.approx(1.96 / 64)
    assert white.fall_s == pytest.approx(1 / 256)
    assert white.widening == 1.0
    assert not white.coloured


def test_the_widening_of_a_first_order_process_is_the_known_one():
    """√((1 + ρ)/(1 − ρ)) for an autocorrelation ρ^k."""
    rho, n = 0.9, 200_000
    noise = np.random.default_rng(1).standard_normal(n)
    e = np.empty(n)
    e[0] = noise[0]
    for i in range(1, n):
        e[i] = rho * e[i - 1] + noise[i]
    found = whiteness(e, 100.0)
    assert found.lag1 == pytest.approx(rho, abs=0.01)
    assert found.widening == pytest.approx(np.sqrt(19), rel=0.05)
    assert found.coloured
    lag = round(found.fall_s * 100)
    assert abs(found.correlation[lag]) <= found.band
    assert np.all(np.abs(found.correlation[:lag]) > found.band)


def test_a_residual_that_never_changes_is_described():
    constant = whiteness(np.full(50, 0.25), 100.0)
    assert constant.lag1 == 0.0
    assert not constant.coloured
