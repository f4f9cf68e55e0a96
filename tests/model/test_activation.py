"""The activation filter (14): exactness, responses, derivatives of its coefficients."""

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.linalg import expm_frechet

from surae.model.activation import filter_step, shaped

DAMPINGS = [0.2, 0.6, 1.0, 1.8, 4.0]


def run(emg: np.ndarray, f0: float, beta: float, dt: float) -> np.ndarray:
    """Active state from rest."""
    step = filter_step(f0, beta, dt)[0]
    out = np.zeros(len(emg))
    v = np.zeros(2)
    for i in range(1, len(emg)):
        v = step[:, :2] @ v + step[:, 2] * emg[i - 1] + step[:, 3] * emg[i]
        out[i] = v[0]
    return out


def step_response(time: np.ndarray, f0: float, beta: float) -> np.ndarray:
    """Textbook answer of ω²/(s² + 2βωs + ω²) to a unit step."""
    w = 2 * math.pi * f0
    if beta == 1:
        return 1 - (1 + w * time) * np.exp(-w * time)
    if beta < 1:
        r = math.sqrt(1 - beta**2)
        wave = np.cos(r * w * time) + beta / r * np.sin(r * w * time)
        return 1 - np.exp(-beta * w * time) * wave
    r = math.sqrt(beta**2 - 1)
    slow, fast = w * (beta - r), w * (beta + r)
    return 1 - (fast * np.exp(-slow * time) - slow * np.exp(-fast * time)) / (fast - slow)


@pytest.mark.parametrize("beta", DAMPINGS)
@pytest.mark.parametrize(("f0", "rate"), [(2.0, 256.0), (15.0, 50.0)])
def test_step_response(f0, rate, beta) -> None:
    time = np.arange(400) / rate
    out = run(np.ones(400), f0, beta, 1 / rate)
    assert out == pytest.approx(step_response(time, f0, beta), abs=1e-12)


def exact_step(f0: float, beta: float, dt: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The step and its derivatives from Van Loan's block exponential and its Fréchet derivative."""
    h = 2 * math.pi * f0 * dt
    block = np.zeros((4, 4))
    block[:2, :2] = [[0, h], [-h, -2 * beta * h]]
    block[1, 2], block[2, 3] = h, 1.0
    by_h = np.zeros((4, 4))
    by_h[:2, :3] = block[:2, :3] / h
    by_beta = np.zeros((4, 4))
    by_beta[1, 1] = -2 * h

    def columns(e: np.ndarray) -> np.ndarray:
        return np.column_stack([e[:2, :2], e[:2, 2] - e[:2, 3], e[:2, 3]])

    exact, slope_h = expm_frechet(block, by_h)
    slope_beta = expm_frechet(block, by_beta, compute_expm=False)
    return columns(exact), columns(slope_h) * 2 * math.pi * dt, columns(slope_beta)


@given(f0=st.floats(0.05, 60), beta=st.floats(0.05, 8), dt=st.floats(1e-4, 0.02))
@example(f0=2.0, beta=1.0, dt=1 / 256)
@example(f0=15.0, beta=1.0, dt=0.02)
@example(f0=15.0, beta=4.0, dt=0.02)
@example(f0=0.01, beta=1.0, dt=1e-5)
@example(f0=25.0, beta=0.2, dt=0.02)
@example(f0=57.75, beta=6.71875, dt=0.012693791315972572)  # Φ[1, 1] is a small difference
@settings(max_examples=150)
def test_step_and_its_derivatives_against_the_matrix_exponential(f0, beta, dt) -> None:
    step, step_f0, step_beta = filter_step(f0, beta, dt)
    exact, exact_f0, exact_beta = exact_step(f0, beta, dt)
    assert step == pytest.approx(exact, rel=1e-10, abs=1e-13)
    scale_f0, scale_beta = np.abs(exact_f0).max(), np.abs(exact_beta).max()
    assert step_f0 == pytest.approx(exact_f0, rel=1e-9, abs=1e-12 * scale_f0)
    assert step_beta == pytest.approx(exact_beta, rel=1e-9, abs=1e-12 * scale_beta)


@pytest.mark.parametrize("shape", [-5.0, -1.2, -0.25, -1e-3, -1e-12, 0.0, 1e-6, 0.25, 1.0])
def test_shape_and_its_derivatives_at_many_digits(shape) -> None:
    level = 4e-4
    u = np.concatenate([np.linspace(-0.2, 1.6, 400), [0.0, 1e-12, -1e-6]])
    with localcontext() as context:
        context.prec = 70
        h = Decimal("1e-20")

        def exact(u: Decimal, a: Decimal) -> Decimal:
            return ((a * u).exp() - 1) / (a.exp() - 1) if a else u

        rows = [
            (
                exact(x, A),
                (exact(x + h, A) - exact(x - h, A)) / (2 * h),
                (exact(x, A + h) - exact(x, A - h)) / (2 * h),
            )
            for x, A in ((Decimal(float(x)), Decimal(shape)) for x in u)
        ]
    expected = np.array(rows, dtype=float).T
    e = (level * u)[None]
    curved, by_own, by_smooth, by_shape, _ = shaped(e, e, np.array([level]), shape, 0.0)[:, 0]
    out = np.array([curved / level, by_own + by_smooth, by_shape / level])
    np.testing.assert_allclose(out, expected, rtol=1e-13, atol=2e-15)
