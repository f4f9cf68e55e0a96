"""What was stated against what the data say: found where it is wrong, not where it is right."""

from dataclasses import replace

import numpy as np
import pytest

from surae.inference.evidence import LaplaceApproximation
from surae.inference.posterior.conflict import Conflict, conflicts
from surae.model.source import Gaussian
from surae.model.statements import RARE

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
        assert conflicts(laplace, NAMES, STATED, WIDE, {"axis"})["axis"].probability < RARE


def test_one_right_statement_in_a_hundred_is_doubted_and_none_is_taken_for_wrong() -> None:
    rng, seen = np.random.default_rng(1), []
    for seed in range(400):
        laplace = told(tuple(0.003 * rng.standard_normal(2)), 0.002, seed)
        seen.append(conflicts(laplace, NAMES, STATED, WIDE, {"axis"})["axis"])
    assert (
        sum(c.probability < RARE for c in seen) <= 10
    )  # 1 %, and three standard deviations of the count
    assert all(c.probability > 1e-4 for c in seen)  # of adequacy: nothing is claimed


def test_arms_and_lengths_are_of_one_statement_and_shapes_of_none() -> None:
    """A path 3 and a length 2.5 of their sd off: each alone might be, both together hardly."""
    names = ("path_scale_tri", "length_zero_tri", "arm_bend_tri")
    stated = {n: Gaussian(0.0, sd) for n, sd in zip(names, (0.03, 0.0025, 0.05), strict=True)}
    wide = {n: Gaussian(0.0, sd) for n, sd in zip(names, (0.3, 0.005, 0.15), strict=True)}
    told = np.array([0.012, 0.0008, 0.01])
    seen = np.array([3.0, 2.5, 9.0]) * np.hypot([0.03, 0.0025, 0.05], told)
    weight = np.array([1.0 / stated[n].sd for n in names])
    laplace = LaplaceApproximation(
        np.diag(told**-2.0), -(told**-2.0) * seen, 0.0, np.zeros(3), np.zeros(3), weight
    )
    (found,) = conflicts(laplace, names, stated, wide, {"arm", "length"}).values()
    assert found.at == (0, 1)
    assert found.ratio == pytest.approx(np.sqrt((3.0**2 + 2.5**2) / 2.0), rel=0.01)
    assert found.probability < RARE


def test_what_disagrees_is_wider_by_birges_ratio_with_all_that_hangs_on_it() -> None:
    """Two measurements of one number, and another that is three times the first."""
    V = np.array([[4.0, 12.0, 0.0], [12.0, 40.0, 1.0], [0.0, 1.0, 9.0]])
    rows = Conflict((0,), 0.02, 2.5).widened(V)
    wider = V + rows.T @ rows
    assert wider[0, 0] == pytest.approx(2.5**2 * 4.0)
    assert wider[0, 1] == pytest.approx(2.5**2 * 12.0)
    assert wider[1, 1] - V[1, 1] == pytest.approx((2.5**2 - 1.0) * 12.0**2 / 4.0)
    assert wider[2, 2] == pytest.approx(9.0)
    assert len(Conflict((0,), 0.6, 0.8).widened(V)) == 0


def test_data_that_cannot_tell_say_nothing() -> None:
    laplace = told((0.0, 0.02), 0.05, 1)
    assert not conflicts(laplace, NAMES, STATED, WIDE, {"axis"})
    assert not conflicts(replace(laplace), NAMES, STATED, WIDE, {"plate"})
