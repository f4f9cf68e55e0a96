"""Strides of one leg, cut from its walking, are pieces of one movement to a joint fit."""

import pytest

import surae
from surae.inference.judging.baselines import baselines
from surae.signals import led_in


@pytest.fixture(scope="module")
def strides(shared) -> list[surae.Recording]:
    """Six strides of a walking adult, some 1.1 s each."""
    return [surae.read(path) for path in sorted((shared / "strides").glob("adult_*.csv"))]


def test_what_stands_before_a_stride_moves_no_phase(strides) -> None:
    """The mean torque of other strides at the same phase is the same with a lead-in and without."""
    plain = [surae.prepare(each) for each in strides]
    led = [led_in(each) for each in plain]
    assert [each.lead_in for each in led] == pytest.approx([0.7] * 6, abs=0.01)
    as_they_are = baselines(plain[1:], plain[0]).template
    assert as_they_are is not None
    assert as_they_are > 98.0
    for others, own in ((led[1:], plain[0]), (led[1:], led[0]), (plain[1:], led[0])):
        assert baselines(others, own).template == pytest.approx(as_they_are, abs=1e-9)


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
