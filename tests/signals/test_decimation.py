"""One way to a lower rate, for all signals, whichever door they came in by."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.frozen import read_only
from surae.recording import Channel, Recording
from surae.signals import ModelInputs, inputs_as_given, thinned

RATE = 512.0


def inputs(torque: np.ndarray, emg: np.ndarray | None = None, rate_hz: float = RATE) -> ModelInputs:
    n = len(torque)
    time = np.arange(n) / rate_hz
    still = np.zeros(n)
    emg = np.ones((n, 4)) if emg is None else emg
    return inputs_as_given("trial", rate_hz, time, (0.1 * time, still, still), emg, torque=torque)


def tone(hz: float, n: int = 8192, rate_hz: float = RATE) -> np.ndarray:
    return np.cos(2 * np.pi * hz * np.arange(n) / rate_hz)


def inner(values: np.ndarray) -> np.ndarray:
    return values[32:-32]


@pytest.mark.parametrize("factor", [2, 3, 5, 8])
def test_what_the_new_rate_carries_stays_and_what_would_fold_back_goes(factor: int) -> None:
    target = RATE / factor
    slow = thinned(inputs(tone(0.15 * target)), factor)
    assert slow.rate_hz == target
    np.testing.assert_allclose(
        inner(slow.torque), inner(np.cos(2 * np.pi * 0.15 * target * slow.time)), atol=1e-5
    )
    np.testing.assert_allclose(slow.angle, 0.1 * slow.time, atol=1e-6)  # a slope to its very ends
    fast = thinned(inputs(tone(0.9 * target)), factor)  # would be a tone at a tenth
    assert np.abs(inner(fast.torque)).max() < 1e-3


@pytest.mark.parametrize("factor", [2, 4, 8, 32])
def test_every_sample_counts(factor: int) -> None:
    """Noise of the mean of a lowered signal is that of all its samples, not of one in so many."""
    rng = np.random.default_rng(factor)
    noise = rng.standard_normal(2048 * factor)
    lowered = thinned(inputs(noise, rate_hz=64.0 * factor), factor).torque
    assert np.var(lowered) == pytest.approx(0.8 / factor, rel=0.1)


def test_torque_and_emg_stay_together() -> None:
    """No signal comes earlier or later than another."""
    burst = np.exp(-0.5 * ((np.arange(8192) / RATE - 8.0) / 0.05) ** 2)
    low = thinned(inputs(burst, np.repeat(burst[:, None], 4, axis=1)), 8)
    np.testing.assert_allclose(low.torque, low.emg[:, 0], atol=1e-6)
    assert low.torque @ low.time / low.torque.sum() == pytest.approx(8.0, abs=1e-4)


def test_an_envelope_does_not_become_negative() -> None:
    emg = np.zeros((8192, 4))
    emg[4000:5000] = 1.0
    assert thinned(inputs(tone(1.0), emg), 8).emg.min() == 0.0


def test_what_is_left_out_does_not_spread() -> None:
    clean = inputs(tone(2.0))
    weight = np.ones(clean.n)
    weight[3000:3100] = 0.0
    spoilt = np.where(weight == 0.0, 1e4, clean.torque)
    low = thinned(replace(clean, torque=read_only(spoilt), weight=read_only(weight)), 8)
    plain = thinned(clean, 8)
    counted = low.weight > 0.0
    assert 100 / 8 <= np.count_nonzero(~counted) <= 100 / 8 + 2
    # only what lies beside the gap knows that it was bridged
    assert np.abs(low.torque - plain.torque)[counted].max() < 0.05
    assert np.all(np.abs(low.torque[~counted]) < 2.0)


def test_factor_one_changes_nothing() -> None:
    given = inputs(tone(3.0))
    assert thinned(given, 1) is given


def with_envelope(rate_hz: float, other_hz: float) -> Recording:
    def channel(role: str, hz: float, unit: str) -> Channel:
        time = np.arange(int(10 * hz)) / hz
        return Channel(role, time, np.abs(np.sin(time)), unit, "test")

    channels = [channel("angle", other_hz, "rad"), channel("torque", other_hz, "Nm")]
    channels += [channel("emg_ta", rate_hz, "V")]
    return Recording("trial", {c.role: c for c in channels}, emg="envelope")


@pytest.mark.parametrize("prepared", [True, False])
@pytest.mark.parametrize(("rate_hz", "said"), [(20.0, True), (64.0, False), (128.0, False)])
def test_what_a_slow_envelope_cannot_say_is_said(prepared, rate_hz, said) -> None:
    given = with_envelope(rate_hz, rate_hz if prepared else 128.0)
    steps = surae.prepare(given, prepared=prepared).steps
    assert any("faster than 10 Hz" in str(step) for step in steps) is said
