"""The noise behind a residual, from which a fit has already taken a part."""

import numpy as np
import pytest
from scipy.signal import lfilter

from surae.estimation.noise import noise_behind, noise_of

RATE, N, SLOW = 128.0, 4480, 0.5 / 128.0


def slow_columns():
    """Thirty orthonormal columns below half a hertz: what slow parameters fit."""
    time = np.arange(N) / RATE
    waves = [
        wave(2 * np.pi * k * time / time[-1]) for k in range(1, 16) for wave in (np.sin, np.cos)
    ]
    return np.linalg.qr(np.array(waves).T)[0].T


def noise(correlation, rng):
    return lfilter([1.0], [1.0, -correlation], rng.standard_normal(N + 500))[500:]


@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_what_a_fit_took_of_the_slow_noise_is_given_back(correlation):
    rng, columns = np.random.default_rng(3), slow_columns()
    true = 1.0 / (1.0 - correlation) ** 2
    left, given_back = [], []
    for _ in range(12):
        e = noise(correlation, rng)
        residual = e - columns.T @ (columns @ e)
        left.append(noise_of(residual, 30).below(SLOW))
        given_back.append(noise_behind(residual, columns, 30).below(SLOW))
    assert np.mean(given_back) == pytest.approx(true, rel=0.06)
    assert np.mean(left) < 0.95 * true  # without it, noise is taken for less than it is


def test_a_fit_of_nothing_takes_nothing():
    e = noise(0.5, np.random.default_rng(1))
    plain, behind = noise_of(e, 20), noise_behind(e, np.zeros((0, N)), 20)
    assert behind.coefficients == pytest.approx(plain.coefficients)
    assert behind.variance == pytest.approx(plain.variance)
