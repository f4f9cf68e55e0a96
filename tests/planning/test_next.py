"""What to measure next: what a fit knows counts, and nothing is promised that is not kept."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.api import fit_inputs
from surae.errors import InputError
from surae.planning.legs import fit_legs
from surae.planning.next import known_from
from surae.planning.ready import ready_protocols
from surae.protocol import Protocol, generate, named_device
from surae.studies import virtual_subject, virtual_trial

DEVICE = named_device("achilles")


def noisy(trajectory, seed, noise=0.5):
    trial = virtual_trial(virtual_subject(seed), trajectory, noise=0.0)
    torque = trial.torque + noise * np.random.default_rng(seed).standard_normal(trial.n)
    return replace(trial, torque=torque)


@pytest.fixture(scope="module")
def weak():
    """A fit of a short trial that tells little of the tibialis' tissue."""
    settings = Protocol(profile="multiple-holds", duration=35.0, device=DEVICE,
                        chirp_amplitude=0.1, rate_hz=64.0, range_of_motion=(-0.7, 0.5))  # fmt: skip
    motion = generate(settings)
    return fit_inputs([noisy(motion, 4, 2.0)], surae.FitSettings("muscle", starts=1))


def test_the_answer_is_a_trial_that_helps(weak, tmp_path) -> None:
    answer = surae.measure_next(weak, range=(-0.9, 0.6))
    unsure = [n for n, p in weak.parameters.items() if p.verdict != "identified"]
    assert unsure
    assert set(answer.gains) == set(unsure)
    assert answer.protocol in ready_protocols()
    assert answer.protocol in answer.sentences[0]
    name, (before, after) = min(answer.gains.items(), key=lambda g: g[1][1] / g[1][0])
    assert after < 0.9 * before
    assert name in answer.sentences[0]
    answer.write(tmp_path / "next.csv")
    assert surae.expect(tmp_path / "next.csv", "muscle", legs=2).parameters


def test_the_information_of_a_fit_is_its_covariance(weak) -> None:
    legs = fit_legs(weak.result, weak.assessment, 1)
    known = known_from(weak.result, weak.assessment, legs)
    believed = weak.assessment.robust or weak.assessment.covariance
    at = [legs.free.index(name) for name in believed.names]
    np.testing.assert_allclose(
        np.linalg.inv(known[np.ix_(at, at)]) / believed.matrix, 1.0, rtol=1e-3
    )


def test_more_trials_never_make_it_worse_and_counts_are_kept(weak) -> None:
    answer = surae.measure_next(weak, range=(-0.9, 0.6))
    for name, times in answer.repetitions.items():
        before, after = answer.gains[name]
        assert after <= before * (1 + 1e-9)
        assert times is None or 1 <= times <= 20
        if times == 1:
            assert after <= 0.10
        elif after <= 0.10:
            raise AssertionError(f"{name} needs one trial only")


def test_nothing_is_asked_for_where_all_is_known() -> None:
    motion = generate(Protocol(profile="multiple-holds", device=DEVICE, chirp_amplitude=0.1,
                               rate_hz=64.0))  # fmt: skip
    fit = fit_inputs([noisy(motion, 4, 0.02)], surae.FitSettings("muscle", starts=1))
    answer = surae.measure_next(fit)
    assert answer.protocol is None
    assert "identified" in answer.sentences[0]
    with pytest.raises(InputError, match="no trial"):
        answer.write("next.csv")


def test_who_cannot_be_measured_so_long_is_told(weak) -> None:
    answer = surae.measure_next(weak, duration=5.0)
    assert answer.protocol is None
    assert "5 s" in answer.sentences[0]
    with pytest.raises(InputError, match="not estimated"):
        surae.measure_next(weak, wanted=["nothing"])


def test_ready_protocols_keep_the_limits_of_other_devices() -> None:
    from surae.api.expecting import ready_trajectory
    from surae.protocol import Device

    robot = Device("robot", max_velocity=1.2, max_acceleration=40.0, max_torque=60.0)
    for name in ready_protocols():
        trial = ready_trajectory(name, robot, (-0.6, 0.3), 64.0)
        assert np.abs(trial.velocity).max() <= 1.2
        assert np.abs(trial.acceleration).max() <= 40.0
        assert trial.angle.min() >= -0.6
        assert trial.angle.max() <= 0.3
