"""The test of whiteness: its size, its power, gaps, and what estimated parameters take out."""

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import norm

from surae.inference import whiteness
from surae.inference.judging.goodness import autocovariance, most_lags


def coloured(rho, n, seed=1):
    return lfilter([1], [1, -rho], np.random.default_rng(seed).standard_normal(n + 500))[500:]


def share_called_white(make, trials=400):
    return np.mean([make(np.random.default_rng(seed)).white for seed in range(trials)])


def test_white_noise_is_called_white_as_often_as_promised():
    called = share_called_white(lambda rng: whiteness(rng.standard_normal(1000), 100.0))
    assert called == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / 400))


def test_gaps_do_not_change_how_often():
    counted = np.ones(1000, dtype=bool)
    counted[100:350] = counted[600:610] = False

    def one(rng):
        noise = rng.standard_normal(1000)
        noise[~counted] = 1e6  # may hold anything
        return whiteness(noise, 100.0, counted)

    called = share_called_white(one)
    assert called == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / 400))


def test_parameters_that_took_correlation_out_do_not_make_it_coloured():
    # Thirty slow curves fitted to 600 samples leave a residual that is slightly anticorrelated.
    t = np.linspace(0, 1, 600)
    Q = np.linalg.qr(np.cos(np.pi * np.outer(t, np.arange(30))))[0].T
    absorbed = np.sum([np.correlate(q, q, "full")[599:] for q in Q], axis=0)

    def residual(rng):
        noise = rng.standard_normal(600)
        return noise - (Q @ noise) @ Q

    naive = share_called_white(lambda rng: whiteness(residual(rng), 100.0))
    known = share_called_white(lambda rng: whiteness(residual(rng), 100.0, None, absorbed))
    assert naive < 0.85
    assert known == pytest.approx(0.95, abs=0.05)


@pytest.mark.parametrize("rho", [0.2, 0.9, 0.99, -0.3])
def test_correlated_noise_is_found(rho):
    assert not whiteness(coloured(rho, 4000), 100.0).white


def test_the_autocorrelation_of_a_first_order_process_is_the_known_one():
    found = whiteness(coloured(0.9, 100_000), 100.0)
    assert found.lag1 == pytest.approx(0.9, abs=0.01)
    np.testing.assert_allclose(found.correlation[:10], 0.9 ** np.arange(10), atol=0.03)
    lag = round(found.fall_s * 100)
    assert abs(found.correlation[lag]) <= found.band
    assert np.all(np.abs(found.correlation[:lag]) > found.band)


def test_the_band_and_the_first_lag_of_white_noise():
    found = whiteness(np.random.default_rng(0).standard_normal(4096), 256.0)
    assert found.band == pytest.approx(norm.ppf(0.975) / 64)
    assert abs(found.lag1) < found.band
    assert found.fall_s == pytest.approx(1 / 256)


def test_an_offset_is_not_white():
    assert not whiteness(np.full(200, 0.25), 100.0).white
    assert whiteness(np.full(200, 0.25), 100.0).lag1 == pytest.approx(1.0, abs=0.01)


def test_no_residual_at_all_is_white():
    found = whiteness(np.zeros(50), 100.0)
    assert (found.lag1, found.p_value, found.white) == (0.0, 1.0, True)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_what_overflows_is_neither(bad):
    residual = np.ones(50)
    residual[7] = bad
    found = whiteness(residual, 100.0)
    assert np.isnan(found.p_value)
    assert not found.white


@pytest.mark.parametrize("n", [2, 3, 15, 16, 40])
def test_short_residuals(n):
    found = whiteness(np.random.default_rng(n).standard_normal(n), 100.0)
    assert 1 <= found.lags == most_lags(n) < max(n, 2)
    assert 0 <= found.p_value <= 1


def test_autocovariance_by_hand():
    signal = np.array([1.0, 2.0, 99.0, 3.0, -1.0])
    counted = np.array([True, True, False, True, True])
    sums, pairs = autocovariance(signal, counted, 3)
    np.testing.assert_allclose(sums, [15.0, 2.0 - 3.0, 6.0, 3.0 - 2.0], atol=1e-12)
    np.testing.assert_allclose(pairs, [4, 2, 1, 2])
