"""Appendix A: estimates against their truth, correlations against closed forms."""

import numpy as np
import pytest

from surae_thesis.appendix import (
    TRUTH,
    fit_spring,
    fitted,
    linear_force,
    offset_force,
    protocol_motion,
)


@pytest.mark.parametrize("force", [linear_force, offset_force])
def test_derivatives_against_differences(force) -> None:  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(1)
    motion = rng.standard_normal((3, 20))
    p = np.array([3.0, 2.0, 0.5, 0.7])[: 3 if force is linear_force else 4]
    _, rows = force(motion, p)
    for j in range(len(p)):
        step = np.zeros(len(p))
        step[j] = 1e-6
        difference = (force(motion, p + step)[0] - force(motion, p - step)[0]) / 2e-6
        assert rows[j] == pytest.approx(difference, abs=1e-8)


@pytest.mark.parametrize("force", [linear_force, offset_force])
def test_truth_lies_within_its_errors(force) -> None:  # type: ignore[no-untyped-def]
    motion = protocol_motion()
    off = np.array(
        [
            [(fit.values[name] - TRUTH[name]) / fit.sem(name) for name in fit.values]
            for fit in (fit_spring(force, motion, seed) for seed in range(30))
        ]
    )
    assert np.abs(off.mean(axis=0)).max() < 0.7
    assert 0.7 < off.std() < 1.3


def test_damping_and_offset_depend_on_each_other_as_the_closed_form_says() -> None:
    motion = protocol_motion()
    v, pair = motion[1], fit_spring(offset_force, motion, 0).pairs()["b", "u"]
    u = TRUTH["u"]
    assert -pair == pytest.approx(u / np.sqrt(u**2 + np.mean(v**2)), abs=0.05)


def test_a_motion_equal_to_its_derivatives_separates_nothing() -> None:
    assert fitted(1).alike.known.directions == (("k", "b", "m"),)
    assert fitted(1).alike.known.names == ()
