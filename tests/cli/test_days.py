"""Days as people write them."""

from datetime import date

import click
import pytest

from surae.cli.days import day_of


@pytest.mark.parametrize(
    "text",
    [
        *("2026-03-04", "2026/3/4", "4 maart 2026", "4 mrt 2026", "4. März 2026", "4 mars 2026"),
        *("March 4, 2026", "4th March 2026", "Mar 4 2026", " 4 MAART 2026 "),
    ],
)
def test_a_day_is_read_in_every_language_of_the_reports(text) -> None:
    assert day_of(text) == date(2026, 3, 4)


def test_months_of_all_four_languages() -> None:
    told = [day_of(text) for text in ("1er août 2025", "1. Dezember 2025")]
    assert told == [date(2025, 8, 1), date(2025, 12, 1)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "which day was it"),
        ("  ", "which day was it"),
        ("last spring", "is no day"),
        ("04-03-2026", "is no day"),  # the fourth of March, or the third of April
        ("31 February 2026", "in no calendar"),
        ("4 thermidor 2026", "is no day"),
    ],
)
def test_what_is_no_day_is_asked_for(text, said) -> None:
    with pytest.raises(click.BadParameter, match=said):
        day_of(text)
