"""Tissue that softens is said of legs whose tissue does, by whom the estimate was not made."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from ankle_legs.make import make
from surae.base.frozen import read_only
from surae.inference import assess, make_problem, solve


def softens(inputs) -> bool:
    """Whether a fit says so, and is doubtful for it."""
    judged = assess(solve(make_problem([inputs], "auto"))).adequacy
    said = any("softened" in reason for reason in judged.reasons)
    assert not said or judged.grade != "adequate"
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
