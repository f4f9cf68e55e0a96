"""Subjects and trials that others compare with: the same numbers for ever."""

import pytest

from surae.protocol import Protocol, generate
from surae.studies import Imperfections, virtual_subject, virtual_trial

PARAMETERS = {
    (1, "healthy"): [
        2.114185949640308,
        227.02782177955612,
        95.76638450878535,
        0.017897298894274487,
        0.06355915726005243,
        3.1166322448628785,
        0.5310810375281767,
        563679.6545476646,
        929756.2126038356,
        922047.2905944547,
        1152107.865204884,
        0.04538143313219278,
        0.07659463432998184,
        2.2307429627427235,
        0.921277931716658,
    ],
    (7, "patient"): [
        1.8276057132526056,
        195.0367259942958,
        127.5639093318851,
        0.014819910523118101,
        0.05972787528814458,
        3.5086423575142525,
        0.5971306361121642,
        522552.4975331849,
        795512.4180146665,
        1319675.1187389696,
        848149.1390965579,
        0.034284587930261255,
        0.0717344291464034,
        2.32562142305705,
        1.1383457817241345,
    ],
}


@pytest.fixture(scope="module")
def trajectory():
    return generate(
        Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=64.0)
    )


@pytest.mark.parametrize(("seed", "population"), PARAMETERS)
def test_subjects(seed, population):
    drawn = virtual_subject(seed, population).parameters
    assert [*drawn.values()] == PARAMETERS[seed, population]


# The noise is exact; what runs through exp and tan may differ in its last digits elsewhere.
@pytest.mark.parametrize(
    ("model", "noise", "seed", "torque", "emg"),
    [
        (
            "muscle",
            0.05,
            0,
            [-0.8366832988978614, 1.6813269730398928, -37.82946655035886],
            [-2.0378314927200243e-06, 0.00018733521110272548, 0.0002046097211594353],
        ),
        (
            "muscle",
            0.05,
            3,
            [2.501397201090682, 4.321098574880762, -37.56147096664725],
            [-2.2370871385915838e-06, 0.00018632813991223713, 0.00020036907364747993],
        ),
        (
            "muscle-tendon",
            0.05,
            0,
            [-0.22734514630054314, -0.8540785753864957, -50.2217075326696],
            [-2.0378314927200243e-06, 0.00018733521110272548, 0.0002046097211594353],
        ),
        (
            "muscle",
            0.0,
            0,
            [1.6321285890332176, 2.716123462665738, -38.244513422151954],
            [1e-06, 0.00018628746823622078, 0.0002014773745810463],
        ),
    ],
)
def test_trials(trajectory, model, noise, seed, torque, emg):
    subject = virtual_subject(2)
    trial = virtual_trial(subject, trajectory, model=model, noise=noise, seed=seed)
    assert trial.name == "virtual subject 2 (healthy), multiple-holds, part-passive"
    assert trial.torque[[0, 1000, 2000]] == pytest.approx(torque, rel=1e-9)
    assert trial.emg[1500, :3] == pytest.approx(emg, rel=1e-9)
    ideal = virtual_trial(
        subject, trajectory, model=model, noise=noise, seed=seed, imperfections=Imperfections()
    )
    assert (ideal.torque == trial.torque).all()
    assert (ideal.emg == trial.emg).all()
    assert ideal.steps == trial.steps
    assert len(trial.steps) == 1
