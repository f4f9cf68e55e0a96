"""The foot's mass from the body's."""

from dataclasses import replace

import pytest

from surae.errors import InputError
from surae.model.anthropometry import FOOT_SHARE, foot_mass, with_foot_mass


def test_the_shares_are_those_of_the_tables() -> None:
    assert FOOT_SHARE == {"winter": 0.0145, "de-leva-female": 0.0129, "de-leva-male": 0.0137}
    assert foot_mass(80.0) == pytest.approx(1.16)
    assert foot_mass(60.0, 0.9, table="de-leva-female") == pytest.approx(0.0129 * 60 + 0.9)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ((70_000.0,), "whole body, 5 to 400 kg"),
        ((-1.0,), "whole body"),
        ((float("nan"),), "whole body"),
        ((70.0, -0.1), "footplate mass -0.1"),
        ((70.0, 1000.0), "give 0 to 20 kg"),
    ],
)
def test_masses_that_are_none(given, says) -> None:
    with pytest.raises(InputError, match=says):
        foot_mass(*given)


def test_a_table_unknown() -> None:
    with pytest.raises(InputError, match="known tables: winter, de-leva-female, de-leva-male"):
        foot_mass(70.0, table="dempster")


def test_recordings_prescribe_the_mass_and_say_why(make_inputs) -> None:
    trial = make_inputs()
    first, second = with_foot_mass([trial, replace(trial, fixed={"beta": 1.0})], 70.0, 1.0)
    assert first.fixed == {"m": pytest.approx(2.015)}
    assert second.fixed == {"beta": 1.0, "m": pytest.approx(2.015)}
    assert first.steps[-1] == (
        "Mass m fixed at 2.015 kg: 1.45 % of 70 kg body mass (Winter 2009) and 1 kg footplate."
    )
    with pytest.raises(InputError, match="prescribes m = 0 kg itself"):
        with_foot_mass([replace(trial, fixed={"m": 0.0})], 70.0)
