"""The activation filter (14): exactness, responses, derivatives of its coefficients."""

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.linalg import expm, expm_frechet

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


def impulse_response(time: np.ndarray, f0: float, beta: float) -> np.ndarray:
    """Textbook answer to a unit impulse."""
    w = 2 * math.pi * f0
    if beta == 1:
        return w**2 * time * np.exp(-w * time)
    if beta < 1:
        r = math.sqrt(1 - beta**2)
        return w / r * np.exp(-beta * w * time) * np.sin(r * w * time)
    r = math.sqrt(beta**2 - 1)
    slow, fast = w * (beta - r), w * (beta + r)
    return w / (2 * r) * (np.exp(-slow * time) - np.exp(-fast * time))


@pytest.mark.parametrize("beta", DAMPINGS)
@pytest.mark.parametrize(("f0", "rate"), [(2.0, 256.0), (10.0, 125.0), (15.0, 50.0), (0.3, 1000.0)])
def test_step_response(f0, rate, beta) -> None:
    time = np.arange(400) / rate
    out = run(np.ones(400), f0, beta, 1 / rate)
    assert out == pytest.approx(step_response(time, f0, beta), abs=1e-12)


@pytest.mark.parametrize("beta", DAMPINGS)
@pytest.mark.parametrize(("f0", "rate"), [(2.0, 256.0), (15.0, 50.0)])
def test_impulse_response(f0, rate, beta) -> None:
    # an impulse leaves α = 0, α'/ω0 = ω0; from there the filter is free
    w = 2 * math.pi * f0
    free = filter_step(f0, beta, 1 / rate)[0][:, :2]
    v = np.array([0.0, w])
    out = []
    for _ in range(200):
        out.append(v[0])
        v = free @ v
    exact = impulse_response(np.arange(200) / rate, f0, beta)
    assert out == pytest.approx(exact, abs=1e-12 * w)


@pytest.mark.parametrize("beta", DAMPINGS)
def test_ramp_response(beta) -> None:
    # the integral of the step response: t − 2β/ω·(step response) − (its derivative)/ω²
    f0, rate = 10.0, 125.0
    w = 2 * math.pi * f0
    time = np.arange(300) / rate
    exact = (
        time
        - 2 * beta / w * step_response(time, f0, beta)
        - impulse_response(time, f0, beta) / w**2
    )
    assert run(time, f0, beta, 1 / rate) == pytest.approx(exact, abs=1e-12)


@given(f0=st.floats(0.05, 60), beta=st.floats(0.05, 5), dt=st.floats(1e-4, 0.02))
def test_dc_gain_is_one(f0, beta, dt) -> None:
    step, step_f0, step_beta = filter_step(f0, beta, dt)
    steady = np.array([1.0, 0.0, 1.0, 1.0])  # α = E, α' = 0
    assert step @ steady == pytest.approx([1.0, 0.0], abs=1e-12)
    # for all parameters, so the derivatives vanish on it
    assert step_f0 @ steady == pytest.approx([0.0, 0.0], abs=1e-12 / f0)
    assert step_beta @ steady == pytest.approx([0.0, 0.0], abs=1e-12)


def smooth_emg(time: np.ndarray, f0: float, beta: float) -> tuple[np.ndarray, np.ndarray]:
    """A constant and two sines, and the filter's exact answer to them from rest."""
    w = 2 * math.pi * f0
    emg = np.zeros(len(time))
    forced = np.zeros((2, len(time)))
    for size, hz, phase in ((1.0, 0.0, math.pi / 2), (0.6, 0.7, 0.4), (0.4, 2.0, -1.1)):
        s = 2j * math.pi * hz
        wave = size * np.exp(1j * (s.imag * time + phase))
        emg += wave.imag
        answer = wave * w**2 / (s**2 + 2 * beta * w * s + w**2)
        forced += np.stack([answer.imag, (answer * s / w).imag])
    # what starts at rest is the forced answer less the free one of its first state
    step = expm(np.array([[0.0, w], [-w, -2 * beta * w]]) * (time[1] - time[0]))
    free = np.empty_like(forced)
    state = forced[:, 0]
    for i in range(len(time)):
        free[:, i] = state
        state = step @ state
    return emg, forced[0] - free[0]


@pytest.mark.parametrize("beta", DAMPINGS)
def test_ten_hertz_at_125_hertz_on_a_smooth_emg(beta) -> None:
    def error(rate: float) -> tuple[float, float]:
        time = np.arange(round(8 * rate)) / rate
        emg, exact = smooth_emg(time, 10.0, beta)
        off = run(emg, 10.0, beta, 1 / rate) - exact
        return np.abs(off).max(), math.sqrt(np.mean(off**2) / np.mean(exact**2))

    greatest, relative = error(125.0)
    # straight lines between samples miss (ω·dt)²/12 = 0.084 % of the 2 Hz wave of size 0.4
    assert greatest < 4.5e-4
    assert relative < 2.5e-4
    assert error(250.0)[1] == pytest.approx(relative / 4, rel=0.02)


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


@pytest.mark.parametrize(
    ("f0", "beta", "dt"),
    [
        (2.0, 1.0, 1 / 256),  # critical damping exactly
        (15.0, 1.0, 0.02),  # one step turns by 1.9 rad
        (15.0, 4.0, 0.02),
        (10.0, 0.3, 1 / 125),
        (1e-3, 1.0, 1e-4),  # a step of 6e-7 rad
    ],
)
def test_derivatives_against_richardson(f0, beta, dt) -> None:
    _, step_f0, step_beta = filter_step(f0, beta, dt)

    def difference(at, h: float) -> np.ndarray:
        near = (at(h) - at(-h)) / (2 * h)
        far = (at(2 * h) - at(-2 * h)) / (4 * h)
        return (4 * near - far) / 3

    by_f0 = difference(lambda h: filter_step(f0 + h, beta, dt)[0], 1e-3 * f0)
    by_beta = difference(lambda h: filter_step(f0, beta + h, dt)[0], 1e-3 * beta)
    # each column on its own scale, less the rounding of the difference
    for exact, numeric, rounding in ((step_f0, by_f0, 1e-12 / f0), (step_beta, by_beta, 1e-12)):
        scale = np.abs(numeric).max(axis=0)
        assert np.all(np.abs(exact - numeric) <= 1e-7 * scale + rounding)


def test_a_tiny_step_is_euler() -> None:
    dt = 1e-9
    w = 2 * math.pi * 2.0
    step = filter_step(2.0, 0.7, dt)[0]
    assert step[:, :2] == pytest.approx(np.array([[1, w * dt], [-w * dt, 1 - 1.4 * w * dt]]))
    assert step[1, 2:] == pytest.approx([w * dt / 2] * 2, rel=1e-6)
    assert step[0, 2:] == pytest.approx([(w * dt) ** 2 / 3, (w * dt) ** 2 / 6], rel=1e-6)


@given(beta=st.floats(0.05, 5), f0=st.floats(0.3, 15))
@settings(max_examples=50)
def test_two_half_steps_are_one(beta, f0) -> None:
    half = filter_step(f0, beta, 1 / 256)[0]
    whole = filter_step(f0, beta, 1 / 128)[0]
    assert half[:, :2] @ half[:, :2] == pytest.approx(whole[:, :2], abs=1e-13)
    # a ramp through the middle: E = 0, ½, 1
    through = half[:, :2] @ (0.5 * half[:, 3]) + 0.5 * half[:, 2] + half[:, 3]
    assert through == pytest.approx(whole[:, 3], abs=1e-13)


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
