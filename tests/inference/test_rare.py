"""Rare departures are looked for one by one; what is not there changes and costs nothing."""

import numpy as np
import pytest

import surae
from richer_legs import richer_leg
from surae.inference import make_problem, solve
from surae.inference.posterior import departures
from surae.model.laboratory import RARE


def test_where_none_is_asked_for_nothing_changes(monkeypatch) -> None:
    problem = make_problem([richer_leg(0, rate_hz=64.0, duration=12.0).inputs], "auto")
    looked = solve(problem)
    monkeypatch.setattr(departures, "_rare", lambda *_: ())
    without = solve(problem)
    assert looked.solution.evaluations <= without.solution.evaluations + 2
    half = 1.96 * np.sqrt(np.diag(without.solution.covariance))
    for j, name in enumerate(without.problem.free):
        assert abs(looked.values[name] - without.values[name]) < 1e-3 * half[j], name


@pytest.mark.parametrize(("leg", "there"), [("e", True), ("k", False)])
def test_short_range_stiffness_is_found_where_it_is(leg: str, there: bool, tmp_path) -> None:
    legs = pytest.importorskip("ankle_legs.make", reason="surae-legs is not installed")
    fit = surae.fit(legs.make(leg, 1004, tmp_path, (1,), seconds=25.0)[0], model="auto", quality=())
    assert ("bridges" in fit.result.solution.candidates[0].groups) == there
    assert not any(g in fit.result.solution.candidates[0].groups for g in departures.LAWS)
    if there:  # drawn between 16 and 30, and between 0.6 and 1.4 % of the optimal length
        assert 8.0 < fit.result.values["bridge_stiffness"] < 40.0
        assert fit.adequacy.r2 > 99.5


@pytest.mark.parametrize(("leg", "seed"), [("a", 2101), ("b", 2102), ("h", 2103)])
def test_no_rare_departure_is_claimed_of_legs_that_have_none(leg: str, seed: int, tmp_path) -> None:
    """Neither of legs of another generator: other curves, geometry and drives, but no reflex."""
    legs = pytest.importorskip("ankle_legs.make", reason="surae-legs is not installed")
    fit = surae.fit(legs.make(leg, seed, tmp_path, (1,), seconds=25.0)[0], quality=())
    assert not {*RARE} & {*fit.result.solution.candidates[0].groups}


@pytest.mark.parametrize("trial", ["PL_50_02", "PL_0_01"])
def test_no_rare_departure_is_claimed_of_measured_trials(trial: str, shared, tmp_path) -> None:
    """Of one person’s efforts on a dynamometer, in which nobody has shown one."""
    told = (shared / "dynamometer" / "PL_50_01.toml").read_text(encoding="utf-8")
    mapping = tmp_path / "trial.toml"
    path = shared / "repeats" / f"{trial}.mat"
    mapping.write_text(told.replace("PL_50_01.mat", str(path)), encoding="utf-8")
    fit = surae.fit(mapping, quality=())
    assert not {*RARE} & {*fit.result.solution.candidates[0].groups}
    assert not any(name.startswith(("bridge", "reflex")) for name in fit.parameters)


@pytest.mark.slow
@pytest.mark.parametrize("trial", ["walk36", "run81"])
def test_no_rare_departure_is_claimed_of_measured_gait(trial: str, shared) -> None:
    fit = surae.fit(shared / "gait" / f"{trial}.toml", quality=())
    assert not {*RARE} & {*fit.result.solution.candidates[0].groups}
