"""What one statement is worth, what two are, and that two that disagree are not believed."""

import math

import numpy as np
import pytest

from surae.model.statements import RARE, Pooled, StatedAxis, StatedZero


def one(value: float, sd: float) -> dict[str, tuple[float, float]]:
    return {"": (value, sd)}


def test_one_statement_is_as_unsure_as_laboratories_differ() -> None:
    pooled = Pooled.of("angle_zero", one(1.0, 1.0))
    assert pooled.numbers[""] == (1.0, pytest.approx(math.hypot(1.0, 2.3)))  # s² + b², ISO 5725
    assert pooled.probability is None
    assert pooled.agrees is None
    assert not Pooled.of("angle_zero", {}).numbers


def test_two_that_agree_earn_the_spread_of_their_mean() -> None:
    pooled = Pooled.of("angle_zero", one(0.0, 1.0), one(1.0, 1.0))
    mean, sd = pooled.numbers[""]
    assert (mean, pooled.agrees) == (0.5, True)
    assert sd == pytest.approx(2.306 / 1.96 / math.sqrt(2.0), rel=1e-3)  # χ² is below 1
    # the surer one counts for more
    pooled = Pooled.of("angle_zero", one(0.0, 1.0), one(1.0, 0.5))
    assert pooled.numbers[""][0] == pytest.approx(0.8)


def test_two_that_disagree_are_as_far_off_as_they_are_apart() -> None:
    pooled = Pooled.of("angle_zero", one(0.0, 1.0), one(6.0, 1.0))
    mean, sd = pooled.numbers[""]
    assert pooled.agrees is False
    assert pooled.probability == pytest.approx(math.erfc(3.0))  # χ² = 18 of one degree of freedom
    assert mean - sd < 0.0
    assert mean + sd > 6.0


def test_right_statements_contradict_each_other_as_rarely_as_is_said_and_intervals_hold() -> None:
    rng, far, held = np.random.default_rng(8), 0, 0
    for _ in range(4000):
        first, second = (
            {g: (x, 3.0) for g, x in zip("ab", rng.normal(0.0, 3.0, 2), strict=True)}
            for _ in range(2)
        )
        pooled = Pooled.of("axis", first, second)
        far += pooled.agrees is False
        held += abs(pooled.numbers["a"][0]) < 1.96 * pooled.numbers["a"][1]
    assert far / 4000 == pytest.approx(RARE, abs=0.005)
    assert held / 4000 > 0.95


def test_what_one_of_two_tells_is_told_once() -> None:
    pooled = Pooled.of("arms", {"tri": (48.0, 1.5), "tib": (40.0, 1.2)}, {"tri": (49.0, 1.5)})
    assert pooled.numbers["tri"][1] < 1.5
    assert pooled.numbers["tib"] == pytest.approx((40.0, math.hypot(1.2, 4.0)))


def test_again_has_the_deviation_of_the_first() -> None:
    assert StatedZero(1.0, 0.5, 2.0).statements == [{"": (1.0, 0.5)}, {"": (2.0, 0.5)}]
    assert len(StatedZero(1.0, 0.5).statements) == 1
    first, second = StatedAxis((4.0, -2.0), 3.0, 5.0).statements
    assert first == {"forward": (4.0, 3.0), "up": (-2.0, 3.0)}
    assert second == {"forward": (5.0, 3.0), "up": (0.0, 3.0)}
