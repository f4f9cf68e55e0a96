import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from surae.assessment.comparison.compare import aicc, effective_samples


def ar1(n: int, rho: float, seed: int) -> np.ndarray:
    """Stationary first-order autoregression of unit variance."""
    white = np.random.default_rng(seed).standard_normal(n)
    series = np.empty(n)
    series[0] = white[0]
    for i in range(1, n):
        series[i] = rho * series[i - 1] + math.sqrt(1 - rho**2) * white[i]
    return series


def test_aicc_by_hand() -> None:
    # K = 3 with the variance: 10·ln e + 2·3 + 2·3·4/(10 − 3 − 1)
    assert aicc(math.e, 10, 2) == pytest.approx(10 + 6 + 4)


def test_aicc_does_not_depend_on_the_unit_of_the_residual() -> None:
    def difference(unit: float) -> float:
        return aicc(2.0 * unit**2, 50.5, 3) - aicc(1.5 * unit**2, 50.5, 5)

    assert difference(1.0) == pytest.approx(difference(1e3))


def test_a_parameter_that_explains_nothing_costs_two() -> None:
    assert aicc(1.0, 1e7, 16) - aicc(1.0, 1e7, 15) == pytest.approx(2.0, abs=1e-4)


@pytest.mark.parametrize("samples", [16.0, 17.0, 3.5])
def test_no_aicc_with_as_many_parameters_as_samples(samples) -> None:
    assert aicc(1.0, samples, 15) is None
    assert aicc(1.0, 17.5, 15) is not None


@pytest.mark.parametrize("mean_square", [0.0, math.inf, math.nan])
def test_no_aicc_without_a_variance(mean_square) -> None:
    assert aicc(mean_square, 100, 5) is None


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("rho", [0.3, 0.7, 0.95])
def test_effective_samples_of_an_autoregression(rho, seed) -> None:
    n = 40_000
    expected = n * (1 - rho) / (1 + rho)
    assert_allclose(effective_samples([ar1(n, rho, seed)]), expected, rtol=0.2)


@pytest.mark.parametrize("seed", range(3))
def test_white_residuals_count_in_full(seed) -> None:
    n = 40_000
    assert 0.95 * n < effective_samples([ar1(n, 0.0, seed)]) <= n


def test_anticorrelated_residuals_count_no_more_than_they_are() -> None:
    assert effective_samples([ar1(1000, -0.9, 0)]) == 1000
    assert effective_samples([np.resize([1.0, -1.0], 1000)]) == 1000


def test_recordings_add_up() -> None:
    one, other = ar1(5000, 0.8, 1), 30 * ar1(3000, 0.1, 2)
    together = effective_samples([one, other])
    assert together == pytest.approx(effective_samples([one]) + effective_samples([other]))


def test_a_residual_that_never_changes_has_no_correlation_to_count() -> None:
    assert effective_samples([np.full(100, 2.0)]) == 100
