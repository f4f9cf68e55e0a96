"""Predictions of other recordings."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.inference import assess
from surae.inference.judging.goodness import rmse, vaf
from surae.inference.judging.validation import pooled, predict_others
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial


@pytest.fixture(scope="module")
def others(subject, trajectory):
    """A repetition of the fitted trial, and another protocol."""
    passive = generate(Protocol(profile="ramp-and-hold", rate_hz=125.0))
    return virtual_trial(subject, trajectory, seed=1), virtual_trial(subject, passive)


@pytest.fixture(scope="module")
def known(fitted):
    return assess(fitted).uncertainty


def test_parameters_predict_a_repetition_and_another_protocol(fitted, known, others) -> None:
    again, ramp = predict_others(fitted, others, known)
    assert again.vaf > 99.8
    assert ramp.vaf > 99.5
    for one, inputs in zip((again, ramp), others, strict=True):
        residual = inputs.torque - one.torque
        assert one.vaf == pytest.approx(vaf(inputs.torque, residual))
        assert one.rmse == pytest.approx(rmse(residual))
        assert one.bias == pytest.approx(residual.mean())
        np.testing.assert_array_equal(one.time, inputs.time)
        np.testing.assert_array_equal(one.measured, inputs.torque)


def test_a_prediction_is_judged_by_what_the_fit_promises(fitted, known, others) -> None:
    again, ramp = predict_others(fitted, others, known)
    assert again.adequacy.grade == ramp.adequacy.grade == "adequate"
    assert again.adequacy.reasons == ()
    shifted = replace(others[0], torque=others[0].torque + 6.0)
    (moved,) = predict_others(fitted, [shifted], known)
    assert moved.adequacy.grade == "doubtful"
    assert moved.adequacy.r2 == pytest.approx(again.adequacy.r2)
    (reason,) = moved.adequacy.reasons
    assert reason.startswith("its mean is off by +6 Nm")


@pytest.mark.parametrize("seed", [4, 5, 6])
def test_another_leg_is_not_predicted(fitted, known, trajectory, seed) -> None:
    (other,) = predict_others(fitted, [virtual_trial(virtual_subject(seed), trajectory)], known)
    assert other.adequacy.grade != "adequate"
    assert any("where the fit promises" in reason for reason in other.adequacy.reasons)


def test_what_holds_still_is_no_test(fitted, known, others) -> None:
    held = replace(others[0], angle=np.full(others[0].n, 0.1))
    (still,) = predict_others(fitted, [held], known)
    assert still.adequacy.grade != "adequate"
    assert "the ankle holds still there" in still.adequacy.reasons[0]


def test_pooled_figures_are_those_of_one_long_recording(fitted, known, others) -> None:
    found = predict_others(fitted, others, known)
    measured = np.concatenate([one.torque for one in others])
    residual = measured - np.concatenate([one.torque for one in found])
    together = pooled(found)
    assert together.vaf == pytest.approx(vaf(measured, residual))
    assert together.rmse == pytest.approx(rmse(residual))
    assert together.bias == pytest.approx(residual.mean())


def test_samples_left_out_are_in_no_figure(fitted, known, others) -> None:
    spoilt = others[0].torque.copy()
    spoilt[100:200] += 1000.0
    weight = np.ones(others[0].n)
    weight[100:200] = 0.0
    bad = replace(others[0], torque=spoilt)
    (all_of_it,) = predict_others(fitted, [bad], known)
    (without,) = predict_others(fitted, [replace(bad, weight=weight)], known)
    assert all_of_it.vaf < 90
    assert without.vaf > 99.8
    assert pooled([without]).vaf == without.vaf
    assert len(without.torque) == bad.n


def test_what_does_not_carry_over(fitted, known, others) -> None:
    with pytest.raises(InputError, match="the weights do not carry over"):
        predict_others(fitted, [replace(others[0], emg_unit="1")], known)
    with pytest.raises(InputError, match="no EMG of muscle 'sol', whose weight the fit estimated"):
        predict_others(fitted, [replace(others[0], missing_emg=("sol",))], known)
