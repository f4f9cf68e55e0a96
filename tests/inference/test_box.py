"""The small quadratic problem within bounds, against scipy and its optimality conditions."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from surae.inference.least_squares.minimise import box_quadratic


def problem(rng, p, *, condition=1e2):
    """J and residual of a random least-squares problem, with H = JᵀJ of unit diagonal."""
    J = rng.standard_normal((3 * p, p)) * np.geomspace(1, 1 / np.sqrt(condition), 3 * p)[:, None]
    J /= np.linalg.norm(J, axis=0)
    return J, rng.standard_normal(3 * p)


def box(rng, p, share=0.7):
    """Bounds around 0 or to one side of it; some infinite."""
    lower, upper = np.sort(rng.standard_normal((2, p)), axis=0)
    lower[rng.random(p) > share] = -np.inf
    upper[rng.random(p) > share] = np.inf
    return lower, upper


def assert_optimal(H, g, lower, upper, d, tolerance=1e-9):
    """Karush–Kuhn–Tucker: feasible, and no gradient except against a bound that is met exactly."""
    assert np.all((d >= lower) & (d <= upper))
    gradient = g + H @ d
    limit = tolerance * (np.abs(g).max() + 1e-300)
    inside = (d > lower) & (d < upper)
    assert np.all(np.abs(gradient[inside]) <= limit)
    assert np.all(gradient[(d == lower) & (d < upper)] >= -limit)
    assert np.all(gradient[(d == upper) & (d > lower)] <= limit)


@pytest.mark.parametrize("p", [1, 3, 8, 17])
def test_equals_scipy(p):
    rng = np.random.default_rng(p)
    for _ in range(40):
        J, e = problem(rng, p)
        lower, upper = box(rng, p)
        d = box_quadratic(J.T @ J, J.T @ e, lower, upper)
        assert_optimal(J.T @ J, J.T @ e, lower, upper, d)
        theirs = lsq_linear(J, -e, (lower, upper), method="bvls", tol=1e-14).x
        np.testing.assert_allclose(d, theirs, rtol=0, atol=1e-9 * (1 + np.abs(theirs).max()))


def test_without_bounds_is_the_solution_of_the_linear_system():
    rng = np.random.default_rng(0)
    J, e = problem(rng, 6)
    infinite = np.full(6, np.inf)
    d = box_quadratic(J.T @ J, J.T @ e, -infinite, infinite)
    np.testing.assert_allclose(d, np.linalg.lstsq(J, -e, rcond=None)[0], rtol=1e-10)


def test_equal_bounds_hold_the_variable_at_them():
    rng = np.random.default_rng(1)
    J, e = problem(rng, 5)
    lower, upper = np.full(5, -np.inf), np.full(5, np.inf)
    lower[[0, 3]] = upper[[0, 3]] = [0.25, -2.0]
    d = box_quadratic(J.T @ J, J.T @ e, lower, upper)
    assert d[0] == 0.25
    assert d[3] == -2.0
    free = [1, 2, 4]
    expected = np.linalg.lstsq(J[:, free], -(e + J[:, [0, 3]] @ [0.25, -2.0]), rcond=None)[0]
    np.testing.assert_allclose(d[free], expected, rtol=1e-10)


def test_zero_outside_the_box():
    # d = 0 is not allowed: every variable starts at a bound, and must leave it where that pays.
    rng = np.random.default_rng(2)
    for _ in range(50):
        J, e = problem(rng, 4)
        lower = rng.uniform(0.1, 1.0, 4)
        upper = lower + rng.uniform(0.1, 5.0, 4)
        d = box_quadratic(J.T @ J, J.T @ e, lower, upper)
        assert_optimal(J.T @ J, J.T @ e, lower, upper, d)


def test_a_held_variable_is_let_go_again():
    # Unconstrained minimum (−1, 1.8): the first step meets d0 = 0 and holds it at once.
    H = np.array([[1.0, 0.9], [0.9, 1.0]])
    g = np.array([-0.62, -0.9])
    d = box_quadratic(H, g, np.array([0.0, -np.inf]), np.array([np.inf, 0.5]))
    assert_optimal(H, g, np.array([0.0, -np.inf]), np.array([np.inf, 0.5]), d)
    assert d[1] == 0.5
    assert d[0] == pytest.approx(0.62 - 0.45)


def test_degenerate_bound_with_zero_multiplier():
    # The minimum lies exactly on the bound: held or free, the answer is the same.
    d = box_quadratic(np.eye(2), np.array([-1.0, -1.0]), np.zeros(2), np.array([1.0, 5.0]))
    np.testing.assert_allclose(d, [1.0, 1.0], rtol=1e-15)


def test_semidefinite_with_a_ridge():
    rng = np.random.default_rng(3)
    for _ in range(50):
        J, e = problem(rng, 6)
        J[:, 4] = J[:, 1]  # two columns alike
        J[:, 5] = 0.0  # one silent
        lower, upper = box(rng, 6, share=1.0)
        H = J.T @ J + 1e-10 * np.eye(6)
        d = box_quadratic(H, J.T @ e, lower, upper)
        # The cost, not the point, is what a flat direction leaves determined.
        theirs = lsq_linear(J, -e, (lower, upper), method="bvls", tol=1e-14)
        assert 0.5 * np.sum((J @ d + e) ** 2) <= theirs.cost * (1 + 1e-8) + 1e-12
        assert np.all((d >= lower) & (d <= upper))


@pytest.mark.parametrize("scale", [1e-200, 1e-20, 1.0, 1e20])
def test_any_size_of_gradient(scale):
    rng = np.random.default_rng(4)
    J, e = problem(rng, 5)
    lower, upper = box(rng, 5)
    d = box_quadratic(J.T @ J, J.T @ e * scale, lower * scale, upper * scale)
    expected = box_quadratic(J.T @ J, J.T @ e, lower, upper)
    np.testing.assert_allclose(d / scale, expected, rtol=1e-10)


def test_ill_conditioned_within_bounds():
    rng = np.random.default_rng(5)
    for _ in range(50):
        J, e = problem(rng, 10, condition=1e12)
        lower, upper = box(rng, 10, share=1.0)
        d = box_quadratic(J.T @ J, J.T @ e, lower, upper)
        assert_optimal(J.T @ J, J.T @ e, lower, upper, d, tolerance=1e-7)


def test_inputs_are_not_changed():
    H, g = np.eye(2), np.array([3.0, -3.0])
    lower, upper = -np.ones(2), np.ones(2)
    box_quadratic(H, g, lower, upper)
    np.testing.assert_array_equal(H, np.eye(2))
    np.testing.assert_array_equal(g, [3.0, -3.0])
    np.testing.assert_array_equal(lower, -np.ones(2))
    np.testing.assert_array_equal(upper, np.ones(2))
