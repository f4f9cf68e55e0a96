"""`model="auto"`: what it finds on legs that no model is, and what it must not claim."""

from dataclasses import replace

import numpy as np
import pytest

from surae.assessment import Verdict, assess
from surae.assessment.saved.fit_json import load_saved, save_fit
from surae.errors import InputError
from surae.estimation import make_problem, solve
from surae.frozen import read_only
from surae.model.laboratory import ALL, laboratory
from surae.studies.richer import richer_leg


@pytest.fixture(scope="module")
def leg():
    return richer_leg(0)


@pytest.fixture(scope="module")
def fitted(leg):
    return solve(make_problem([leg.inputs], "auto"))


def truth_in(worth, parameters):
    claimed = [p for p in worth.parameters.values() if p.verdict is Verdict.IDENTIFIED]
    hits = sum(p.ci95[0] <= parameters[p.name] <= p.ci95[1] for p in claimed)
    return len(claimed), hits


def test_a_richer_leg_is_found_with_its_laboratory(leg, fitted):
    assert fitted.problem.spec.name == "muscle-tendon-strain"
    assert {"zero", "delay", "crosstalk"} <= set(fitted.family.candidates[0].groups)
    assert np.std(fitted.residuals[0]) == pytest.approx(leg.noise, rel=0.05)
    assert fitted.values["torque_zero"] == pytest.approx(leg.zero, abs=0.2)
    assert fitted.values["emd"] == pytest.approx(leg.delay, abs=5e-3)
    worth = assess(fitted)
    claimed, hits = truth_in(worth, leg.parameters)
    assert claimed >= 9
    assert hits >= claimed - 1
    assert set(worth.nuisances) == set(fitted.family.beliefs)
    assert not set(worth.nuisances) & set(worth.parameters)


def test_every_share_of_a_budget_is_told(fitted):
    worth = assess(fitted)
    for p in worth.parameters.values():
        if p.free and not p.at_bound:
            assert sum(p.budget.values()) == pytest.approx(1.0)
            assert min(p.budget.values()) >= 0.0
            assert {"noise", "delay", "crosstalk", "zero", "emg_noise", "tendon"} <= set(p.budget)
            assert p.lower <= p.ci95[0] <= p.value <= p.ci95[1] <= p.upper
    # The delay is what the filter of the activation is least known for.
    assert worth.parameters["f0"].budget["delay"] > 0.2


def test_a_family_survives_a_file(fitted, tmp_path):
    save_fit(tmp_path / "fit.json", fitted, assess(fitted))
    again = load_saved(tmp_path / "fit.json").result
    assert again == fitted
    assert assess(again) == assess(fitted)


def test_a_leg_of_the_simple_model_keeps_it(noisy, subject):
    result = solve(make_problem([noisy], "auto", nuisances="none"))
    assert result.problem.spec.name == "muscle"
    assert not result.family.beliefs
    claimed, hits = truth_in(assess(result), subject.parameters)
    assert claimed >= 10
    assert hits >= claimed - 2


def test_a_static_hold_identifies_nothing(leg):
    one = leg.inputs
    still = replace(
        one,
        angle=read_only(np.full(one.n, -0.4) + 1e-3 * np.sin(one.time)),
        velocity=read_only(1e-3 * np.cos(one.time)),
        acceleration=read_only(-1e-3 * np.sin(one.time)),
    )
    worth = assess(solve(make_problem([still], "auto")))
    assert worth.adequacy.grade == "inadequate"
    assert not any(p.verdict is Verdict.IDENTIFIED for p in worth.parameters.values())


def test_what_is_fixed_stays_and_what_is_known_is_no_nuisance(leg):
    result = solve(make_problem([leg.inputs], "auto", fixed={"beta": 1.0, "torque_zero": leg.zero}))
    assert result.values["beta"] == 1.0
    assert "torque_zero" not in result.family.beliefs


def test_several_recordings_have_their_own_zeros(leg):
    other = richer_leg(0, trial=1)
    result = solve(make_problem([leg.inputs, other.inputs], "auto"))
    assert result.family.zeros == pytest.approx((leg.zero, other.zero), abs=0.3)
    for one, residual in zip((leg, other), result.residuals, strict=True):
        assert np.std(residual) == pytest.approx(one.noise, rel=0.05)


def test_a_laboratory_can_be_told():
    assert laboratory("none") == {}
    told = laboratory({"zero": (1.0, 0.5), "emd": (0.0, 0.0)})
    assert (told["torque_zero"].mean, told["torque_zero"].sd) == (1.0, 0.5)
    assert "emd" not in told
    assert set(told) == set(laboratory(ALL)) - {"emd"}
    with pytest.raises(InputError, match="no 'magic'"):
        laboratory({"magic": (0.0, 1.0)})


def test_a_loss_needs_a_named_model(leg):
    with pytest.raises(InputError, match="goes with a named model"):
        solve(make_problem([leg.inputs], "auto", loss="huber"))


def test_ctrl_c_keeps_the_simple_model_and_claims_no_family(leg):
    def press(done, total, best):
        raise KeyboardInterrupt

    result = solve(make_problem([leg.inputs], "auto"), progress=press)
    assert result.family is None
    assert result.problem.spec.name == "muscle"
    assert result.starts[-1].outcome == "interrupted"
    assert "stopped by the user" in result.message
