"""What a protocol will tell of a measure, and of a change in it."""

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.measures import measures_of_values
from surae.planning.legs import population_legs
from surae.planning.search import make_aim


@pytest.fixture(scope="module")
def expected():
    return surae.expect("multi-sine", legs=3)


def test_every_measure_of_the_relaxed_ankle_is_expected(expected) -> None:
    for name in ("torque_rise", "end_stiffness", "passive_stiffness@10deg"):
        told = expected.measures[name]
        assert told.relative_sem is not None
        assert told.would_show is not None
        assert 0.0 < told.relative_sem < 2.0
        # two visits share what a value is unsure by: no more than of two legs
        assert told.would_show < 2.8 * 2.0**0.5 * told.relative_sem
    assert "two such visits would show a change of" in str(expected.as_table())


def test_a_change_is_aimed_at_and_an_unknown_one_is_refused() -> None:
    legs = population_legs("muscle", "healthy", 2)
    plain, change = (
        make_aim(name, legs, (-30.0, 20.0)) for name in ("torque_rise", "change in torque_rise")
    )
    assert (plain.slopes == change.slopes).all()
    assert change.anew is not None
    assert (change.anew > 0.0).all()
    assert plain.anew is not None
    assert (plain.anew == 0.0).all()
    with pytest.raises(InputError, match="no such parameter or measure"):
        make_aim("change in torque_ris", legs, (-30.0, 20.0))


@pytest.mark.parametrize("name", ["curve_size", "hysteresis", "change in maximal_torque_tri"])
def test_what_only_a_recording_tells_is_refused_as_such(name) -> None:
    legs = population_legs("muscle", "healthy", 1)
    with pytest.raises(InputError, match="it is read from recordings"):
        make_aim(name, legs, (-30.0, 20.0))


def test_slopes_of_a_rise_are_those_of_the_torques_it_is_made_of() -> None:
    legs = population_legs("muscle", "healthy", 1)
    high, low, rise = (
        make_aim(name, legs, (-30.0, 20.0)).slopes[0, 0]
        for name in ("passive_torque@20deg", "passive_torque@-30deg", "torque_rise")
    )
    values = dict(zip(legs.spec.names, legs.values[0].tolist(), strict=True))
    told = measures_of_values(
        {n: values[n] for n in legs.leg_parameters}, "muscle", angles=[-30.0, 20.0]
    )
    top, bottom = told["passive_torque@20deg"], told["passive_torque@-30deg"]
    assert rise == pytest.approx((top * high - bottom * low) / (top - bottom), rel=1e-4, abs=1e-6)


def test_a_foot_that_is_held_still_has_no_range_and_is_no_error() -> None:
    legs = population_legs("muscle", "healthy", 1)
    names = ("end_torque", "torque_rise", "end_stiffness")
    told = {name: np.isfinite(make_aim(name, legs, (5.0, 5.0)).slopes).all() for name in names}
    assert told == {"end_torque": True, "torque_rise": False, "end_stiffness": False}
