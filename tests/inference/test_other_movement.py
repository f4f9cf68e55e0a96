"""A prediction of a family beside its simplest member: what widens it, and what is averaged."""

from dataclasses import replace

import numpy as np
import pytest

from surae import fit, load, validate
from surae.inference import Prediction
from surae.inference.judging.baselines import OWN, Baselines
from surae.inference.judging.other_movement import beside_simplest, moves_otherwise
from surae.protocol import Protocol, generate
from surae.report.beside import beside, follows, of_movement
from surae.studies import virtual_subject, virtual_trial


def trial(profile: str = "multiple-holds", seed: int = 1):
    protocol = Protocol(profile=profile, rate_hz=64.0, task="active", duration=20.0)
    return virtual_trial(virtual_subject(seed=3), generate(protocol), seed=seed)


@pytest.fixture(scope="module")
def family():
    """A fit of inverse dynamics: the mass is taken out."""
    return fit(trial(), "auto", fixed={"m": 0.0})


def test_another_movement_is_told_from_another_trial_of_the_same() -> None:
    first, again, other = trial(), trial(seed=2), trial("sine")
    assert not moves_otherwise([first], again)
    assert moves_otherwise([first], other)
    assert not moves_otherwise([first, other], other)


def test_both_are_averaged_of_inverse_dynamics_that_is_not_adequate_alone(family) -> None:
    other = trial("sine")
    own = family.predict(trial(seed=2)).torque
    simulator = family.result.problem.spec.simulator(other, family.result.problem.options)
    plain = simulator.torque(
        family.result.problem.spec.vector(family.values, family.result.problem.options)
    )
    averaged = beside_simplest(family.result, other, plain, adequate=False)
    assert averaged is not None
    assert 0.0 < averaged.share < 1.0
    np.testing.assert_allclose(
        averaged.torque, (1.0 - averaged.share) * plain + averaged.share * averaged.simplest
    )
    alone = beside_simplest(family.result, other, plain, adequate=True)
    assert alone is not None
    np.testing.assert_array_equal(alone.torque, plain)
    assert np.abs(alone.row).max() > np.abs(averaged.row).max()  # the interval is wider instead
    same = beside_simplest(family.result, trial(seed=2), own, adequate=False)
    assert same is not None
    assert same.share == 0.0
    problem = replace(family.result.problem, settings=replace(family.settings, fixed={}))
    device = replace(family.result, problem=problem)
    measured = beside_simplest(device, other, plain, adequate=False)
    assert measured is not None
    assert measured.share == 0.0


def test_the_interval_is_wider_by_how_far_both_are_apart(family) -> None:
    other = trial("sine")
    of_before = replace(family.result.solution, simplest={})
    before = replace(family, result=replace(family.result, solution=of_before))
    wider, narrower = family.predict(other), before.predict(other)
    assert wider.doubt.half_width.mean() > narrower.doubt.half_width.mean()
    assert wider.simplest_vaf is not None
    assert narrower.simplest_vaf is None


def test_a_file_keeps_the_simplest_member(family, tmp_path) -> None:
    family.save(tmp_path / "fit.json")
    again = load(tmp_path / "fit.json")
    assert dict(again.result.posterior.simplest) == dict(family.result.posterior.simplest)


def made(vaf: float, baselines: Baselines, **more) -> Prediction:
    still = np.zeros(3)
    return Prediction(
        "a trial", None, vaf, 1.0, 0.0, still, still, still, baselines=baselines, **more
    )


def test_what_follows_is_said_of_what_was_compared_alone() -> None:
    worse = made(97.0, Baselines(99.0, 96.0))
    better = made(99.0, Baselines(90.0, 96.0))
    alone = made(99.0, Baselines(template_reason="none", ridge_reason="none"))
    assert "no evidence of the parameters" in follows([worse])
    assert "no evidence" not in follows([better])
    assert "The model is better" in beside(better)
    assert "Of 'a trial'" in follows([worse, better])
    assert follows([alone]) == ""
    assert "none, as none" in beside(alone)
    assert beside(made(99.0, Baselines(template_reason=OWN, ridge_reason=OWN))) == ""
    assert of_movement([better]) == ""
    assert "43 %" in of_movement([made(90.0, Baselines(), simplest=0.43)])


def test_of_measured_strides_the_default_does_not_lose_to_its_simplest_member(shared) -> None:
    """Nor do they hide that the mean of another stride is as good."""
    strides = [str(shared / "strides" / f"adult_{n:02d}.csv") for n in (0, 2, 7)]
    family = fit(strides[0], "auto")
    for prediction in validate(family, strides[1:]):
        assert prediction.vaf > prediction.simplest_vaf - 0.5
        assert prediction.baselines.template > 98.0
        assert "no evidence of the parameters" in beside(prediction)
