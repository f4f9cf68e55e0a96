"""Importance sampling of densities that are known otherwise, and where it must refuse."""

import numpy as np
import pytest
from scipy.stats import norm

from surae.sampling.importance import ENOUGH, weighted_draws

MEAN = np.array([1.0, -0.5, 0.0])
COVARIANCE = np.array([[1.0, 0.6, 0.0], [0.6, 2.0, -0.3], [0.0, -0.3, 0.5]])


def gaussian(u):
    away = np.linalg.solve(COVARIANCE, u - MEAN)
    return float(-0.5 * (u - MEAN) @ away), -away


def banana(u):
    """Three valleys, each much more bent than a Gaussian's."""
    a, b = u[::2], u[1::2]
    off = 3.0 * (b - a**2)
    slope = np.ravel([6.0 * a * off - a, -3.0 * off], order="F")
    return float(-0.5 * off @ off - 0.5 * a @ a), slope


def draw(density=gaussian, q=3, threads=1, **settings):
    default = {"rounds": 4, "size": 1000, "seed": 1}
    return weighted_draws([density] * threads, q, **(default | settings))


def test_a_gaussian_that_lies_elsewhere_has_its_moments():
    found = draw()
    assert found.whole
    assert found.k_hat <= found.limit
    assert found.effective > 400
    assert found.weights.sum() == pytest.approx(1.0)
    points = found.resampled(4000, np.random.default_rng(2))
    error = 4.0 * np.sqrt(np.diag(COVARIANCE) / found.effective)
    assert (np.abs(points.mean(axis=0) - MEAN) < error).all()
    assert np.cov(points, rowvar=False) == pytest.approx(COVARIANCE, abs=0.2)
    inside = np.abs(points[:, 1] + 0.5) < norm.ppf(0.975) * 2.0**0.5
    assert inside.mean() == pytest.approx(0.95, abs=0.02)


def test_the_same_seed_gives_the_same_draws_in_any_number_of_threads():
    one, two, other = draw(size=203), draw(size=203, threads=2), draw(size=203, seed=2)
    assert np.array_equal(one.points, two.points)
    assert np.array_equal(one.weights, two.weights)
    assert not np.array_equal(one.points[:10], other.points[:10])


def test_gradients_narrow_the_proposals_of_many_dimensions():
    """Half as wide as was taken along five of thirty coordinates: few draws of the first count."""
    precision = np.ones(30)
    precision[:5] = 9.0

    def narrow(u):
        return float(-0.5 * precision @ u**2), -precision * u

    first = draw(narrow, 30, rounds=1)
    later = draw(narrow, 30, rounds=3)
    assert first.effective < 60
    assert later.effective > 400
    assert later.k_hat < 0.5
    sd = np.sqrt(later.weights @ later.points**2)
    assert sd * precision**0.5 == pytest.approx(1.0, abs=0.2)


def test_a_banana_is_refused():
    for seed in range(3):
        found = draw(banana, 6, rounds=6, size=600, seed=seed)
        assert found.k_hat > found.limit or found.effective < ENOUGH


def funnel(u):
    """Neal's (2003, Annals of Statistics 31:705), of ten coordinates: its width is one of them."""
    v, x = 3.0 * u[0], u[1:]
    squares = float(np.exp(-v) * x @ x)
    by_v = -v / 9.0 + 0.5 * squares - 0.5 * len(x)
    slope = np.concatenate([[3.0 * by_v], -np.exp(-v) * x])
    return -(v**2) / 18.0 - 0.5 * squares - 0.5 * len(x) * v, slope


def test_a_published_density_that_no_gaussian_is_like_is_refused():
    for seed in range(3):
        found = draw(funnel, 10, rounds=6, size=600, seed=seed)
        assert found.k_hat > found.limit or found.effective < ENOUGH


def test_without_a_density_anywhere_nothing_is_believed():
    found = draw(lambda u: (-np.inf, 0.0 * u))
    assert found.k_hat == np.inf
    assert found.effective == 0.0


def test_ctrl_c_keeps_what_is_drawn_and_progress_counts():
    counted = []

    def stop(done, total):
        counted.append((done, total))
        if done > 300:
            raise KeyboardInterrupt

    found = draw(progress=stop)
    assert not found.whole
    assert 300 < len(found.points) < 1000
    assert {total for _, total in counted} == {4000}
    assert [done for done, _ in counted] == sorted(done for done, _ in counted)


def test_ctrl_c_before_there_is_anything_to_keep():
    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        draw(progress=stop)
