"""Equations of the relaxed curve: each by an independent computation or a finite difference."""

import numpy as np
import pytest
from scipy.signal import lfilter

import surae
from relaxed_ankle import measured
from surae.inference.relaxed.basis import Basis
from surae.inference.relaxed.context import UNKNOWN as NOTHING
from surae.inference.relaxed.context import gaussians, hypotheses, plate_by_inertia
from surae.inference.relaxed.noise import variance, whitened
from surae.inference.relaxed.posterior import Whitened, jacobian, mode_of, residual
from surae.inference.relaxed.regressors import (
    TAUS,
    activated,
    blocks_of,
    columns_of,
    friction,
    lags,
)


@pytest.fixture(scope="module")
def columns():
    inputs = surae.prepare(measured())
    return columns_of(
        [blocks_of(inputs, np.ones(inputs.n, bool), np.zeros((inputs.n, 2)))], Basis(-40.0, 20.0)
    )


def prior_of(columns):
    curve = columns.basis.spread(1.5, 0.5)
    first = max(hypotheses(NOTHING, 1), key=lambda each: each.odds)
    return gaussians(curve, columns.names, first, float(columns.torque.mean()))


def test_slopes_of_the_features_are_their_derivatives() -> None:
    basis = Basis(-40.0, 20.0)
    at = np.linspace(-45.0, 25.0, 29)
    finite = (basis.features(at + 1e-4) - basis.features(at - 1e-4)) / 2e-4
    np.testing.assert_allclose(basis.slopes(at), finite, rtol=1e-6, atol=1e-8)
    assert basis.spread(1.5, 0.1).shape == (basis.size,) == basis.features(0.0)[0].shape


def test_a_step_relaxes_with_each_time() -> None:
    rate = 64.0
    step = np.ones((640, 1))
    step[0] = 0.0
    since = np.arange(639) / rate
    for tau, made in zip(TAUS, lags(step, rate), strict=True):
        np.testing.assert_allclose(
            made[1:, 0], np.exp(-1.0 / (rate * tau)) * np.exp(-since / tau), rtol=1e-9, atol=1e-14
        )


def test_a_muscle_takes_hold_as_two_filters_in_turn() -> None:
    rate = 2000.0
    step = np.ones((4000, 2))
    w = 2.0 * np.pi * 2.0 * (np.arange(4000) + 1.0) / rate
    expected = 1.0 - (1.0 + w) * np.exp(-w)
    np.testing.assert_allclose(activated(step, rate)[:, 1], expected, atol=3e-3)


def test_a_tissue_that_was_held_has_relaxed() -> None:
    held = np.full((100, 2), 3.0)
    assert all(not made.any() for made in lags(held, 64.0))


def test_friction_turns_within_its_degrees() -> None:
    there = np.linspace(0.0, 20.0, 400)
    z = friction(np.concatenate([there, there[::-1]]), 1.0)
    assert z[399] == pytest.approx(1.0, abs=1e-3)
    assert z[-1] == pytest.approx(-1.0, abs=1e-3)
    assert z[400 + 20] == pytest.approx(1.0 - 2.0 * (1.0 - np.exp(-1.0)), abs=0.08)


@pytest.mark.parametrize(("ar", "ma"), [(0.8, -0.5), (0.6, 0.0)])
def test_noise_becomes_white_and_has_its_variance(ar, ma) -> None:
    innovations = np.random.default_rng(1).standard_normal(40_000)
    noise = lfilter([1.0, ma], [1.0, -ar], innovations)
    assert np.var(noise) == pytest.approx(variance(ar, ma), rel=0.05)
    white = whitened(noise[200:, None], (0, 20_000, 39_800), ar, ma)[:, 0]
    assert np.var(white) == pytest.approx(1.0, rel=0.03)
    assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.02


def test_the_jacobian_is_that_of_the_residual(columns) -> None:
    data = Whitened(columns, 0.6, -0.3)
    random = np.random.default_rng(2)
    z = prior_of(columns).mean + 0.1 * random.standard_normal(len(prior_of(columns).mean))
    J = jacobian(data, z)
    for k in random.choice(len(z), 12, replace=False):
        step = np.zeros(len(z))
        step[k] = 1e-5
        finite = -(residual(data, z + step) - residual(data, z - step)) / 2e-5
        np.testing.assert_allclose(J[:, k], finite, rtol=1e-4, atol=1e-6)


def test_the_mode_is_where_the_posterior_has_no_slope(columns) -> None:
    data = Whitened(columns, 0.4, -0.2)
    prior = prior_of(columns)
    mode = mode_of(data, prior, prior.mean, 0.1, steps=30, noise=False)

    def cost(z):
        r = residual(data, z)
        away = z - prior.mean
        return r @ r / mode.sigma**2 + away @ prior.precision @ away

    best = cost(mode.z)
    sd = np.sqrt(np.diag(mode.covariance()))
    for k in range(0, len(sd), 3):
        step = np.zeros(len(sd))
        step[k] = 0.5 * sd[k]
        assert cost(mode.z + step) > best - 1e-2
        assert cost(mode.z - step) > best - 1e-2
    assert mode.misfit == pytest.approx(residual(data, mode.z) @ residual(data, mode.z) / 0.01)


def test_a_plate_is_told_by_what_no_foot_has() -> None:
    assert plate_by_inertia(0.09, 0.003**2) > 5.0
    assert plate_by_inertia(0.043, 0.003**2) < 0.0
    assert plate_by_inertia(0.02, 0.003**2) == 0.0  # a plate takes no inertia away
    assert plate_by_inertia(0.05, 0.0106**2) == 0.0  # the data say nothing
