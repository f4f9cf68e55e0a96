"""Elastic force (8) and relaxation (10), and the φ-functions beneath."""

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import StateSpace, lsim

from surae.model.passive import elastic_force, phi, relaxation_step

taus = st.floats(0.05, 50.0)
factors = st.floats(0.0, 5.0)
steps = st.sampled_from([1 / 1000, 1 / 256, 1 / 125, 1 / 50])


def relax(force: np.ndarray, tau: float, k: float, dt: float) -> np.ndarray:
    """Relaxed force, from the steady state of the first sample."""
    a, b0, b1 = relaxation_step(tau, k, dt)[:3]
    out = np.empty_like(force)
    z = k / (1 + k) * force[0]
    for i, now in enumerate(force):
        if i:
            z = a * z + b0 * force[i - 1] + b1 * now
        out[i] = now - z
    return out


def richardson(f, at: float, h: float) -> np.ndarray:
    """Derivative of f, fourth order."""
    near = (np.array(f(at + h)) - np.array(f(at - h))) / (2 * h)
    far = (np.array(f(at + 2 * h)) - np.array(f(at - 2 * h))) / (4 * h)
    return (4 * near - far) / 3


def test_elastic_force_is_one_newton_at_slack_length() -> None:
    assert elastic_force(0.0321, 187.0, 0.0321) == 1.0


def test_elastic_force_by_hand() -> None:
    assert elastic_force(0.0378, 200.0, 0.0178) == pytest.approx(math.exp(4), rel=1e-12)
    assert elastic_force(0.01, 100.0, 0.02) == pytest.approx(math.exp(-1), rel=1e-12)


def test_elastic_force_multiplies_by_e_each_stiffness_length() -> None:
    for x in (0.01, 0.03, 0.05):
        ratio = elastic_force(x + 1 / 150, 150.0, 0.02) / elastic_force(x, 150.0, 0.02)
        assert ratio == pytest.approx(math.e, rel=1e-12)


def phi_exact(z: float) -> list[float]:
    """φ1, φ2, φ1', φ2' from their closed forms, with 80 digits more than cancel."""
    if z == 0:
        return [1.0, 0.5, 0.5, 1 / 6]
    with localcontext() as context:
        context.prec = 80 + 3 * max(0, -math.floor(math.log10(abs(z))))
        x = Decimal(z)
        e = x.exp()
        phi1 = (e - 1) / x
        phi2 = (phi1 - 1) / x
        d_phi1 = (e - phi1) / x
        return [float(v) for v in (phi1, phi2, d_phi1, (d_phi1 - phi2) / x)]


NEAR_ONE = [s * math.nextafter(1.0, to) for s in (1.0, -1.0) for to in (0.0, 2.0)]
NEAR_ZERO = [0.0, 1e-300, -1e-16, 1e-8, -1e-8, 1e-5, -1e-3]


@pytest.mark.parametrize("z", [*NEAR_ONE, *NEAR_ZERO, 1.0, -1.0, 0.5, -0.5, -3.0, -30.0, 20.0])
def test_phi_against_many_digits(z) -> None:
    assert phi(z) == pytest.approx(phi_exact(z), rel=1e-14)


@given(z=st.floats(-40, 5))
def test_phi_everywhere(z) -> None:
    assert phi(z) == pytest.approx(phi_exact(z), rel=3e-14)


def test_relaxation_of_a_slow_force_is_the_dc_gain() -> None:
    k = 0.45
    held = relax(np.r_[0.0, np.ones(20000)], 0.5, k, 1 / 256)
    assert held[-1] == pytest.approx(1 / (1 + k), rel=1e-12)


def test_relaxation_of_a_sudden_force_is_the_hf_gain() -> None:
    dt = 1e-7
    sudden = relax(np.array([0.0, 1.0]), 2.0, 0.6, dt)
    assert sudden[1] == pytest.approx(1.0, abs=1e-6)


def test_relaxation_starts_in_the_steady_state_of_its_first_sample() -> None:
    held = relax(np.full(1000, 37.0), 3.0, 0.3, 1 / 256)
    assert held == pytest.approx(np.full(1000, 37.0 / 1.3), rel=1e-12)


@pytest.mark.parametrize("hz", [0.01, 0.1, 1.0, 10.0])
def test_relaxation_has_the_transfer_function_of_equation_10(hz) -> None:
    tau, k = 0.4, 0.7
    s = 2j * np.pi * hz
    dt = 1 / (400 * hz)
    n = math.ceil(40 * tau / dt)
    n -= n % 400  # whole periods
    time = np.arange(n + 401) * dt
    out = relax(np.sin(2 * np.pi * hz * time), tau, k, dt)
    # least squares on the last period, long after the transient
    waves = np.column_stack([np.sin(s.imag * time), np.cos(s.imag * time)])[-400:]
    (re, im), *_ = np.linalg.lstsq(waves, out[-400:], rcond=None)
    assert complex(re, im) == pytest.approx((tau * s + 1) / (tau * s + 1 + k), abs=1e-4)


@given(tau=taus, k=factors, dt=steps, seed=st.integers(0, 99))
@settings(max_examples=40)
def test_relaxation_is_exact_for_a_piecewise_linear_force(tau, k, dt, seed) -> None:
    force = np.random.default_rng(seed).uniform(0, 100, 60)
    system = StateSpace([[-(1 + k) / tau]], [[k / tau]], [[-1.0]], [[1.0]])
    start = k / (1 + k) * force[0]
    _, expected, _ = lsim(system, force, np.arange(60) * dt, X0=[start])
    assert relax(force, tau, k, dt) == pytest.approx(expected, rel=1e-11, abs=1e-11)


def test_relaxation_is_exact_where_the_step_is_much_longer_than_tau() -> None:
    # b0 + b1 carries the whole gain, a nothing
    a, b0, b1 = relaxation_step(1e-4, 0.5, 0.1)[:3]
    assert a == 0.0
    assert b0 + b1 == pytest.approx(1 / 3, rel=1e-12)


@given(tau=taus, k=factors, dt=steps)
def test_relaxation_coefficients_keep_the_dc_gain(tau, k, dt) -> None:
    step = relaxation_step(tau, k, dt)
    a, b0, b1 = step[:3]
    # z = gain·F0 is a fixed point of the recursion for all parameters, so its derivative is too
    gain = k / (1 + k)
    assert b0 + b1 == pytest.approx(gain * (1 - a), rel=1e-9, abs=1e-16)
    assert step[4] + step[5] == pytest.approx(-gain * step[3], rel=1e-9, abs=1e-16)
    assert step[7] + step[8] == pytest.approx(
        -gain * step[6] + (1 - a) / (1 + k) ** 2, rel=1e-9, abs=1e-16
    )


@given(tau=taus, k=st.floats(0.01, 5.0), dt=steps)
def test_relaxation_derivatives(tau, k, dt) -> None:
    step = relaxation_step(tau, k, dt)
    by_tau = richardson(lambda t: relaxation_step(t, k, dt)[:3], tau, 1e-3 * tau)
    by_k = richardson(lambda q: relaxation_step(tau, q, dt)[:3], k, 1e-3 * k)
    # rounding of the difference: the coefficients themselves are of order 1
    assert step[3:6] == pytest.approx(by_tau, rel=1e-7, abs=1e-12 / tau)
    assert step[6:9] == pytest.approx(by_k, rel=1e-7, abs=1e-12 / k)


def test_no_relaxation_without_factor() -> None:
    force = np.random.default_rng(1).uniform(0, 9, 50)
    assert np.array_equal(relax(force, 2.0, 0.0, 1 / 256), force)
