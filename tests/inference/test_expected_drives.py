"""What is expected of a drive behind an envelope with known noise."""

from dataclasses import replace

import numpy as np
import pytest

from ankle_legs.movement import effort
from surae.inference.posterior import drive_chain
from surae.inference.posterior.expected_drives import expected_drives
from surae.signals import inputs_as_given

RATE, SECONDS = 64.0, 35.0


def expected(envelopes: np.ndarray, density: float) -> np.ndarray:
    """Four drives, shape (4, n)."""
    time = np.arange(envelopes.shape[1]) / RATE
    motion = np.sin(time), np.cos(time), -np.sin(time)
    inputs = inputs_as_given("given", RATE, time, motion, envelopes.T)
    return expected_drives(replace(inputs, rectified=(density,) * 4)).emg.T


def bursts(seed: int, density: float) -> tuple[np.ndarray, np.ndarray]:
    """Drives of another author, and envelopes of them, shape (4, n) each."""
    rng = np.random.default_rng(seed)
    drive = effort(rng, np.arange(round(SECONDS * RATE)) / RATE, "active") + 3e-3
    shape = 1.0 / (density * RATE)
    return drive, drive * rng.gamma(shape, 1.0 / shape, drive.shape)


@pytest.mark.parametrize("density", [0.6e-3, 3e-3])
def test_bursts_begin_and_end_when_they_do(density: float) -> None:
    """Two thirds of the noise go; edges are where they are, and rest is rest.

    The likeliest drive begins bursts 1 and 9 ms late at these densities, and ends them 2 early; a
    stationary filter (Wiener's) blurs them into what is rest.
    """
    found = []
    for seed in range(2):
        drive, noisy = bursts(seed, density)
        left = expected(noisy, density) - drive
        slope = np.gradient(drive, 1.0 / RATE, axis=1)
        late = [
            -np.sum(left[at] * slope[at]) / np.sum(slope[at] ** 2)
            for at in (slope > 0.5, slope < -0.5)
        ]
        found.append((np.std(left) / np.std(noisy - drive), *late, left[drive < 0.02].mean()))
    kept, rises, falls, at_rest = np.mean(found, axis=0)
    assert kept < 0.4
    assert max(abs(rises), abs(falls)) < 5e-3
    assert abs(at_rest) < 3e-4


def test_what_is_expected_pulls_no_gradient() -> None:
    density, slopes = 3e-3, []
    for seed in range(2):
        drive, noisy = bursts(seed, density)
        calm = expected(noisy, density)
        slopes.append([np.sum(drive * e) / np.sum(e * e) for e in (noisy, calm)])
    before, after = np.mean(slopes, axis=0)
    assert before < 0.88
    assert after == pytest.approx(1.0, abs=0.02)


def test_probabilities_are_those_of_whole_matrices() -> None:
    """Forward and backward against every path of a small chain, by its matrix."""
    slopes, turns, half, n, m = np.array([0, 1, -1]), 0.2, 0.1, 7, 6
    often = np.array([0.5, 0.25, 0.25])
    fits = np.random.default_rng(0).uniform(0.1, 1.0, (n, m))
    turn = (1.0 - turns) * np.eye(3) + turns * often
    climb = np.zeros((3, m, 3, m))
    for v, s in enumerate(slopes):
        for x in range(m):
            for d, part in ((-1, half), (0, 1.0 - 2.0 * half), (1, half)):
                if 0 <= x + s + d < m:
                    climb[v, x, v, x + s + d] += part
    step = (np.kron(turn, np.eye(m)) @ climb.reshape(3 * m, 3 * m)).T
    forward, backward = [np.repeat(often, m) * np.tile(fits[0], 3)], [np.ones(3 * m)]
    for row in fits[1:]:
        forward.append(step @ forward[-1] * np.tile(row, 3))
    for row in fits[:0:-1]:
        backward.append(step.T @ (backward[-1] * np.tile(row, 3)))
    both = (np.array(forward) * backward[::-1]).reshape(n, 3, m).sum(axis=1)
    told, own = np.empty((n, 3, m)), np.zeros((n, m))
    drive_chain.forward(fits, slopes, turns, half, told, own[:0])
    drive_chain.forward(fits[::-1].copy(), -slopes, turns, half, told, own)
    norm = [each / each.sum(axis=1, keepdims=True) for each in (own, both)]
    np.testing.assert_allclose(*norm, atol=1e-7)


def test_envelopes_of_unknown_making_and_silence_stay_as_they_are() -> None:
    _, noisy = bursts(0, 1e-3)
    time = np.arange(noisy.shape[1]) / RATE
    inputs = inputs_as_given("given", RATE, time, (np.sin(time), np.cos(time), time), noisy.T)
    assert expected_drives(inputs) is inputs
    noisy[3] = 0.0
    assert not expected(noisy, 1e-3)[3].any()
    noisy[0, 100], noisy[0, 200:220] = 50.0, 0.0  # a spike, and a cable that was off
    assert np.isfinite(expected(noisy, 1e-3)).all()
