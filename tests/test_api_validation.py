"""Losses, weights and validation through the public API, on measured gait."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.frozen import read_only


@pytest.fixture(scope="module")
def walk(shared):
    return surae.prepare(surae.read(shared / "gait" / "walk36.toml"))


@pytest.fixture(scope="module")
def run(shared):
    return surae.prepare(surae.read(shared / "gait" / "run81.toml"))


@pytest.fixture(scope="module")
def struck(walk):
    """Walking with bursts of −431 Nm in 2 % of the samples, and where they are."""
    hit = np.zeros(walk.n, dtype=bool)
    for first in np.random.default_rng(1).choice(walk.n - 5, 25, replace=False):
        hit[first : first + 5] = True
    return replace(walk, torque=read_only(walk.torque - 431.0 * hit)), hit


def followed(fit, inputs, hit):
    """VAF of the torque without bursts, where there were none."""
    modelled = fit.result.problem.inputs[0].torque - fit.result.residuals[0]
    torque = inputs.torque[~hit]
    return 100 * (1 - np.sum((torque - modelled[~hit]) ** 2) / np.sum(torque**2))


@pytest.mark.slow
def test_bursts_in_measured_walking_spoil_squares_but_not_huber(walk, struck) -> None:
    bad, hit = struck
    squares = surae.fit(bad, "muscle", starts=2)
    assert followed(squares, walk, hit) < 93
    before, after = (surae.fit(trial, "muscle", starts=2, loss="huber") for trial in (walk, bad))
    assert followed(after, walk, hit) == pytest.approx(followed(before, walk, hit), abs=0.1)
    for name in ("k_tri", "g2", "l0_tri", "l0_tib", "f0", "beta"):
        assert after.values[name] == pytest.approx(before.values[name], rel=0.1), name


def test_excluding_the_bursts_does_as_well(walk, struck) -> None:
    bad, hit = struck
    edges = np.flatnonzero(np.diff(np.concatenate([[0], hit.astype(int), [0]])))
    windows = tuple(
        (float(walk.time[a]), float(walk.time[b - 1]), 0.0)
        for a, b in zip(edges[::2], edges[1::2], strict=True)
    )
    fitted = surae.fit(bad, "muscle", starts=2, weights=surae.Weighting(windows))
    assert fitted.vaf == pytest.approx(97.2, abs=0.2)  # nor do its first 0.7 s count
    assert fitted.vaf_weighted is None
    first = walk.time <= walk.time[0] + 0.7
    assert fitted.result.problem.n == walk.n - (hit | first).sum()


@pytest.mark.slow
def test_walking_does_not_predict_running(walk, run) -> None:
    assert surae.fit(run, "muscle", starts=1).predict(walk).vaf < 90
    assert surae.fit(walk, "muscle", starts=1).predict(run).vaf < 60


@pytest.mark.slow
def test_peaks_are_followed_more_closely_when_they_count_more(walk) -> None:
    plain = surae.fit(walk, "muscle", starts=2)
    peaks = surae.fit(walk, "muscle", starts=2, weights=surae.Weighting(peaks=9.0))
    high = np.abs(walk.torque) > np.percentile(np.abs(walk.torque), 90)
    missed = [np.sqrt(np.mean(fitted.result.residuals[0][high] ** 2)) for fitted in (plain, peaks)]
    assert missed[1] < missed[0]
    assert peaks.vaf <= plain.vaf + 1e-6
    assert peaks.vaf_weighted > peaks.vaf
