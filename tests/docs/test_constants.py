"""Every number that judges says what it decides, in one table for each room."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "docs" / "_ext"))

import constants


def test_every_number_of_a_room_that_judges_says_what_it_decides() -> None:
    for room in constants.ROOMS:
        rows = constants.constants(room)
        assert len(rows) >= 5, room
        assert [(module, names) for module, names, _, about in rows if len(about) < 10] == []


def test_a_room_is_one_table_with_values_as_the_program_has_them() -> None:
    table = constants.table("inference")
    assert "| judging/of_fit | `_NOT_FOLLOWED` | `80.0` | Centred R² [%] below" in table
    assert "Kass and Raftery 1995" in table
    heads = [line for line in constants.tables().splitlines() if line.startswith("## ")]
    assert len(heads) == len(constants.ROOMS)
