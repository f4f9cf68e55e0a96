import math

import numpy as np
import pytest

from surae.base.formatting import ends, estimate, percentage, short, significant


@pytest.mark.parametrize(
    ("value", "sem", "expected"),
    [
        (200.84, 2.52, ("200.8", "2.5", "195.9 … 205.8")),
        (0.0181497, 0.00039, ("0.01815", "3.9×10⁻⁴", "0.01739 … 0.01891")),
        (600021.1, 5812.0, ("6.000×10⁵", "5800", "(5.886 … 6.114)×10⁵")),
        (7555.0, 2187.0, ("7600", "2200", "3300 … 11800")),
        (0.058, 0.037, ("0.058", "0.037", "−0.015 … 0.13")),
        (2.0, 0.0996, ("2.00", "0.10", "1.80 … 2.20")),
        (227.0, 5000.0, ("230", "5000", "−9600 … 10000")),
        (0.9, 400.0, ("0.90", "400", "−780 … 780")),
    ],
)
def test_an_estimate_has_the_digits_of_its_standard_error(value, sem, expected):
    half = 1.96 * sem
    assert estimate(value, sem, (value - half, value + half)) == expected


@pytest.mark.parametrize(
    ("value", "ci95", "expected"),
    [
        (0.0094, (0.002, 0.044), "0.0020 … 0.044"),
        (110.0, (20.0, 600.0), "20 … 600"),
        (7.7e-4, (3.16e-7, 1.88), "3×10⁻⁷ … 1.9"),
        (110.0, (0.0034, 612.0), "0.003 … 610"),
        (2.0, (0.004, 3.9), "0.004 … 3.9"),
        (1.01, (0.77, 1.1943), "0.77 … 1.19"),
        (5.0, (5.0, 60.4), "5.0 … 60"),
        (1.0, (0.0, 2.0), "0.00 … 2.00"),
        (2e-4, (-0.2174, 0.2178), "−0.22 … 0.22"),
        (8e4, (6.1e4, 1.05e5), "61000 … 105000"),
    ],
)
def test_no_interval_is_rounded_to_nothing_or_has_more_digits_than_known(value, ci95, expected):
    assert estimate(value, (ci95[1] - ci95[0]) / 3.92, ci95).interval == expected


def test_an_end_that_is_not_nought_is_never_written_as_nought():
    rng = np.random.default_rng(3)
    for value, below, above in np.exp(rng.normal(0.0, 6.0, (2000, 3))):
        ci95 = (value / (1.0 + below), value * (1.0 + above))
        for text, end in zip(ends(value, ci95), ci95, strict=True):
            digits, _, power = text.translate(_PLAIN).partition("×10")
            assert float(digits) * 10.0 ** int(power or 0) == pytest.approx(end, rel=0.5)


_PLAIN = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")


@pytest.mark.parametrize("sem", [None, 0.0, math.inf])
def test_an_estimate_without_standard_error_has_no_interval(sem):
    ci95 = None if sem is None else (0.0, 1.0)
    assert estimate(0.0650312, sem, ci95) == ("0.06503", "—", "—")


def test_numbers_that_are_none_are_dashes():
    assert [significant(math.nan, 2), short(math.inf), percentage(math.nan)] == ["—"] * 3


def test_a_vaf_is_never_rounded_up_to_100():
    assert percentage(99.99999) == "> 99.99"
    assert percentage(100.0) == "100.00"
    assert percentage(-3.456) == "−3.46"


@pytest.mark.parametrize(
    ("value", "text"), [(2e7, "2×10⁷"), (0.002, "0.002"), (-0.9, "−0.9"), (0.0, "0"), (256, "256")]
)
def test_round_numbers_stay_round(value, text):
    assert short(value) == text
