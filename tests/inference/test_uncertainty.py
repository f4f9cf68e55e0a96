"""Covariance against its definition, the dependency estimator by hand, singular directions."""

import numpy as np
import pytest
from scipy import stats

from surae.inference import ipde
from surae.inference.uncertainty.covariance import covariance, half_width

NAMES = tuple("abcdef")


def regression(p=5, n=60, seed=0):
    """Jacobian with columns of very different size, and its triangular factor."""
    rng = np.random.default_rng(seed)
    J = rng.standard_normal((n, p)) * np.geomspace(1e-6, 1e6, p)
    return J, np.linalg.qr(J, mode="r")


def test_covariance_is_sigma2_times_the_inverse_information():
    J, R = regression()
    found = covariance(R, NAMES[:5], sse=11.0, n=60)
    scale = np.linalg.norm(J, axis=0)
    expected = 11.0 / 55 * np.linalg.inv((J / scale).T @ (J / scale)) / np.outer(scale, scale)
    assert found.names == NAMES[:5]
    assert found.dof == 55
    assert found.sigma2 == pytest.approx(0.2, rel=1e-15)
    assert found.directions == ()
    np.testing.assert_allclose(found.matrix, expected, rtol=1e-9)
    np.testing.assert_array_equal(found.matrix, found.matrix.T)


def test_standard_errors_are_honest():
    # Over many noisy data sets the spread of a linear fit is what the covariance says.
    rng = np.random.default_rng(5)
    t = np.linspace(0, 1, 50)
    J = np.stack([np.ones_like(t), t, t**2], axis=1)
    R = np.linalg.qr(J, mode="r")
    solutions = np.array(
        [np.linalg.lstsq(J, rng.standard_normal(50), rcond=None)[0] for _ in range(2000)]
    )
    expected = covariance(R, ("a", "b", "c"), sse=47.0, n=50)  # σ² = 1
    np.testing.assert_allclose(np.cov(solutions.T), expected.matrix, rtol=0.1)


def test_correlation():
    J, R = regression()
    r = covariance(R, NAMES[:5], 1.0, 60).correlation
    np.testing.assert_allclose(np.diag(r), 1.0, rtol=1e-14)
    assert np.all(np.abs(r) <= 1 + 1e-14)
    # Independent of the units of the parameters.
    scaled = np.linalg.qr(J * [1.0, 1e3, 1e-3, 7.0, 1.0], mode="r")
    np.testing.assert_allclose(covariance(scaled, NAMES[:5], 1.0, 60).correlation, r, atol=1e-9)


def test_correlation_where_no_residual_is_left():
    _, R = regression()
    exact = covariance(R, NAMES[:5], 0.0, 60)
    assert not exact.matrix.any()
    np.testing.assert_array_equal(exact.correlation, covariance(R, NAMES[:5], 1.0, 60).correlation)


def test_what_lies_at_a_bound_is_known_as_well_as_its_bounds_are_apart():
    J, R = regression()
    narrow = covariance(R, NAMES[:5], 3.0, 60, {"b": 1e-9, "e": 1e-9})
    alone = covariance(np.linalg.qr(J[:, [0, 2, 3]], mode="r"), ("a", "c", "d"), 3.0, 60)
    assert narrow.names == ("a", "c", "d")
    assert narrow.dof == alone.dof == 57
    np.testing.assert_allclose(narrow.matrix, alone.matrix, rtol=1e-3)
    wide = covariance(R, NAMES[:5], 3.0, 60, {"b": 1e9, "e": 1e9})
    free = covariance(R, NAMES[:5], 3.0 * 55 / 57, 60)
    kept = np.ix_([0, 2, 3], [0, 2, 3])
    np.testing.assert_allclose(wide.matrix, free.matrix[kept], rtol=1e-3)


def test_everything_at_a_bound():
    found = covariance(regression()[1], NAMES[:5], 3.0, 60, dict.fromkeys(NAMES[:5], 1.0))
    assert found.names == ()
    assert found.matrix.shape == (0, 0)
    assert found.correlation.shape == (0, 0)
    assert found.sigma2 == pytest.approx(3.0 / 60)


def test_a_silent_column_is_named_and_the_others_keep_their_variance():
    J, _ = regression()
    J[:, 2] = 0.0
    found = covariance(np.linalg.qr(J, mode="r"), NAMES[:5], 3.0, 60)
    kept = [0, 1, 3, 4]
    alone = covariance(np.linalg.qr(J[:, kept], mode="r"), tuple("abde"), 3.0, 60)
    assert found.names == tuple("abde")
    assert found.directions == (("c",),)
    np.testing.assert_allclose(found.matrix * found.dof, alone.matrix * alone.dof, rtol=1e-9)


def test_a_silent_column_and_two_alike():
    J, _ = regression(p=6)
    J[:, 5] = 0.0
    J[:, 3] = J[:, 1]
    found = covariance(np.linalg.qr(J, mode="r"), NAMES, 3.0, 60)
    assert found.names == ("a", "c", "e")
    assert {frozenset(d) for d in found.directions} == {frozenset("bd"), frozenset("f")}


def test_weak_is_not_singular():
    # Correlation 1 − 5e−9 is weak, but told apart: it keeps its (large) variance.
    rng = np.random.default_rng(9)
    u, v = np.linalg.qr(rng.standard_normal((60, 2)))[0].T
    J = np.stack([u, u + 1e-4 * v], axis=1)
    found = covariance(np.linalg.qr(J, mode="r"), ("a", "b"), 58.0, 60)
    assert found.names == ("a", "b")
    assert found.correlation[0, 1] == pytest.approx(-1.0, abs=1e-6)
    np.testing.assert_allclose(np.sqrt(np.diag(found.matrix)), 1e4, rtol=1e-3)


def test_ipde_by_hand():
    r = np.array([[1.0, 0.3, -0.4], [0.3, 1.0, 0.0], [-0.4, 0.0, 1.0]])
    assert ipde(r) == pytest.approx(0.5, rel=1e-15)


@pytest.mark.parametrize("dof", [1, 3, 30, 8000])
def test_half_width_is_students(dof):
    assert half_width(2.0, dof) == pytest.approx(2.0 * stats.t.ppf(0.975, dof), rel=1e-9)
