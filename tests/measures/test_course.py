"""A leg over several visits: the line through them, and what is said of it."""

import math

import numpy as np
import pytest

import surae
from relaxed_ankle import Ankle, measured
from surae.base.errors import InputError
from surae.measures.course import Series, trend_of

BEFORE = Ankle(zero=4.0)


def series(values: list[float | None], sem: float = 1.0) -> Series:
    sems = tuple(None if value is None else sem for value in values)
    return Series("torque_rise", "Nm", "", "rest", tuple(values), sems)


def test_the_line_is_that_of_least_squares_and_its_error_that_of_the_visits() -> None:
    told = trend_of([0.0, 1.0, 2.0], series([1.0, 2.0, 3.0]))
    assert told is not None
    assert told.difference == pytest.approx(2.0)
    assert told.sd == pytest.approx(2.0 / math.sqrt(2.0))
    assert told.ratio == 1.0
    missing = trend_of([0.0, 1.0, 2.0, 4.0], series([1.0, None, 3.0, 5.0]))
    assert missing is not None
    assert missing.difference == pytest.approx(4.0)
    assert trend_of([0.0, 1.0, 2.0], series([1.0, None, 3.0])) is None


def test_visits_that_scatter_more_than_they_should_tell_less() -> None:
    smooth = trend_of([0.0, 1.0, 2.0, 3.0], series([0.0, 1.0, 2.0, 3.0], 0.1))
    rough = trend_of([0.0, 1.0, 2.0, 3.0], series([0.0, 3.0, 0.0, 3.0], 0.1))
    assert smooth is not None
    assert rough is not None
    assert rough.sd > 5.0 * smooth.sd


def test_lines_through_visits_of_an_unchanged_leg_hold_nothing() -> None:
    rng = np.random.default_rng(5)
    held = 0
    for _ in range(400):
        told = trend_of([0.0, 1.0, 2.0, 3.0], series(list(rng.normal(10.0, 1.0, 4))))
        assert told is not None
        held += told.ci95[0] < 0.0 < told.ci95[1]
    assert 0.93 < held / 400 <= 1.0


def test_a_course_that_softens_is_found_and_one_that_does_not_is_not() -> None:
    def visits(*parts: float) -> list[object]:
        return [
            measured(Ankle(zero=2.0 * k - 2.0, stiff=part * BEFORE.stiff), k)
            for k, part in enumerate(parts)
        ]

    told = surae.course(visits(1.0, 0.8, 0.6), question=["torque_rise"])
    assert told.measures["torque_rise"].verdict == "changed"
    assert told.series["torque_rise"].values[0] > told.series["torque_rise"].values[2]
    assert len(told.as_table().above[0].split("→")) == 3
    same = surae.course(visits(1.0, 1.0, 1.0), question=["torque_rise"])
    assert same.measures["torque_rise"].verdict == "no change shown"
    assert same.changed == ()


def test_a_course_needs_visits_and_days_apart() -> None:
    trial = measured(BEFORE, 0)
    with pytest.raises(InputError, match="same"):
        surae.course([trial, trial, measured(BEFORE, 1)])
    with pytest.raises(InputError, match="one day"):
        surae.course([measured(BEFORE, k) for k in range(3)], days=[3.0, 3.0, 3.0])
