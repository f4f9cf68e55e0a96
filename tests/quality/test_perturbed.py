"""A perturbed recording is known, and its command named."""

import numpy as np
import pytest

import surae
from perturbed_ankle import Ankle
from surae.quality.position import perturbing


def test_a_perturbed_recording_names_the_command() -> None:
    found = {f.code: f for f in surae.check(Ankle().recording()).findings}
    assert "surae impedance" in found["rom-not-covered"].message


@pytest.mark.parametrize("hz", [0.3, 2.0])
def test_a_slow_movement_a_still_foot_and_noise_are_none(hz) -> None:
    t = np.arange(0.0, 40.0, 0.01)
    assert not perturbing(0.05 * np.sin(2.0 * np.pi * hz * t), 100.0)
    assert not perturbing(1e-4 * np.sin(2.0 * np.pi * 8.0 * t), 100.0)
    assert not perturbing(0.02 * np.random.default_rng(1).standard_normal(len(t)), 100.0)
