"""Imperfections as settings: none by default, each with draws of its own."""

from dataclasses import fields

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.protocol import Protocol, generate
from surae.studies import (
    POPULATIONS,
    Imperfections,
    realistic_imperfections,
    virtual_subject,
    virtual_trial,
)

SUBJECT = virtual_subject(4)
SIZES = {
    "torque_noise": 0.7,
    "crosstalk": 0.08,
    "axis_forward": 0.01,
    "axis_up": -0.01,
    "knee_motion": 0.05,
    "effort_variation": 0.2,
    "reflex_gain": 0.3,
}


@pytest.fixture(scope="module")
def trajectory():
    return generate(Protocol(profile="multiple-holds", rate_hz=64.0))


def trial(trajectory, seed=0, noise=0.0, **sizes):
    return virtual_trial(
        SUBJECT, trajectory, noise=noise, seed=seed, imperfections=Imperfections(**sizes)
    )


def test_every_size_is_zero_by_default():
    others = {f.name for f in fields(Imperfections)} - SIZES.keys()
    assert others == {"torque_noise_time"}
    assert all(getattr(Imperfections(), name) == 0.0 for name in SIZES)
    assert Imperfections().steps == ()


def test_the_kind_of_a_disturbance_of_no_size_has_no_effect(trajectory):
    ideal = trial(trajectory)
    again = trial(trajectory, torque_noise_time=1.0)
    np.testing.assert_array_equal(again.torque, ideal.torque)
    np.testing.assert_array_equal(again.emg, ideal.emg)


@pytest.mark.parametrize("name", SIZES)
def test_each_changes_what_it_should_and_is_told(trajectory, name):
    ideal, again = trial(trajectory), trial(trajectory, **{name: SIZES[name]})
    torque, emg = np.abs(again.torque - ideal.torque).max(), np.abs(again.emg - ideal.emg).max()
    assert (torque > 0.05) == (name != "crosstalk")
    assert (emg > 1e-6) == (name in ("crosstalk", "effort_variation", "reflex_gain"))
    np.testing.assert_array_equal(again.angle, ideal.angle)
    assert len(again.steps) == 2
    assert not again.torque.flags.writeable
    assert not again.emg.flags.writeable
    almost = trial(trajectory, **{name: 1e-9 * SIZES[name]})  # none is the limit of a little
    np.testing.assert_allclose(almost.torque, ideal.torque, atol=1e-5)
    np.testing.assert_allclose(almost.emg, ideal.emg, atol=1e-12)


@pytest.mark.parametrize(
    "other",
    ["knee_motion", "effort_variation", "reflex_gain", "axis_up"],
)
def test_one_does_not_move_the_draws_of_another(trajectory, other):
    size = {other: SIZES[other]}
    noise = trial(trajectory, torque_noise=0.7).torque - trial(trajectory).torque
    beside = trial(trajectory, torque_noise=0.7, **size).torque - trial(trajectory, **size).torque
    assert noise.std() > 0.5
    np.testing.assert_allclose(beside, noise, atol=1e-10)
    if other != "effort_variation":  # gains show in the EMG of a muscle without a reflex
        gains = trial(trajectory, effort_variation=0.2).emg[:, 0]
        again = trial(trajectory, effort_variation=0.2, torque_noise=0.7, **size).emg[:, 0]
        np.testing.assert_array_equal(again, gains)


@pytest.mark.parametrize("name", ["torque_noise", "knee_motion", "effort_variation"])
def test_seeds_are_those_of_subject_and_trial(trajectory, name):
    settings = Imperfections(**{name: SIZES[name]})

    def torque(seed, number, population="healthy"):
        subject = virtual_subject(seed, population)
        ideal = virtual_trial(subject, trajectory, noise=0.0)
        trial = virtual_trial(subject, trajectory, noise=0.0, seed=number, imperfections=settings)
        return trial.torque - ideal.torque

    first = torque(4, 0)
    np.testing.assert_array_equal(torque(4, 0), first)
    for other in (torque(4, 1), torque(0, 4), torque(4, 0, "patient")):
        assert abs(np.corrcoef(first, other)[0, 1]) < 0.5
        assert np.abs(first - other).max() > 0.05


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("torque_noise", -1.0, "give at least 0"),
        ("torque_noise", float("nan"), "give a number"),
        ("crosstalk", 1.0, "give at most 0.99"),
        ("axis_forward", 0.06, "give at most 0.05"),
        ("effort_variation", "0.1", "give a number"),
    ],
)
def test_senseless_values_are_refused(name, value, says):
    with pytest.raises(InputError, match=rf"^{name} is .*; {says}$"):
        Imperfections(**{name: value})


def test_realistic_imperfections_are_drawn_once_for_a_subject():
    for population in POPULATIONS:
        drawn = [realistic_imperfections(virtual_subject(seed, population)) for seed in range(200)]
        assert drawn[7] == realistic_imperfections(virtual_subject(7, population))
        assert len({value.crosstalk for value in drawn}) == 200
        assert all(0.03 <= value.crosstalk <= 0.10 for value in drawn)
        assert max(abs(value.axis_up) for value in drawn) <= 0.015
        axis = np.array([(value.axis_forward, value.axis_up) for value in drawn])
        assert axis.std(axis=0) == pytest.approx([0.006, 0.006], rel=0.15)
        assert abs(np.corrcoef(axis.T)[0, 1]) < 0.2
        assert all((value.reflex_gain > 0.0) == (population == "patient") for value in drawn)


def test_all_of_them_go_together_with_tendons(trajectory):
    subject = virtual_subject(3, "patient", tendons=True)
    trial = virtual_trial(
        subject,
        trajectory,
        model="muscle-tendon-toe",
        imperfections=realistic_imperfections(subject),
    )
    assert np.isfinite(trial.torque).all()
    assert len(trial.steps) == 8
