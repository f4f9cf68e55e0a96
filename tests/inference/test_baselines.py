"""What is predicted without a model, and how unsure a predicted torque is."""

from dataclasses import replace

import pytest

from surae.base.frozen import read_only
from surae.inference.judging.baselines import baselines
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

MOVES = Protocol(profile="multiple-holds", rate_hz=50.0, task="active", duration=20.0)


@pytest.fixture(scope="module")
def trials():
    subject = virtual_subject(seed=3)
    return [virtual_trial(subject, generate(MOVES), seed=seed) for seed in (1, 2, 3)]


def test_a_torque_that_is_linear_is_predicted_wholly(trials) -> None:
    def linear(trial):
        torque = 3.0 - 20.0 * trial.angle + 2.0 * trial.velocity + 1e4 * trial.emg[:, 2]
        return replace(trial, torque=read_only(torque))

    told = baselines([linear(trials[0])], linear(trials[1]))
    assert told.ridge == pytest.approx(100.0, abs=1e-3)


def test_the_mean_of_others_is_told_of_the_same_movement_alone(trials) -> None:
    first, second, third = trials
    told = baselines([first, second], third)
    mean = 0.5 * (first.torque + second.torque)
    missed = third.torque - mean
    assert told.template == pytest.approx(
        100.0 * (1.0 - missed @ missed / (third.torque @ third.torque)), abs=1e-6
    )
    turned = replace(third, angle=read_only(third.angle[::-1].copy()))
    assert baselines([first, second], turned).template is None


def test_of_a_recording_of_the_fit_nothing_is_told(trials) -> None:
    told = baselines(trials, trials[0])
    assert (told.template, told.ridge) == (None, None)


def test_without_muscles_the_regression_misses_what_they_do(trials) -> None:
    silent = [replace(t, emg=read_only(0.0 * t.emg)) for t in trials[:2]]
    assert baselines(silent, trials[2]).ridge < baselines(trials[:2], trials[2]).ridge
