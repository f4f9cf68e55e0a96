"""The noise behind a residual, from which a fit has already taken a part."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from surae.base.frozen import read_only
from surae.inference.noise import noise_behind
from surae.inference.posterior.empirical_bayes import level_where_filtered
from surae.protocol import Protocol, generate
from surae.signals.prepare import smoothed
from surae.studies import virtual_subject, virtual_trial

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


def as_it_is(residual, lags):
    return noise_behind(residual, np.zeros((0, len(residual))), lags)


@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_what_a_fit_took_of_the_slow_noise_is_given_back(correlation):
    rng, columns = np.random.default_rng(3), slow_columns()
    true = 1.0 / (1.0 - correlation) ** 2
    left, given_back = [], []
    for _ in range(12):
        e = noise(correlation, rng)
        residual = e - columns.T @ (columns @ e)
        left.append(as_it_is(residual, 30).below(SLOW))
        given_back.append(noise_behind(residual, columns, 30).below(SLOW))
    assert np.mean(given_back) == pytest.approx(true, rel=0.06)
    assert np.mean(left) < 0.95 * true  # without it, noise is taken for less than it is


def test_a_fit_of_nothing_takes_nothing():
    e = noise(0.5, np.random.default_rng(1))
    behind = as_it_is(e, 20)
    assert behind.variance == pytest.approx(1.0, rel=0.1)
    assert behind.below(SLOW) == pytest.approx(1.0 / (1.0 - 0.5) ** 2, rel=0.2)


def test_no_frequency_that_a_filter_emptied_is_trusted_more():
    motion = generate(Protocol(profile="multiple-holds", rate_hz=128.0, duration=20.0))
    clean = virtual_trial(virtual_subject(1), motion, noise=0.0)
    white = 0.1 * np.random.default_rng(2).standard_normal(clean.n)
    filtered = smoothed(replace(clean, torque=read_only(white), lowpass=(20.0, 4)))
    assert filtered.torque is not None

    def believed(lowpass):
        model = as_it_is(filtered.torque, 30)
        recording = replace(clean, lowpass=lowpass)
        return np.sqrt(level_where_filtered(model, recording).spectrum(256))

    assert believed(None)[-20:].max() < 0.01  # nothing says that it went through a filter
    np.testing.assert_allclose(believed((20.0, 4)), 0.1, rtol=0.25)
