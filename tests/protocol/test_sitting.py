"""A session as a design: trials add up, the time is kept, and what is not worth it is left out."""

import json

import numpy as np
import pytest

import surae
from surae.errors import InputError
from surae.protocol import Protocol, generate
from surae.protocol.planning.information import information, prior_precision, shared
from surae.protocol.planning.legs import population_legs
from surae.protocol.planning.sitting import PlannedTrial, plan_session

RATE = 32.0


def trial(name, kind, profile="multiple-holds", **changes):
    settings = {"profile": profile, "rate_hz": RATE, **changes}
    trajectory = generate(Protocol(**settings))
    return PlannedTrial(name, kind, float(trajectory.time[-1]), trajectory)


@pytest.fixture(scope="module")
def legs():
    return population_legs("muscle", None, 3)


@pytest.fixture(scope="module")
def trials():
    return (
        trial("active", "active", chirp_amplitude=0.1),
        trial("passive", "passive", "ramp-and-hold", task="passive"),
        trial("slow", "rest", "sine", task="passive"),
    )


def planned(trials, legs, **changes):
    asked = {"seconds": 300.0, "pause": 30.0, "noise": 0.5, "aim": "worst"}
    return plan_session(trials, legs, **(asked | changes))


def test_information_of_trials_adds_up_and_the_time_is_kept(trials, legs) -> None:
    plan = planned(trials, legs)
    counts = {t.name: sum(x.name == t.name for x in plan.trials) for t in trials}
    assert counts["active"] >= 1
    length = sum(t.seconds for t in plan.trials) + 30.0 * (len(plan.trials) - 1)
    assert plan.seconds == pytest.approx(length)
    assert plan.seconds <= 300.0
    total = sum(counts[t.name] * information(t.trajectory, legs, 0.5).matrices for t in trials)
    sem = np.sqrt([np.diag(np.linalg.inv(m)) for m in total]) / np.abs(legs.estimated)
    told = [p.relative_sem for p in plan.expectation.parameters.values()]
    np.testing.assert_allclose(told, np.sqrt((sem**2).mean(axis=0)), rtol=1e-5)
    known = [w for w in plan.worst if w is not None]
    assert known == sorted(known, reverse=True)
    assert plan.worst[-1] == plan.expectation.worst


def test_what_is_worth_its_minutes_is_said(trials, legs) -> None:
    plan = planned(trials, legs)
    told = " ".join(plan.sentences)
    assert plan.without["active"] is None or plan.without["active"] > 10 * plan.expectation.worst
    assert "Without active trials the largest error would be unknown: they are worth" in told
    assert json.loads(json.dumps(plan.to_json()))["worst_without"] == dict(plan.without)
    # the passive question is answered by passive trials, though active ones were at hand
    relaxed = planned(trials[1:], legs, aim="k_tri", seconds=120.0)
    assert {t.kind for t in relaxed.trials} <= {"passive", "rest"}


def test_no_exchange_or_addition_makes_it_better(trials, legs) -> None:
    """The plan is compared with every session of the same length."""
    plan = planned(trials, legs, seconds=200.0)
    matrices = np.array([information(t.trajectory, legs, 0.5).matrices for t in trials])
    best = np.inf
    for a in range(5):
        for b in range(8):
            for c in range(6):
                counts = np.array([a, b, c])
                if counts @ np.array([t.seconds + 30.0 for t in trials]) > 230.0:
                    continue
                total = np.tensordot(counts, matrices, 1) + 1e-12 * np.eye(15)
                try:
                    covariance = np.linalg.inv(total)
                except np.linalg.LinAlgError:
                    continue
                rms = np.sqrt((np.diagonal(covariance, axis1=1, axis2=2)
                               / legs.estimated**2).mean(axis=0))  # fmt: skip
                best = min(best, float(rms.max()) if np.isfinite(rms).all() else np.inf)
    assert plan.expectation.worst <= 1.1 * best


def test_what_differs_from_trial_to_trial_is_not_shared() -> None:
    """Twice the same trial tells less than twice as much where each has a zero of its own."""
    legs = population_legs("muscle", None, 2, nuisances="all")
    one = trial("active", "active", chirp_amplitude=0.1)
    told = shared(information(one.trajectory, legs, 0.5), legs)
    assert "torque_zero" not in told.names
    at = [legs.free.index(n) for n in told.names]
    known = prior_precision(legs.free, legs)
    alone = np.linalg.inv(information(one.trajectory, legs, 0.5).matrices[0] + known)
    apart = np.linalg.inv(told.matrices[0] + known[np.ix_(at, at)])
    np.testing.assert_allclose(np.diag(apart), np.diag(alone)[at], rtol=1e-6)


def test_a_session_of_the_product_s_own_trials() -> None:
    plan = surae.design_session(2.0, model="muscle", rate_hz=32.0)
    assert plan.seconds <= 120.0
    assert {t.kind for t in plan.trials} <= {"rest", "passive", "active", "maximal"}
    assert max(map(abs, plan.expectation.torque)) <= 80.0
    relaxed = surae.design_session(2.0, model="muscle", rate_hz=32.0, effort="none", aim="k_tri")
    assert not any(t.trajectory.effort.any() for t in relaxed.trials)


@pytest.mark.parametrize(
    "change", [{"minutes": 0.1}, {"minutes": 1e9}, {"pause": -1.0}, {"aim": "x"}, {"effort": "x"}]
)
def test_impossible_sessions_are_refused(change) -> None:
    with pytest.raises(InputError):
        surae.design_session(**{"minutes": 2.0, "model": "muscle", "rate_hz": 32.0, **change})
