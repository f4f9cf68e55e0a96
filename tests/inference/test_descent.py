"""What a descent learns of its surface, and how far it goes along a step."""

import numpy as np
import pytest

from surae.inference.posterior.descent import Secant, shorter


def _matrix(seed: int) -> np.ndarray:
    half = np.random.default_rng(seed).standard_normal((4, 4))
    return half @ half.T + np.eye(4)


def test_the_last_step_is_explained() -> None:
    H, step = _matrix(0), np.array([1.0, -2.0, 0.5, 0.3])
    secant = Secant(4)
    for seed in (1, 2):
        turned = _matrix(seed) @ step
        secant.learn(step, turned, H)
        np.testing.assert_allclose((H + secant.S) @ step, turned, rtol=1e-12)
        np.testing.assert_allclose(secant.S, secant.S.T, atol=1e-12)


def test_a_quadratic_is_learnt_from_steps_along_its_axes() -> None:
    H, S = np.diag([4.0, 3.0, 2.0, 1.0]), np.diag([1.0, -0.4, 0.3, 2.0])
    secant = Secant(4)
    for step in np.eye(4):
        secant.S, kept = np.zeros((4, 4)), secant.S
        secant.learn(step, (H + S) @ step, H)
        secant.S += kept
    np.testing.assert_allclose(secant.added(H, np.ones(4)), H + S, atol=1e-12)


def test_no_direction_is_less_than_half_as_bent() -> None:
    A = _matrix(3)
    scale = np.sqrt(np.diag(A))
    A = A / np.outer(scale, scale)
    secant = Secant(4)
    assert secant.added(A, scale) is A
    secant.S = -_matrix(4) * np.outer(scale, scale)
    least = np.linalg.eigvals(np.linalg.solve(A, secant.added(A, scale))).real.min()
    assert least == pytest.approx(0.5)


def test_what_is_not_finite_teaches_nothing() -> None:
    secant = Secant(2)
    secant.learn(np.ones(2), np.array([np.inf, 1.0]), np.eye(2))
    secant.learn(np.zeros(2), np.zeros(2), np.eye(2))
    assert not secant.S.any()


@pytest.mark.parametrize(("slope", "bent"), [(1.0, 2.0), (3.0, 10.0)])
def test_a_step_ends_where_its_parabola_is_least(slope: float, bent: float) -> None:
    part = 1.0
    rise = -slope * part + bent * part**2
    assert shorter(part, slope, rise) == pytest.approx(slope / (2.0 * bent))


def test_a_step_is_never_shortened_by_more_than_ten() -> None:
    assert shorter(0.5, 1.0, np.inf) == shorter(0.5, 1.0, 1e9) == 0.05
