"""A named model is held against what it does not know of, and only contradicted where data do."""

import numpy as np
import pytest

import surae
from surae.assessment import Verdict, assess
from surae.estimation import make_problem, solve
from surae.estimation.contradiction import contradiction
from surae.recording import read
from surae.signals import prepare
from surae.studies.richer import richer_leg


@pytest.fixture(scope="module")
def legs(tmp_path_factory):
    """Fits of richer legs, from files, by models that know of no laboratory."""
    folder, made = tmp_path_factory.mktemp("legs"), []
    for seed in (310, 311):
        leg = richer_leg(seed)
        leg.write(folder / f"{seed}.csv")
        inputs = prepare(read(folder / f"{seed}.csv"))
        made += [
            (leg, solve(make_problem([inputs], model, starts=1)))
            for model in ("muscle", "muscle-tendon-strain")
        ]
    return made


def test_what_a_named_model_leaves_out_is_not_identified(legs) -> None:
    before = false_before = after = false_after = 0
    for leg, result in legs:
        against = contradiction(result, doubtful=True)
        assert against is not None
        assert {"zero", "delay", "crosstalk"} <= set(against.missing)
        plain, held = assess(result), assess(result, alternatives=True)
        for name, p in held.parameters.items():
            old = plain.parameters[name]
            assert p.value == old.value
            assert p.sem == old.sem
            if p.verdict is Verdict.IDENTIFIED:
                after += 1
                false_after += not p.ci95[0] <= leg.parameters[name] <= p.ci95[1]
            if old.verdict is Verdict.IDENTIFIED:
                before += 1
                false_before += not old.ci95[0] <= leg.parameters[name] <= old.ci95[1]
                assert p.ci95[0] <= old.ci95[0] < old.ci95[1] <= p.ci95[1]
                assert p.repeatable
                assert p.ci95_repeat == old.ci95
                assert sum(p.budget.values()) == pytest.approx(1.0)
                if p.verdict is not Verdict.IDENTIFIED:
                    assert "the data contradict this model" in p.note
    assert false_before > 0.5 * before
    assert after < before
    assert false_after < 0.5 * false_before


def test_a_model_that_holds_is_not_contradicted(noisy) -> None:
    result = solve(make_problem([noisy], "muscle", starts=2))
    assert contradiction(result, doubtful=False) is None
    assert assess(result, alternatives=True) == assess(result)


def test_what_is_known_is_no_alternative(legs) -> None:
    _, result = legs[0]
    inputs = result.problem.inputs
    told = solve(make_problem(inputs, "muscle", starts=1, free=("torque_zero", "emd")))
    against = contradiction(told, doubtful=True)
    assert against is not None
    assert "zero" not in against.missing
    assert "delay" not in against.missing


def test_a_family_and_its_answer_are_held_against_themselves_already(noisy) -> None:
    result = solve(make_problem([noisy], "auto", nuisances="none"))
    assert contradiction(result, doubtful=False) is None


def test_a_fit_as_people_make_it_is_held_against_the_rest(legs, tmp_path) -> None:
    leg, _ = legs[0]
    leg.write(tmp_path / "leg.csv")
    fit = surae.fit(tmp_path / "leg.csv", model="muscle", starts=1, quality=())
    assert "a model with zero, delay, crosstalk, tendons" in fit.assessment.interval_note
    fit.save(tmp_path / "fit.json")
    again = surae.load(tmp_path / "fit.json")
    assert again == fit
    assert np.isfinite([p.ci95 for p in again.parameters.values() if p.ci95]).all()
