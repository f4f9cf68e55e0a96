"""Strides of one leg, cut from its walking, are pieces of one movement to a joint fit."""

import pytest

import surae


@pytest.fixture(scope="module")
def strides(shared) -> list[surae.Recording]:
    """Six strides of a walking adult, some 1.1 s each."""
    return [surae.read(path) for path in sorted((shared / "strides").glob("adult_*.csv"))]


@pytest.mark.slow
def test_strides_together_are_followed_by_values_that_a_leg_can_have(strides) -> None:
    """Muscles that began each at rest asked for a cut-off of 15 Hz and a damping of 2.9."""
    fit = surae.fit(strides, "muscle-tendon")
    assert fit.adequacy.r2 > 99.0
    assert 1.0 < fit.values["f0"] < 4.0
    assert 0.5 < fit.values["beta"] < 1.2


@pytest.mark.slow
def test_strides_of_one_leg_are_not_said_to_be_of_several(strides) -> None:
    fit = surae.fit(strides)
    assert fit.adequacy.r2 > 98.4
    assert not {"not-one-leg", "foot-moved"} & {reason.code for reason in fit.adequacy.against}
    for recording, residual in zip(fit.result.problem.inputs, fit.result.residuals, strict=True):
        assert len(residual) == recording.n
        assert recording.counted == 100
