"""Keywords that had other names are still taken, and say which is theirs now."""

import pytest

import surae


def test_a_keyword_by_its_old_name_does_the_same_and_warns() -> None:
    with pytest.warns(DeprecationWarning, match="range_of_motion is called angle_range now"):
        old = surae.Protocol(profile="sine", range_of_motion=(-0.5, 0.2))  # type: ignore[call-arg]
    assert old == surae.Protocol(profile="sine", angle_range=(-0.5, 0.2))
    with pytest.raises(surae.InputError, match="angle_range= in Python"):
        surae.plan_session(population="patient")
    with (
        pytest.warns(DeprecationWarning, match="range is called angle_range now"),
        pytest.raises(surae.InputError),  # where nothing is left to move through
    ):
        surae.plan_session(range=(0.5, 0.4))  # type: ignore[call-arg]
