"""What drives the cohort's torque and no EMG shows, with draws of its own."""

import numpy as np
import pytest

from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial
from surae.studies.leg import VirtualTrial
from surae_thesis.cohort.imperfections import UNMEASURED_VARIATION, CohortImperfections

SUBJECT = virtual_subject(4)
SIZES = {"unmeasured": 0.15, "gain_variation": 0.3}


@pytest.fixture(scope="module")
def trajectory():
    return generate(Protocol(profile="multi-sine", rate_hz=128.0))


def trial(trajectory, **sizes):
    return virtual_trial(SUBJECT, trajectory, noise=0.0, imperfections=CohortImperfections(**sizes))


@pytest.mark.parametrize("name", SIZES)
def test_each_is_in_the_torque_and_in_no_emg_and_moves_no_other_draw(trajectory, name):
    ideal, again = trial(trajectory), trial(trajectory, **{name: SIZES[name]})
    assert np.abs(again.torque - ideal.torque).max() > 0.05
    np.testing.assert_array_equal(again.emg, ideal.emg)
    almost = trial(trajectory, **{name: 1e-9 * SIZES[name]})
    np.testing.assert_allclose(almost.torque, ideal.torque, atol=1e-5)
    noise = trial(trajectory, torque_noise=0.7).torque - ideal.torque
    beside = trial(trajectory, torque_noise=0.7, **{name: SIZES[name]}).torque - again.torque
    np.testing.assert_allclose(beside, noise, atol=1e-10)
    gains = trial(trajectory, effort_variation=0.2).emg[:, 0]
    both = trial(trajectory, effort_variation=0.2, **{name: SIZES[name]}).emg[:, 0]
    np.testing.assert_array_equal(both, gains)


def test_muscles_without_electrodes_add_their_share_on_average(trajectory):
    settings = CohortImperfections(unmeasured=0.2)
    envelopes = 6e-4 * trajectory.effort + 1e-6

    def driven(seed, number):
        of = VirtualTrial(virtual_subject(seed), trajectory, settings, number)
        return settings.drive(envelopes, of.gains) / envelopes - 1.0

    shares = np.stack([driven(seed, number) for seed in range(30) for number in range(3)])
    assert shares.mean() == pytest.approx(0.2, abs=0.005)
    assert shares.std() == pytest.approx(0.2 * UNMEASURED_VARIATION, rel=0.05)
    wander = shares[:, ::50, 0] - 0.2  # each subject's and each trial's own
    assert np.abs(np.corrcoef(wander) - np.eye(len(wander))).mean() < 0.25
    # The three heads have the same helpers, the tibialis others.
    np.testing.assert_allclose(shares[:, :, 1], shares[:, :, 3])
    assert abs(np.corrcoef(shares[:, :, 0].ravel(), shares[:, :, 1].ravel())[0, 1]) < 0.1
    assert CohortImperfections().drive(envelopes, lambda *_: envelopes) is envelopes
