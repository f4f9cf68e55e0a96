from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from surae.assessment.comparison.held_out import (
    BLOCKS,
    GUARD_S,
    folds,
    held_out,
    prediction_error,
    without,
)
from surae.errors import InputError
from surae.estimation import fit_problem, make_problem


def test_blocks_partition_the_samples(noisy) -> None:
    parts = folds([noisy])
    assert len(parts) == BLOCKS
    assert_array_equal(np.concatenate([part.samples for part in parts]), np.arange(noisy.n))
    for part in parts:
        assert_array_equal(np.diff(part.samples), 1)
        assert part.held is noisy


def test_a_block_and_its_guards_have_no_weight_in_its_fit(noisy) -> None:
    guard = int(GUARD_S * noisy.rate_hz)
    for part in folds([noisy]):
        (training,) = part.training
        first, last = part.samples[0] - guard, part.samples[-1] + guard
        expected = np.ones(noisy.n)
        expected[max(first, 0) : last + 1] = 0
        assert_array_equal(training.weight, expected)
        assert not training.weight.flags.writeable
        assert_array_equal(training.torque, noisy.torque)


def test_guards_of_short_blocks_are_short(noisy) -> None:
    short = replace(
        noisy,
        **{name: getattr(noisy, name)[:100] for name in
           ("time", "angle", "velocity", "acceleration", "emg", "torque")},
    )  # fmt: skip
    (training,) = folds([short])[1].training
    assert_array_equal(np.flatnonzero(training.weight == 0), np.arange(25 - 2, 50 + 2))


def test_blocks_partition_the_samples_that_count(noisy) -> None:
    weight = np.ones(noisy.n)
    weight[:1000] = 0.0
    weight[2000:2500] = 0.5
    weight[3000:3100] = 0.0
    parts = folds([replace(noisy, weight=weight)])
    assert_array_equal(np.concatenate([p.samples for p in parts]), np.flatnonzero(weight))
    for part in parts:
        (training,) = part.training
        assert training.weight[part.samples].max() == 0
        kept = training.weight > 0
        assert_array_equal(training.weight[kept], weight[kept])


def test_several_recordings_are_left_out_one_by_one(noisy, clean) -> None:
    first, second = folds([noisy, clean])
    assert (first.held, first.training) == (noisy, (clean,))
    assert (second.held, second.training) == (clean, (noisy,))
    assert_array_equal(first.samples, np.arange(noisy.n))


def test_a_fit_does_not_see_the_torque_of_its_block(noisy) -> None:
    """Whatever the left-out torque is, the fit and its prediction are the same."""
    problem = make_problem([noisy])
    found = fit_problem(problem, starts=1)
    part = folds([noisy])[2]
    torque = noisy.torque.copy()
    torque[part.samples] = 1e3
    other = folds([replace(noisy, torque=torque)])[2]
    one = fit_problem(without(problem, part, found), starts=1)
    two = fit_problem(without(problem, other, found), starts=1)
    assert one.values == two.values
    assert_allclose(
        prediction_error(one, part) - prediction_error(two, other),
        (noisy.torque - torque)[part.samples],
    )


def test_too_little_is_left_for_the_parameters(noisy) -> None:
    weight = np.zeros(noisy.n)
    weight[:18] = 1.0
    one = replace(noisy, weight=weight)
    problem = make_problem([one])
    found = fit_problem(make_problem([noisy]), starts=1)
    with pytest.raises(InputError, match=r"block 1 of 4.* cannot determine 15 parameters"):
        without(problem, folds([one])[0], found)
    with pytest.raises(InputError, match="too few samples"):
        folds([replace(noisy, weight=np.where(np.arange(noisy.n) < 3, 1.0, 0.0))])


def test_score_by_hand() -> None:
    score = held_out(missed=[1.0, 3.0], of_rigid=[2.0, 6.0], total=[100.0, 100.0])
    assert score.folds == pytest.approx((99.0, 97.0))
    assert score.vaf == pytest.approx(98.0)
    assert score.spread == pytest.approx(np.sqrt(2))
    assert score.gain == pytest.approx(2.0)  # 0.5 % and 1.5 % of all
    assert score.gain_se == pytest.approx(1.0)  # √2 · std(0.5, 1.5)


def test_a_fold_that_is_hard_for_every_model_does_not_blur_the_gain() -> None:
    score = held_out(missed=[1.0, 50.0], of_rigid=[2.0, 51.0], total=[100.0, 100.0])
    assert score.gain_se == pytest.approx(0.0)
    assert score.spread > 10


@pytest.mark.parametrize(
    ("missed", "total"), [([np.inf, 1.0], [9.0, 9.0]), ([1.0, 1.0], [9.0, 0.0])]
)
def test_no_score(missed, total) -> None:
    assert held_out(missed, [1.0, 1.0], total) is None
