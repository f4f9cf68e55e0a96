"""Rare departures are looked for one by one; what is not there changes and costs nothing."""

import numpy as np
import pytest

import surae
from ankle_legs.make import make
from richer_legs import richer_leg
from surae.inference import departures, make_problem, solve


def test_where_none_is_asked_for_nothing_changes(monkeypatch) -> None:
    problem = make_problem([richer_leg(0, rate_hz=64.0, duration=12.0).inputs], "auto")
    looked = solve(problem)
    monkeypatch.setattr(departures, "_rare", lambda *_: ())
    without = solve(problem)
    assert looked.found.evaluations <= without.found.evaluations + 2
    half = 1.96 * np.sqrt(np.diag(without.found.covariance))
    for j, name in enumerate(without.problem.free):
        assert abs(looked.values[name] - without.values[name]) < 1e-3 * half[j], name


@pytest.mark.parametrize(("leg", "there"), [("e", True), ("k", False)])
def test_short_range_stiffness_is_found_where_it_is(leg: str, there: bool, tmp_path) -> None:
    fit = surae.fit(make(leg, 1004, tmp_path, (1,), seconds=25.0)[0], model="auto", quality=())
    assert ("bridges" in fit.result.found.candidates[0].groups) == there
    assert not any(g in fit.result.found.candidates[0].groups for g in departures.LAWS)
    if there:  # drawn between 16 and 30, and between 0.6 and 1.4 % of the optimal length
        assert 8.0 < fit.result.values["bridge_stiffness"] < 40.0
        assert fit.adequacy.r2 > 99.5
