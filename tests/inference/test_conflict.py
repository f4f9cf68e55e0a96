"""What was stated against what the data say: found where it is wrong, not where it is right."""

from dataclasses import replace

import numpy as np
import pytest

from surae.inference.conflict import contradicted
from surae.inference.evidence import LaplaceApproximation
from surae.model.sources import Gaussian

NAMES = ("m", "axis_forward", "axis_up")
WIDE = {"axis_forward": Gaussian(0.0, 0.01), "axis_up": Gaussian(0.0, 0.01)}
STATED = {name: Gaussian(0.0, 0.003) for name in WIDE}


def told(true: tuple[float, float], sd: float, seed: int) -> LaplaceApproximation:
    """Data that know the axis within `sd`, around the mode that the statement leaves."""
    seen = np.array([2.0, *(true + sd * np.random.default_rng(seed).standard_normal(2))])
    information = np.diag([1e2, sd**-2, sd**-2])
    mean = np.array([2.0, *(STATED[n].mean for n in NAMES[1:])])
    weight = np.array([1.0, *(1.0 / STATED[n].sd for n in NAMES[1:])])
    H = information + np.diag(weight**2)
    mode = np.linalg.solve(H, information @ seen + weight**2 * mean)
    cost = float((mode - seen) @ information @ (mode - seen))
    return LaplaceApproximation(information, information @ (mode - seen), cost, mode, mean, weight)


@pytest.mark.parametrize("sd", [0.0005, 0.0015])
def test_an_axis_15_mm_off_is_found(sd) -> None:
    for seed in range(20):
        laplace = told((0.0, 0.02), sd, seed)
        assert contradicted(laplace, NAMES, STATED, WIDE, {"axis"}).keys() == {"axis"}


def test_one_right_statement_in_twenty_is_doubted_and_none_is_taken_for_wrong() -> None:
    rng, doubted = np.random.default_rng(1), []
    for seed in range(200):
        laplace = told(tuple(0.003 * rng.standard_normal(2)), 0.002, seed)
        doubted += contradicted(laplace, NAMES, STATED, WIDE, {"axis"}).values()
    assert len(doubted) <= 0.08 * 200  # 5 %, and two standard deviations of a count of 200
    assert all(probability > 1e-4 for probability in doubted)  # of adequacy: nothing is claimed


def test_data_that_cannot_tell_say_nothing() -> None:
    laplace = told((0.0, 0.02), 0.05, 1)
    assert not contradicted(laplace, NAMES, STATED, WIDE, {"axis"})
    assert not contradicted(replace(laplace), NAMES, STATED, WIDE, {"plate"})
