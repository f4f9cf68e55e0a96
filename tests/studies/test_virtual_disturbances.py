"""Random disturbances: spectrum, correlation, size and mixing are those that are stated."""

import math

import numpy as np
import pytest

from surae.recording import Recording
from surae.signals import Preparation, prepare
from surae.studies.imperfections import (
    coloured_noise,
    mixed_envelopes,
    mixing,
    passed,
    raw_emg,
    wandering,
)

RATE = 2048.0


def rng(seed: int = 1) -> np.random.Generator:
    return np.random.default_rng(seed)


def correlation(signal: np.ndarray, lag: int) -> float:
    return float(np.corrcoef(signal[lag:], signal[:-lag])[0, 1])


@pytest.mark.parametrize("rate_hz", [64.0, 256.0])
def test_coloured_noise_has_its_size_and_correlation(rate_hz):
    noise = coloured_noise(400_000, rate_hz, 2.5, 0.1, rng())
    assert noise.std() == pytest.approx(2.5, rel=0.03)
    assert abs(noise.mean()) < 0.1
    for lag_s in (1 / rate_hz, 0.125, 0.25):
        expected = math.exp(-lag_s / 0.1)
        assert correlation(noise, round(lag_s * rate_hz)) == pytest.approx(expected, abs=0.02)


def test_coloured_noise_is_stationary_from_its_start():
    starts = np.array([coloured_noise(3, 256.0, 1.0, 0.1, rng(seed)) for seed in range(4000)])
    assert starts.std(axis=0) == pytest.approx([1.0, 1.0, 1.0], rel=0.05)


def test_coloured_noise_without_correlation_is_white():
    noise = coloured_noise(100_000, 256.0, 1.0, 0.0, rng())
    np.testing.assert_array_equal(noise, rng().standard_normal(100_000))


def test_wandering_has_variance_one_everywhere_and_its_correlation():
    t = np.arange(0.0, 4.0, 0.125)
    drawn = np.hstack([wandering(t, 2.0, 40, rng(seed)) for seed in range(200)])
    assert drawn.shape == (32, 8000)
    assert drawn.var(axis=1) == pytest.approx(np.ones(32), abs=0.07)
    assert np.abs(drawn.mean(axis=1)).max() < 0.05
    assert np.corrcoef(drawn[0], drawn[1])[0, 1] > 0.99
    assert abs(np.corrcoef(drawn[3], drawn[31])[0, 1]) < 0.05
    assert abs(np.corrcoef(drawn[5, ::2], drawn[5, 1::2])[0, 1]) < 0.05


def test_wandering_does_not_depend_on_rate_or_duration():
    slow, fast = np.arange(0, 10, 1 / 64), np.arange(0, 30, 1 / 256)
    few, many = wandering(slow, 1.0, 4, rng()), wandering(fast, 1.0, 4, rng())
    np.testing.assert_allclose(few, many[::4][: len(few)], rtol=0, atol=1e-12)
    assert np.abs(np.diff(many, axis=0)).max() < 0.06  # smooth


def test_raw_emg_keeps_to_its_band():
    emg = raw_emg(np.ones((65536, 2)), RATE, rng())
    power = np.abs(np.fft.rfft(emg, axis=0)) ** 2
    frequency = np.fft.rfftfreq(65536, 1 / RATE)
    inside = (frequency >= 20.0) & (frequency <= 450.0)
    assert power[inside].sum() / power.sum() > 1 - 1e-12
    thirds = [power[(frequency > a) & (frequency < a + 100)].mean() for a in (30, 180, 330)]
    assert thirds == pytest.approx([np.mean(thirds)] * 3, rel=0.05)  # flat
    assert abs(np.corrcoef(emg.T)[0, 1]) < 0.03


def test_rectified_raw_emg_has_the_mean_that_theory_says():
    emg = raw_emg(np.full((400_000, 1), 3e-4), RATE, rng())[:, 0]
    # E|x| = √(2/π)·σ for Gaussian noise; the high-pass, not yet applied, takes the rest away.
    assert np.abs(emg).mean() / emg.std() == pytest.approx(math.sqrt(2 / math.pi), rel=0.005)
    assert passed(RATE) * np.abs(emg).mean() == pytest.approx(3e-4, rel=0.005)
    assert math.sqrt(math.pi / 2) / passed(RATE) == pytest.approx(1.289, abs=5e-4)


@pytest.mark.parametrize("rate_hz", [1000.0, 2048.0])
@pytest.mark.parametrize(
    "settings",
    [Preparation(), Preparation(emg_highpass_hz=None), Preparation(emg_highpass_hz=80.0)],
)
def test_the_preparation_gives_the_envelope_back_on_average(rate_hz, settings):
    t = np.arange(int(60 * rate_hz)) / rate_hz
    wanted = 2e-4 * (1.2 + np.sin(2 * np.pi * 0.3 * t))[:, None] * np.array([1.0, 0.5, 2.0, 0.1])
    raw = raw_emg(wanted, rate_hz, rng())
    recording = Recording.from_arrays(t, 0.1 * np.sin(t), None, raw)
    prepared = prepare(recording, settings)
    envelopes = np.column_stack([np.interp(prepared.time, t, channel) for channel in wanted.T])
    factor = passed(rate_hz, settings) / passed(rate_hz)
    slope = (prepared.emg * envelopes).sum(axis=0) / (envelopes**2).sum(axis=0)
    assert slope == pytest.approx([factor] * 4, rel=0.03)
    # Proportional: as much too small where it is small as where it is large.
    low = envelopes[:, 0] < 2e-4
    for part in (low, ~low):
        ratio = prepared.emg[part].mean(axis=0) / envelopes[part].mean(axis=0)
        assert ratio == pytest.approx([factor] * 4, rel=0.03)


def test_mixing():
    np.testing.assert_array_equal(mixing(0.0), np.eye(4))
    matrix = mixing(0.1)
    assert (np.diag(matrix) == 1.0).all()
    assert matrix[~np.eye(4, dtype=bool)] == pytest.approx(np.full(12, 0.1))


def test_mixed_envelopes_are_those_of_mixed_raw_emg():
    envelopes = np.tile([3e-4, 1e-5, 1e-4, 5e-5], (400_000, 1))
    mixed = mixed_envelopes(envelopes, 0.15)
    raw = raw_emg(envelopes, RATE, rng()) @ mixing(0.15).T
    assert passed(RATE) * np.abs(raw).mean(axis=0) == pytest.approx(mixed[0], rel=0.01)
    assert mixed_envelopes(envelopes, 0.0) is envelopes
