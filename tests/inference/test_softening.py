"""Tissue that softens within a trial is told by its first stretches and its last."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.frozen import read_only
from surae.inference import Grade, fit_problem, make_problem
from surae.inference.adequacy import judge_adequacy
from surae.inference.softening import softening
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial


@pytest.fixture(scope="module")
def trial():
    motion = generate(Protocol(profile="multi-sine", duration=30.0, rate_hz=64.0))
    return virtual_trial(virtual_subject(2), motion)


def fitted(trial, share: float, seed: int = 1, of: str = "tissue"):
    """The fit of a trial in which so much of a part of the torque comes on top at first."""
    stretches = np.cumsum(np.abs(np.gradient(trial.angle))) / (2.0 * np.ptp(trial.angle))
    plain = fit_problem(make_problem([trial], "muscle"), starts=1)
    spec, options = plain.problem.spec, plain.problem.options
    parts = spec.simulator(trial, options).parts(spec.vector(plain.values, options))
    noise = 0.03 * np.std(trial.torque) * np.random.default_rng(seed).standard_normal(trial.n)
    torque = trial.torque + share * np.exp(-stretches / 2.0) * getattr(parts, of) + noise
    softer = replace(trial, torque=read_only(torque))
    return fit_problem(make_problem([softer], "muscle"), starts=1)


def test_a_leg_that_softens_is_told_and_one_that_does_not_is_not(trial) -> None:
    (steady,), (soft,) = (softening(fitted(trial, share)) for share in (0.0, 0.4))
    assert not steady.is_seen
    assert soft.is_seen
    assert 0.1 < soft.size < 0.6
    (stiffer,) = softening(fitted(trial, -0.3))  # becoming stiffer is no softening
    assert not stiffer.is_seen


def test_muscles_that_were_weaker_at_first_are_no_softening(trial) -> None:
    (steady,) = softening(fitted(trial, -0.3, of="neural"))
    assert not steady.is_seen


def test_such_a_fit_is_doubtful_and_says_why(trial) -> None:
    judged = judge_adequacy(fitted(trial, 0.4))
    assert judged.grade is not Grade.ADEQUATE
    assert any("softened within the trial" in reason for reason in judged.reasons)
    assert not any("softened" in reason for reason in judge_adequacy(fitted(trial, 0.0)).reasons)


def test_a_trial_of_few_stretches_does_not_tell(trial) -> None:
    short = replace(
        trial,
        angle=read_only(np.linspace(-0.4, 0.2, trial.n)),
        velocity=read_only(np.full(trial.n, 0.6 * trial.rate_hz / trial.n)),
        acceleration=read_only(np.zeros(trial.n)),
    )
    assert softening(fit_problem(make_problem([short], "muscle"), starts=1)) == ()
