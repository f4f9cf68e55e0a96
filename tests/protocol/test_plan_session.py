"""A session's plan: more minutes never know less, and no step is promised for nothing."""

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.planning.legs import population_legs
from surae.planning.session import best_session
from surae.protocol import Protocol, generate


@pytest.fixture(scope="module")
def plans():
    legs = population_legs("auto", "healthy", 1)
    settings = {"profile": "multi-sine-holds", "rate_hz": 100.0, "duration": 10.0}
    trials = {kind: generate(Protocol(task=kind, **settings)) for kind in ("active", "passive")}
    return {minutes: best_session(trials, legs, 0.5, minutes) for minutes in (1.0, 10.0)}


def test_a_plan_keeps_to_its_minutes_and_more_of_them_know_no_less(plans) -> None:
    for minutes, plan in plans.items():
        assert plan.minutes <= minutes
        assert plan.minutes == pytest.approx(sum(s.minutes * s.times for s in plan.steps))
    known = [plan.known for plan in plans.values()]
    assert np.all(np.diff(known) >= 0.0)
    assert known[0] < known[-1] <= 15.0


def test_each_step_tells_its_price_and_the_last_one_what_all_know(plans) -> None:
    plan = plans[10.0]
    assert plan.steps[-1].known == pytest.approx(plan.known)
    assert all(step.loses >= 0.0 for step in plan.steps)
    assert "geometry" in [step.name for step in plan.steps]
    assert "geometry" in repr(plan)


def test_no_time_for_a_trial_is_said() -> None:
    legs = population_legs("auto", "healthy", 1)
    trial = generate(Protocol(profile="sine", rate_hz=100.0, task="passive", duration=11.0))
    with pytest.raises(InputError, match="one trial takes"):
        best_session({"passive": trial}, legs, 0.5, 0.1)
