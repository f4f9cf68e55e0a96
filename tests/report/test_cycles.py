"""Cycles are shown where a movement repeats itself, and nowhere else."""

import numpy as np
import pytest

import surae
from surae.protocol import PROFILES, Protocol, generate
from surae.signals.cycles import find_cycles

RATE = 100.0
TIME = np.arange(6000) / RATE


def strides(unevenness: float, seed: int = 1) -> np.ndarray:
    """Sixty seconds of a two-humped angle whose cycles of about 1.2 s differ in duration."""
    pieces = []
    random = np.random.default_rng(seed)
    while sum(map(len, pieces)) < len(TIME):
        n = round(120 * (1 + unevenness * random.standard_normal()))
        phase = 2 * np.pi * np.arange(n) / n
        size = 1 + 0.1 * random.standard_normal()
        pieces.append(size * (0.15 * np.sin(phase) + 0.12 * np.sin(2 * phase + 0.4)))
    return np.concatenate(pieces)[: len(TIME)]


@pytest.mark.parametrize("unevenness", [0.0, 0.03])
def test_strides_are_counted_and_timed(unevenness):
    cycles = find_cycles(strides(unevenness), RATE)
    assert cycles is not None
    assert cycles.seconds == pytest.approx(1.2, rel=0.02)
    assert 45 <= len(cycles.spans) <= 50
    assert all(1.0 < (past - first) / RATE < 1.45 for first, past in cycles.spans)


def test_mean_and_band_are_those_of_the_cycles():
    cycles = find_cycles(strides(0.0), RATE)
    share, mean, spread = cycles.over(np.arange(len(TIME), dtype=float) % 120)
    assert (share[0], share[-1]) == (0.0, 100.0)
    assert np.nanmax(spread[5:20]) < 1.0  # the same ramp in every cycle
    assert mean.shape == spread.shape == (101,)


def test_cycles_with_samples_left_out_are_left_out():
    angle = strides(0.0)
    counted = np.ones(len(angle), dtype=bool)
    counted[1000:1600] = False
    fewer, every = find_cycles(angle, RATE, counted), find_cycles(angle, RATE)
    assert 5 <= len(every.spans) - len(fewer.spans) <= 7
    assert all(counted[first:past].all() for first, past in fewer.spans)


@pytest.mark.parametrize("profile", sorted(set(PROFILES) - {"sine"}))
def test_a_movement_that_does_not_repeat_itself_has_none(profile):
    motion = generate(Protocol(profile=profile))
    assert find_cycles(motion.angle, Protocol(profile=profile).rate_hz) is None


@pytest.mark.parametrize("seed", range(5))
def test_noise_rest_and_wandering_have_none(seed):
    random = np.random.default_rng(seed)
    white = random.standard_normal(len(TIME))
    assert find_cycles(0.2 * white, RATE) is None
    assert find_cycles(0.01 * np.sin(2 * np.pi * TIME), RATE) is None
    assert find_cycles(0.01 * np.cumsum(white), RATE) is None
    assert find_cycles(np.zeros(len(TIME)), RATE) is None
    assert find_cycles(0.3 * np.sin(2 * np.pi * (0.3 * TIME + 0.02 * TIME**2)), RATE) is None


def test_of_measured_trials_walking_has_cycles_and_a_ramp_has_none(shared):
    walk = surae.prepare(surae.read(shared / "gait" / "walk36.toml"))
    cycles = find_cycles(walk.angle, walk.rate_hz)
    assert (len(cycles.spans), cycles.seconds) == (52, pytest.approx(1.145))
    ramp = surae.prepare(surae.read(shared / "dynamometer" / "PL_50_01.toml"))
    assert find_cycles(ramp.angle, ramp.rate_hz) is None
