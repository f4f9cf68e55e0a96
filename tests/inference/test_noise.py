"""Autoregressive noise against its definition."""

import numpy as np
import pytest
from scipy.signal import lfilter

from surae.inference.judging.goodness import autocovariance
from surae.inference.noise import NoiseModel, autoregressive, level_above, whitened

PHI = np.array([1.6, -0.7])


def series(n, seed=0, phi=PHI):
    drive = np.random.default_rng(seed).standard_normal(n + 1000)
    return lfilter([1], np.concatenate([[1], -phi]), drive)[1000:]


def model_of(signal, order=20):
    sums, _ = autocovariance(signal, np.ones(len(signal), dtype=bool), order)
    return autoregressive(sums / len(signal), len(signal))


def test_a_second_order_process_is_found():
    found = model_of(series(200_000))
    assert found.order >= 2
    np.testing.assert_allclose(found.coefficients[:2], PHI, atol=0.02)
    assert np.all(np.abs(found.coefficients[2:]) < 0.02)
    assert found.variance == pytest.approx(1.0, rel=0.02)


def test_white_noise_mostly_has_no_coefficients():
    orders = [model_of(np.random.default_rng(i).standard_normal(500), 10).order for i in range(200)]
    assert np.mean(np.array(orders) == 0) > 0.6


def test_the_spectrum_is_that_of_its_autocovariance():
    found = model_of(series(5000))
    gamma = np.fft.irfft(found.spectrum(4096), 4096)
    # Yule–Walker: the model's autocovariance is the one it was made of, up to its order.
    np.testing.assert_allclose(
        gamma[: found.order + 1], found.autocovariance[: found.order + 1], rtol=1e-6
    )


def test_a_drawn_series_has_the_autocovariance():
    found = model_of(series(5000))
    runs = [series(2000, seed, found.coefficients) for seed in range(200)]
    drawn = np.sqrt(found.variance) * np.array(runs)
    for lag in (0, 1, 5):
        product = np.mean(drawn[:, : 2000 - lag] * drawn[:, lag:])
        assert product == pytest.approx(found.autocovariance[lag], rel=0.05, abs=0.2)


def test_the_doubt_about_the_coefficients_is_honest():
    found = [model_of(series(2000, seed), 2) for seed in range(300)]
    assert all(one.order == 2 for one in found)
    spread = np.cov(np.array([one.coefficients for one in found]).T)
    np.testing.assert_allclose(spread, found[0].uncertainty(), rtol=0.35)


@pytest.mark.parametrize("gamma", [[0.0, 0.0], [1.0, 1.0, 1.0], [1.0, 2.0, 0.5], [1.0]])
def test_what_is_no_autocovariance_does_not_break_it(gamma):
    found = autoregressive(np.array(gamma), 100.0)
    assert isinstance(found, NoiseModel)
    assert np.isfinite(found.spectrum(64)).all()
    assert found.uncertainty().shape == (found.order, found.order)


def test_behind_its_own_filter_noise_is_white_and_of_variance_1():
    model = NoiseModel(PHI, 9.0, np.zeros(1), 1e4)
    rows = whitened(3.0 * np.stack([series(50_000, seed) for seed in (1, 2)]), model)
    np.testing.assert_allclose(rows.std(axis=1), 1.0, rtol=0.02)
    for row in rows:
        assert abs(np.mean(row[1:] * row[:-1])) < 0.03


def test_above_a_part_of_the_rate_the_spectrum_falls_no_further():
    found, part = model_of(series(50_000), 2), 0.1
    level, edge = level_above(found, part), int(4096 * part)
    before, after = found.spectrum(4096), level.spectrum(4096)
    assert level.order == found.order
    assert before[edge:].min() < 0.05 * before[edge]
    assert after[edge:].min() > 0.7 * before[edge]
    expected = np.where(np.arange(2049) < edge, before, np.maximum(before, before[edge]))
    assert after.mean() == pytest.approx(expected.mean(), rel=0.01)
    assert level_above(found, 0.5) is found
