"""Tissue that softens is said of legs whose tissue does, by whom the estimate was not made."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from ankle_legs.make import make
from richer_legs import richer_leg
from surae.base.frozen import FrozenDict, read_only
from surae.inference import Verdict, assess, make_problem, solve


def softens(inputs) -> bool:
    """Whether a fit says so, and is doubtful for it."""
    judged = assess(solve(make_problem([inputs], "auto"))).adequacy
    said = any("softened" in reason for reason in judged.reasons)
    assert not said or judged.grade != "adequate"
    assert not any("no model" in reason for reason in judged.reasons)
    return said


@pytest.mark.parametrize(("family", "said"), [("r", True), ("a", False), ("m", False)])
def test_a_leg_that_softens_is_named_and_others_are_not(family, said, tmp_path) -> None:
    (path,) = make(family, 3801, tmp_path)
    assert softens(surae.prepare(surae.read(path))) == said


def test_muscles_that_were_weaker_at_first_are_no_softening(tmp_path) -> None:
    (path,) = make("a", 3802, tmp_path)
    inputs = surae.prepare(surae.read(path))
    travel = np.cumsum(np.abs(np.gradient(inputs.angle))) / np.ptp(inputs.angle)
    weaker = inputs.emg * (1.0 + 0.3 * np.exp(-travel / 1.5))[:, None]
    assert not softens(replace(inputs, emg=read_only(weaker)))


def test_muscles_that_no_model_expresses_claim_nothing() -> None:
    result = solve(make_problem([richer_leg(0, rate_hz=64.0, duration=12.0).inputs], "auto"))
    assert result.solution.sizes["misfit"] < 0.03
    assert "no model" not in " ".join(assess(result).adequacy.reasons)
    unlike = {**result.solution.sizes, "misfit": 0.05}
    worth = assess(replace(result, solution=replace(result.solution, sizes=FrozenDict(unlike))))
    assert worth.adequacy.grade != "adequate"
    assert any("5 % of the muscles’ force" in reason for reason in worth.adequacy.reasons)
    assert not any(p.verdict is Verdict.IDENTIFIED for p in worth.parameters.values())


@pytest.mark.slow
def test_a_leg_beside_all_models_is_not_adequate(tmp_path) -> None:
    """Its short-range stiffness is not found, and muscles take it."""
    (path,) = make("e", 2405, tmp_path)
    assert surae.fit(path, quality=()).adequacy.grade != "adequate"
