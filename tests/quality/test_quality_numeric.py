"""The small tools of the checks against their definitions, sample by sample."""

import numpy as np
import pytest

from surae.quality.numeric import responded, shifted, smooth

LENGTHS = (1, 2, 5, 40, 101)


def values(n: int) -> np.ndarray:
    return np.random.default_rng(n).normal(size=n)


@pytest.mark.parametrize("n", LENGTHS)
def test_smooth_is_the_mean_of_the_samples_around(n: int) -> None:
    for width in (0, 1, 2, 3, 4, 9, 60, 250):
        x, half = values(n), width // 2
        means = [x[max(i - half, 0) : i + half + 1].mean() for i in range(n)]
        np.testing.assert_allclose(
            smooth(x, width), means, rtol=0.0, atol=1e-13, err_msg=f"{width}"
        )


@pytest.mark.parametrize("n", LENGTHS)
def test_shifted_repeats_the_end_values(n: int) -> None:
    x = values(n)
    for by in (-200, -3, -1, 0, 1, 2, 5, 300):
        np.testing.assert_array_equal(shifted(x, by), x[np.clip(np.arange(n) - by, 0, n - 1)])


@pytest.mark.parametrize("n", LENGTHS)
@pytest.mark.parametrize("taps", [1, 7, 64])
def test_responded_is_the_convolution_from_rest(n: int, taps: int) -> None:
    x, response = values(n), values(1000 + taps)[:taps]
    expected = np.convolve(x, response)[:n]
    np.testing.assert_allclose(responded(x, response), expected, rtol=0.0, atol=1e-12)
