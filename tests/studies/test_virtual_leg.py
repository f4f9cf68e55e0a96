"""What a leg does: reflex, misalignment, knee and effort follow their stated models."""

from dataclasses import replace

import numpy as np
import pytest

from surae.model import ModelOptions, get_model
from surae.model.geometry import moment_arm, paths
from surae.protocol import Protocol, generate
from surae.studies import Imperfections, virtual_subject, virtual_trial
from surae.studies.leg import (
    EMG_FULL,
    EMG_REST,
    KNEE_ARM,
    KNEE_TISSUE,
    VirtualTrial,
    knee_torque,
    misaligned,
    reflex,
)

SUBJECT = virtual_subject(2)
OPTIONS = ModelOptions()


@pytest.fixture(scope="module")
def trajectory():
    return generate(Protocol(profile="multi-sine", rate_hz=128.0))


@pytest.fixture(scope="module")
def ideal(trajectory):
    return virtual_trial(SUBJECT, trajectory, noise=0.0)


def test_the_reflex_is_delayed_rectified_above_a_threshold_and_limited():
    t = np.arange(0.0, 4.0, 0.001)
    stretch = 2.0 * np.sin(2 * np.pi * t)
    reflexes = reflex(t, stretch, 0.5)
    delayed = np.where(t < 0.042, 0.0, 2.0 * np.sin(2 * np.pi * (t - 0.042)))
    expected = np.clip(0.5 * (delayed - 0.1), 0.0, 0.5)
    np.testing.assert_allclose(reflexes, expected, atol=1e-3)
    assert reflexes.max() == 0.5
    assert (reflexes[(t > 0.55) & (t < 1.04)] == 0.0).all()  # while the muscle shortens


def test_the_reflex_is_in_the_triceps_emg_and_drives_the_torque(trajectory, ideal):
    settings = Imperfections(reflex_gain=0.2)
    trial = virtual_trial(SUBJECT, trajectory, noise=0.0, imperfections=settings)
    tri, _ = paths(angle=trajectory.angle, velocity=trajectory.velocity, options=OPTIONS)
    added = reflex(trajectory.time, tri.speed / SUBJECT.parameters["l0_tri"], 0.2)
    assert 0.05 < added.max() < 0.5
    np.testing.assert_array_equal(trial.emg[:, 0], ideal.emg[:, 0])
    for head in (1, 2, 3):
        more = (trial.emg[:, head] - ideal.emg[:, head]) / (6e-4 - 1e-6)
        np.testing.assert_allclose(more, added, atol=1e-12)
    # Its EMG explains its torque: nothing is left for a fit to stumble over.
    spec = get_model("muscle")
    torque = spec.simulator(trial, OPTIONS).torque(spec.vector(SUBJECT.parameters, OPTIONS))
    np.testing.assert_allclose(trial.torque, torque, atol=1e-9)
    assert np.abs(trial.torque - ideal.torque).max() > 1.0


@pytest.mark.parametrize("where", [(0.01, 0.0), (0.0, 0.01), (-0.012, 0.007)])
def test_a_misaligned_ankle_turns_as_geometry_says(where):
    t = np.arange(0.0, 10.0, 0.001)
    angle, velocity = 0.7 * np.sin(t), 0.7 * np.cos(t)
    (ankle, speed, speeding), factor = misaligned((angle, velocity, -angle), *where)
    strap = 0.15 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    foot = strap - np.array(where)
    neutral = np.array([0.15, 0.0]) - np.array(where)
    cross = neutral[0] * foot[:, 1] - neutral[1] * foot[:, 0]
    np.testing.assert_allclose(ankle, np.arctan2(cross, foot @ neutral), atol=1e-12)
    # Both derivatives, by differences.
    np.testing.assert_allclose(speed[1:-1], (ankle[2:] - ankle[:-2]) / 0.002, atol=1e-6)
    np.testing.assert_allclose(speeding[1:-1], (speed[2:] - speed[:-2]) / 0.002, atol=1e-6)
    np.testing.assert_allclose(speed, factor * velocity, atol=1e-12)


def test_misalignment_does_no_work_of_its_own(trajectory):
    settings = Imperfections(axis_forward=0.008, axis_up=-0.005)
    trial = virtual_trial(SUBJECT, trajectory, noise=0.0, imperfections=settings)
    np.testing.assert_array_equal(trial.angle, trajectory.angle)  # what the device measures
    plate = (trajectory.angle, trajectory.velocity, trajectory.acceleration)
    (angle, velocity, acceleration), _ = misaligned(plate, 0.008, -0.005)
    spec = get_model("muscle")
    moved = replace(trial, angle=angle, velocity=velocity, acceleration=acceleration)
    torque = spec.simulator(moved, OPTIONS).torque(spec.vector(SUBJECT.parameters, OPTIONS))
    np.testing.assert_allclose(trial.torque * trial.velocity, torque * velocity, atol=1e-9)


def test_knee_flexion_acts_on_the_gastrocnemius_as_its_model_says(trajectory, ideal):
    # A constant flexion: force of gastrocnemius at the plantarflexed angle, arm as it was.
    spec = get_model("muscle")
    values = spec.vector(SUBJECT.parameters, OPTIONS)
    flexion = np.full(ideal.n, 0.1)
    torque = knee_torque(ideal, "muscle", OPTIONS, values, flexion)
    arm = moment_arm(ideal.angle, 0)
    shift = -0.1 * KNEE_ARM / arm
    p = dict(zip(spec.names, values, strict=True))
    x, moved = 0.118 - 1.67 * arm, 0.118 - 1.67 * moment_arm(ideal.angle + shift, 0)
    passive = np.exp(p["k_tri"] * (moved - p["x0_tri"])) - np.exp(p["k_tri"] * (x - p["x0_tri"]))
    start = ideal.time < 0.9  # at rest: the tissue has relaxed, the muscles are passive
    steady = KNEE_TISSUE * passive / (1.0 + p["k_rel"]) * arm
    # Muscles at rest have an EMG of 1 µV, not of zero: a few mN·m.
    assert torque[start] == pytest.approx(steady[start], abs=0.01)
    assert torque.max() < 0.05  # slackened: less torque, but on the descending limb
    assert torque.min() < -0.3
    zero = knee_torque(ideal, "muscle", OPTIONS, values, np.zeros(ideal.n))
    assert (zero == 0.0).all()


def test_knee_flexion_leaves_a_leg_without_gastrocnemius_activity_its_active_torque(trajectory):
    silent = virtual_trial(SUBJECT, trajectory, noise=0.0)
    spec = get_model("muscle")
    parameters = dict(SUBJECT.parameters) | {"g2": 0.0, "g4": 0.0, "k_tri": 1e-3, "x0_tri": 1e-3}
    values = spec.vector(parameters, OPTIONS)
    torque = knee_torque(silent, "muscle", OPTIONS, values, np.full(silent.n, 0.2))
    assert np.abs(torque).max() < 1e-5


def test_knee_motion_has_its_size(trajectory, ideal):
    small, large = (
        virtual_trial(
            SUBJECT, trajectory, noise=0.0, imperfections=Imperfections(knee_motion=size)
        ).torque
        - ideal.torque
        for size in (0.01, 0.02)
    )
    assert large.std() == pytest.approx(2 * small.std(), rel=0.05)
    assert np.corrcoef(small, large)[0, 1] > 0.99


def test_effort_varies_about_its_target_by_as_much_as_asked(trajectory):
    settings = Imperfections(effort_variation=0.25)
    active = trajectory.effort > 0.05

    def effort(seed, trial):
        envelopes, _ = VirtualTrial(virtual_subject(seed), trajectory, settings, trial).simulated(
            "muscle", OPTIONS
        )
        return (envelopes - EMG_REST) / (EMG_FULL - EMG_REST)

    efforts = [effort(seed, trial) for seed in range(30) for trial in range(3)]
    gains = np.concatenate([done[active] / trajectory.effort[active] for done in efforts])
    assert gains.mean() == pytest.approx(1.0, abs=0.02)
    assert gains.std() == pytest.approx(0.25, abs=0.02)
    assert gains.min() > 0.0
    assert (efforts[0][trajectory.effort == 0.0] == 0.0).all()


def test_effort_differs_between_repetitions_and_is_seen_in_emg(trajectory, ideal):
    settings = Imperfections(effort_variation=0.25)
    first, two = (
        virtual_trial(SUBJECT, trajectory, noise=0.0, seed=seed, imperfections=settings)
        for seed in (0, 1)
    )
    for a, b in ((first, two), (first, ideal)):
        assert np.abs(a.emg - b.emg).max() > 2e-5
        assert np.abs(a.torque - b.torque).max() > 1.0
    spec = get_model("muscle")
    torque = spec.simulator(first, OPTIONS).torque(spec.vector(SUBJECT.parameters, OPTIONS))
    np.testing.assert_allclose(first.torque, torque, atol=1e-9)
