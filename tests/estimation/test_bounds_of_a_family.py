"""What rests beside a bound lies at it."""

from types import SimpleNamespace

import numpy as np
import pytest

from surae.estimation.summed import _to_bounds


@pytest.mark.parametrize(
    ("value", "deviation", "expected"),
    [
        (0.0005, 0.2, 0.0),  # the bound holds it
        (0.0005, 0.001, 0.0005),  # data tell it from the bound
        (0.15, 2.0, 0.15),  # nothing holds it, and far away
        (0.9995, 0.2, 1.0),
    ],
)
def test_what_data_cannot_tell_from_a_bound_lies_at_it(value, deviation, expected):
    for name, moves in (("l0_tib", True), ("torque_zero", False)):
        target = SimpleNamespace(names=(name,), lower=np.zeros(1), upper=np.ones(1))
        member = SimpleNamespace(target=target, covariance=lambda: np.array([[deviation**2]]))
        there = _to_bounds(member, np.array([value]))
        assert there.tolist() == [expected if moves else value]
