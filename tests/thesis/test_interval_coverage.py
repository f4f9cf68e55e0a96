"""95 % intervals hold the truth 95 % of the time, whether noise is white or not."""

import numpy as np
import pytest
from scipy.signal import lfilter

from benchmark_files import load
from promises import arms_known

BENCHMARK = load("intervals")

REALISATIONS = 150


def covered(clean, subject, rho, realisations):
    sd = 0.05 * np.abs(clean.torque).mean()
    drive = sd * np.sqrt(1 - rho**2)

    def noise(rng, n):
        first = rho * sd * rng.standard_normal()
        return lfilter([1], [1, -rho], drive * rng.standard_normal(n), zi=[first])[0]

    def whiten(rows):
        later = (rows[..., 1:] - rho * rows[..., :-1]) / drive
        return np.concatenate([rows[..., :1] / sd, later], axis=-1)

    return BENCHMARK.coverage(clean, subject.parameters, noise, whiten, realisations=realisations)


def least(share):
    """Three binomial standard errors below a share; the widest of fifteen parameters needs them."""
    return share - 3 * np.sqrt(share * (1 - share) / REALISATIONS)


@pytest.mark.slow
def test_white_noise(clean, subject):
    with arms_known():  # else intervals hold all of what noise does
        result = covered(clean, subject, 0.0, REALISATIONS)
    assert result.robust < 0.15
    for row in result.rows:
        if row.is_identified:
            assert least(0.95) < row.default <= 1, row
            assert least(0.95) < row.thesis <= 1, row
            # The root mean square of so many errors is known to 6 %.
            assert row.rmse < 1.1 * row.bound * (1 + 2 / np.sqrt(2 * REALISATIONS)), row
    assert sum(row.is_identified for row in result.rows) >= 12


@pytest.mark.slow
@pytest.mark.parametrize("rho", [0.9, 0.98])
def test_correlated_noise(clean, subject, rho):
    with arms_known():
        result = covered(clean, subject, rho, REALISATIONS)
    assert result.robust == 1.0
    identified = [row for row in result.rows if row.is_identified]
    assert len(identified) >= 4
    for row in identified:
        assert row.default >= least(0.93), row
    # Equation (34) alone is far from its promise.
    assert np.mean([row.thesis for row in result.rows]) < 0.6


def test_a_few_realisations(clean, subject):
    result = covered(clean, subject, 0.9, 3)
    assert result.realisations == 3
    assert [row.name for row in result.rows] == list(subject.parameters)
    assert result.rows[0].bound == pytest.approx(0.0006, rel=0.5)
    assert len(BENCHMARK.markdown(result.rows).splitlines()) == 17
