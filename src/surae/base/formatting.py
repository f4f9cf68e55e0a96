"""Numbers as text: as many digits as the standard error allows, powers of ten in print style."""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import NamedTuple, TypeVar

from surae.base.errors import InputError
from surae.base.normal import NORMAL, standard_error_of

T = TypeVar("T")

#: What stands for a number that there is not.
NO_NUMBER = "—"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
#: Digits beyond which a value is not written, however small its standard error.
_MOST = 9
#: Part of the wider side by which both sides of an interval may differ to be written as one.
_EVEN = 0.1


class EstimateText(NamedTuple):
    """An estimate, its standard error and its 95 % interval as text, without unit."""

    value: str
    sem: str
    interval: str


def estimate(value: float, sem: float | None, ci95: tuple[float, float] | None) -> EstimateText:
    """An estimate written to the second digit of its standard error, and its interval; see `ends`.

    A standard error far beyond the value leaves it two digits of its own: it isn't nought.
    """
    if sem is None or ci95 is None or not math.isfinite(sem) or sem <= 0:
        # Four digits at most: nothing says how many are true.
        return EstimateText(short(float(f"{value:.4g}")), NO_NUMBER, NO_NUMBER)
    first = _order(float(f"{sem:.1e}"))
    largest = _order(value or max(map(abs, ci95)))
    shift = _shift(largest)
    power = _power(shift)
    low, high = ends(value, ci95)
    interval = f"{low} … {high}"
    if power and low.endswith(power) and high.endswith(power):
        interval = f"({low.removesuffix(power)} … {high.removesuffix(power)}){power}"
    return EstimateText(
        _to_digit(value, min(first, largest) if value else first, shift),
        standard_error(sem),
        interval,
    )


def of_interval(value: float, ci95: tuple[float, float] | None) -> EstimateText:
    """An estimate of which the 95 % interval is known, or none; see `estimate`."""
    return estimate(value, None if ci95 is None else standard_error_of(ci95), ci95)


def in_a_line(name: str, value: float, ci95: tuple[float, float] | None, unit: str) -> str:
    """A named estimate with unit and interval."""
    text = of_interval(value, ci95)
    interval = "" if ci95 is None else f"({text.interval})"
    return " ".join(filter(None, (name, text.value, unit.strip("-"), interval)))


def with_half(value: float, ci95: tuple[float, float]) -> tuple[str, str]:
    """A value and what its 95 % interval is on either side, to the same digit.

    ``("0.21", "± 0.03")``, or ``("0.19", "−0.13 +0.10")`` where the sides differ.
    """
    below, above = value - ci95[0], ci95[1] - value
    if not (math.isfinite(below) and math.isfinite(above)) or min(below, above) <= 0.0:
        return estimate(value, None, None).value, f"{ends(value, ci95)[0]} … {ends(value, ci95)[1]}"
    digits = max(1 - _order(float(f"{min(below, above):.1e}")), 0)
    if min(below, above) >= 10.0 or max(abs(value), above, below) >= 1e5:
        digits = 0
    text = _fixed(value, digits)
    if abs(above - below) <= _EVEN * max(above, below):
        return text, f"± {_fixed(0.5 * (above + below), digits)}"
    return text, f"−{_fixed(below, digits)} +{_fixed(above, digits)}"


def ends(value: float, ci95: tuple[float, float]) -> tuple[str, str]:
    """Both ends of a 95 % interval, each by itself where one lies much nearer to the value.

    Each has two digits of what would be its standard error, and no more than two of its own where
    it lies farther from the value than that is large. None but nought is rounded to nought.
    """
    far = max(abs(end - value) for end in ci95)
    aways = [
        far if 3.0 * abs(end - value) > far else max(abs(end - value), far / 9.0) for end in ci95
    ]
    low, high = (_end(end, value, away) for end, away in zip(ci95, aways, strict=True))
    return low, high


def _end(end: float, value: float, away: float) -> str:
    if not math.isfinite(end):
        return NO_NUMBER
    order = _order(end)
    first = _order(float(f"{away / NORMAL:.1e}")) if away and math.isfinite(away) else order
    if away > abs(value):
        first = max(first, order)
    shift = _shift(_order(value or end))
    if end and (first > order + 1 or abs(order - _order(value)) > 1):
        first = min(first, order + 1)
        shift = _shift(order)  # one digit of its own at least
    return _to_digit(end, first, shift)


def _to_digit(number: float, first: int, shift: int) -> str:
    """A number to the digit below the power of ten `first`, times a power of ten."""
    largest = _order(number)
    step = 10.0 ** max(first - 1, 0) if shift == 0 else 1.0
    if step > 1:
        return _fixed(round(number / step) * step, 0)
    decimals = min(max(shift - first + 1, 0), max(_MOST - 1 - largest + shift, 0))
    return _fixed(number / 10.0**shift, decimals) + _power(shift)


def standard_error(sem: float | None) -> str:
    """A standard error with two digits, or a dash."""
    if sem is None or not math.isfinite(sem) or sem <= 0:
        return NO_NUMBER
    return significant(float(f"{sem:.1e}"), 2)


def significant(value: float, digits: int) -> str:
    """A number with so many significant digits; trailing zeros stay."""
    if not math.isfinite(value):
        return NO_NUMBER
    if value == 0:
        return "0"
    order = _order(float(f"{value:.{digits - 1}e}"))
    shift = _shift(order)
    return _fixed(value / 10.0**shift, max(digits - 1 - order + shift, 0)) + _power(shift)


def short(value: float) -> str:
    """A round number, such as a bound or a setting, with no more digits than it has."""
    if not math.isfinite(value):
        return NO_NUMBER
    shift = _shift(_order(value))
    return f"{value / 10.0**shift:.6g}".replace("-", "−") + _power(shift)


def percentage(vaf: float) -> str:
    """A VAF [%] with two decimals, never rounded up to 100."""
    if not math.isfinite(vaf):
        return NO_NUMBER
    return "> 99.99" if 99.99 < vaf < 100 else _fixed(vaf, 2)


def _fixed(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    return text.lstrip("-") if float(text) == 0 else text.replace("-", "−")


def _order(value: float) -> int:
    """Power of ten of the first digit."""
    return math.floor(math.log10(abs(value))) if value else 0


def _shift(order: int) -> int:
    """Power of ten that is written out; 0 for numbers that read well without."""
    return order if order >= 5 or order < -3 else 0


def _power(shift: int) -> str:
    return f"×10{str(shift).translate(_SUPERSCRIPT)}" if shift else ""


def signed(value: float, decimals: int) -> str:
    """A number with so many decimals, zero without a sign."""
    return _fixed(value, decimals) if math.isfinite(value) else NO_NUMBER


def probability(value: float) -> str:
    """A probability in percent that never claims to be certain, either way."""
    if not 0.01 <= value <= 0.99:
        return "< 1 %" if value < 0.01 else "> 99 %"
    return f"{100 * value:.0f} %"


def part(value: float | None) -> str:
    """A part in percent, to two digits."""
    if value is None:
        return NO_NUMBER
    return f"{100 * value:.2g} %" if value < 0.995 else f"{100 * value:.0f} %"


def chance(p_value: float) -> str:
    """A probability of a test, ``"p = 0.031"`` or ``"p < 0.001"``."""
    if not math.isfinite(p_value):
        return f"p = {NO_NUMBER}"
    return "p < 0.001" if p_value < 1e-3 else f"p = {p_value:.2g}"


def listed(words: Sequence[str], last: str = "and") -> str:
    """Words as a sentence has them: ``a, b and c``."""
    *others, end = words
    return f"{', '.join(others)} {last} {end}" if others else end


def nearest(name: str, known: Iterable[str]) -> str:
    """The known name that a misspelt one is nearest to, as the end of a sentence; or nothing."""
    from difflib import get_close_matches

    near = get_close_matches(name.lower(), known, n=1, cutoff=0.6)
    return f" (did you mean {near[0]!r}?)" if near else ""


def check_known(what: str, known: Collection[str], name: object) -> None:
    """Refuse a word that is none of those that are known, and say which is the nearest."""
    if name not in known:
        near = nearest(str(name), known)
        raise InputError(f"{what} {name!r} is not known{near}; use one of: {', '.join(known)}")


def named(what: str, known: Mapping[str, T], name: str) -> T:
    """What has that name; another one is refused as by `check_known`."""
    check_known(what, known, name)
    return known[name]
