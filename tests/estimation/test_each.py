"""What recordings of a joint fit say by themselves: a spread that is there, and one that is not."""

import numpy as np
import pytest

from surae.estimation.each import _effective, _weighed, trial_spread
from surae.estimation.result import OfRecording


def recordings(parts, sem):
    """Recordings that find a stiffness at these parts of 200, and a mass that is the same."""
    return [
        OfRecording({"k_tri": 200.0 * (1.0 + part), "m": 2.0}, {"k_tri": 200.0 * sem, "m": 0.01})
        for part in parts
    ]


def test_trials_that_differ_are_told_by_how_much():
    likely, most = trial_spread(recordings((-0.06, 0.0, 0.06), 0.005))["k_tri"]
    assert 0.04 * 200.0 < likely < 0.1 * 200.0
    assert most > 2.0 * likely  # three recordings tell it badly


def test_trials_that_agree_are_not_called_different():
    likely, most = trial_spread(recordings((-0.005, 0.0, 0.005), 0.005))["k_tri"]
    assert likely < 0.005 * 200.0 < most < 0.03 * 200.0
    assert trial_spread(recordings((-0.06, 0.0, 0.06), 0.005))["m"][0] < 0.01


def test_two_recordings_leave_more_open_than_six():
    two, six = (trial_spread(recordings((-0.02, 0.02) * n, 0.005))["k_tri"] for n in (1, 3))
    assert two[1] > 2.0 * six[1]


@pytest.mark.parametrize(("spread", "least"), [(0.0, 0.95), (0.02, 0.94), (0.08, 0.92)])
def test_intervals_hold_the_mean_of_legs_that_differ_from_trial_to_trial(spread, least):
    """A third of 18 parameters differs; three recordings; errors of 0.5 to 3 %."""
    rng, held, wide = np.random.default_rng(5), [], []
    errors = np.tile(np.geomspace(0.005, 0.03, 18), (3, 1))
    sizes = spread * (np.arange(18) % 3 == 0)
    for _ in range(150):
        found = errors * rng.standard_normal((3, 18)) + sizes * rng.standard_normal((3, 18))
        known, own = errors[0] ** 2 / 3.0, np.full(18, 1.0 / 3.0)
        more = _effective(known, own, _weighed(found, errors, np.ones(18, bool)))
        half = 1.96 * np.sqrt(known + own * more)
        held.append(np.abs(found.mean(axis=0)) < half)
        wide.append(half / (1.96 * np.sqrt(known)))
    held, differs = np.array(held), np.arange(18) % 3 == 0
    assert held[:, differs].mean() > least
    assert held.mean() > least
    if spread == 0.0:
        assert np.median(wide) < 1.7
