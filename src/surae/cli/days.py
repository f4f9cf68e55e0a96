"""Days as people write them: in figures, or with the month's name in a language of the reports."""

import re
from datetime import date
from functools import cache

import click

from surae.base.names import LANGUAGES

_FIGURES = re.compile(r"(\d{4})[-./](\d{1,2})[-./](\d{1,2})")
#: "4 maart 2026", "4. März 2026", "1er mars 2026"; "March 4, 2026".
_DAY_FIRST = re.compile(r"(\d{1,2})(?:\.|st|nd|rd|th|er)?\s+([^\W\d]+)\.?,?\s+(\d{4})")
_MONTH_FIRST = re.compile(r"([^\W\d]+)\.?\s+(\d{1,2})(?:st|nd|rd|th)?,?\s+(\d{4})")


def day_of(text: str) -> date:
    """The day of a text; asks for one where it is empty."""
    text = text.strip()
    if not text:
        raise click.BadParameter("which day was it? Give it as 2026-03-04, or 4 March 2026")
    try:
        parts = _parts(text)
        if parts is not None:
            return date(*parts)
    except ValueError:
        raise click.BadParameter(f"{text!r} is in no calendar") from None
    raise click.BadParameter(f"{text!r} is no day; give it as 2026-03-04, or 4 March 2026")


def _parts(text: str) -> tuple[int, int, int] | None:
    """Year, month and day of a text; None where it has none."""
    if match := _FIGURES.fullmatch(text):
        year, month, day = map(int, match.groups())
        return year, month, day
    for pattern, place in ((_DAY_FIRST, 2), (_MONTH_FIRST, 1)):
        match = pattern.fullmatch(text)
        number = _months().get(match[place].casefold()) if match else None
        if match and number:
            return int(match[3]), number, int(match[3 - place])
    return None


@cache
def _months() -> dict[str, int]:
    """Numbers of the months by their names, whole and short, in every language of the reports."""
    from babel.dates import get_month_names

    return {
        name.rstrip(".").casefold(): number
        for language in LANGUAGES
        for width in ("wide", "abbreviated")
        for number, name in get_month_names(width, locale=language).items()
    }
