"""Two relaxed curves laid upon each other: what of a change is the mounting's, and what is not."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import surae
from relaxed_ankle import Ankle, measured
from surae.inference.relaxed.aligned import (
    SHIFTS,
    SIZES,
    Alignment,
    Remounting,
    aligned,
    laid_pairs,
    quantiles_of,
)
from surae.inference.relaxed.pair import paired_legs
from surae.measures.relaxed_change import SIZE, rest_change

ENDS = np.array([0.025, 0.975])
TURNED = Remounting(2.1)


@dataclass(frozen=True)
class Exponential(Ankle):
    """Tissue of one exponential, turned on the device, and none that works against it."""

    turned: float = 0.0

    def torque(self, degrees):
        return 8.0 * np.exp((degrees - self.turned - 20.0) / 12.0) * self.stiff / 0.25


def curve_of(ankle, seed=0):
    return surae.relaxed(measured(ankle, seed)).curve


@pytest.fixture(scope="module")
def toe():
    return curve_of(Ankle())


def laid(before, after):
    made = aligned(before, after, paired_legs(before, after))
    assert made is not None
    return made


def test_a_toe_tells_shift_and_size_apart(toe) -> None:
    turned = laid(toe, curve_of(Ankle(toe=-12.0, zero=1.0), 1))
    low, high = quantiles_of(SHIFTS, turned.shifts(), ENDS)
    assert low < 3.0 < high
    assert high - low < 4.0
    low, high = np.exp(quantiles_of(SIZES, turned.sizes(TURNED), ENDS))
    assert low < 1.0 < high
    softer = laid(toe, curve_of(Ankle(stiff=0.7 * 0.25), 2))
    low, high = np.exp(quantiles_of(SIZES, softer.sizes(TURNED), ENDS))
    assert low < 0.7 < high < 1.0


def test_one_exponential_that_is_turned_is_not_called_larger() -> None:
    """Turned by 3° it looks a quarter smaller, and nothing in its curve says which it is."""
    before = curve_of(Exponential())
    for seed, turned in enumerate((-3.0, 3.0)):
        after = curve_of(Exponential(turned=turned, zero=-1.0), seed + 1)
        d = rest_change(before, after, (10.0,)).differences[SIZE]
        assert d.ci95[0] < 0.0 < d.ci95[1]
        assert abs(d.difference) / d.sd < 1.96


def test_curves_of_two_forms_have_neither_size_nor_shift(toe) -> None:
    other = curve_of(replace(Exponential(), stiff=0.5), 3)
    made = laid(toe, other)
    assert not made.is_one_form
    prior = np.exp(-0.5 * (SHIFTS / TURNED.sd) ** 2)
    assert made.mountings(TURNED) == pytest.approx(prior / prior.sum())
    d = rest_change(toe, other, (10.0,)).differences[SIZE]
    assert d.difference is None
    assert "differ in form" in d.missing


def test_a_mounting_is_what_is_expected_where_curves_tell_nothing() -> None:
    flat = Alignment(np.ones((len(SHIFTS), len(SIZES))), True)
    prior = np.exp(-0.5 * (SHIFTS / TURNED.sd) ** 2)
    # beyond the grid's ends nothing is tried of what a leg may have been shifted by
    assert flat.mountings(TURNED) == pytest.approx(prior / prior.sum(), abs=0.01)


def test_a_shift_that_is_known_is_the_mountings_or_the_legs() -> None:
    """By hand: N(m; 0, s²)·(P(not shifted)·1[m = δ] + P(shifted)·N(δ − m; 0, 4²))."""
    sharp = np.zeros((len(SHIFTS), len(SIZES)))
    at = int(np.argmin(np.abs(SHIFTS - 2.0)))
    one = len(SIZES) // 2
    sharp[at, one] = 1.0
    size = np.exp(-0.5 * (SIZES / 0.35) ** 2)
    size = size[one] / size.sum()
    slack = np.exp(-0.5 * ((2.0 - SHIFTS) / 4.0) ** 2)
    slack /= np.exp(-0.5 * (SHIFTS / 4.0) ** 2).sum()
    wanted = (0.25 + 0.1 * size) * slack
    wanted[at] += 0.4 + 0.25 * size
    wanted *= np.exp(-0.5 * (SHIFTS / TURNED.sd) ** 2)
    told = Alignment(sharp, True).mountings(TURNED)
    assert told == pytest.approx(wanted / wanted.sum(), rel=0.01)


def test_pairs_are_laid_as_the_curves_tell_and_keep_what_is_known_of_the_zero(toe) -> None:
    after = curve_of(Ankle(toe=-12.0), 1)
    pairs, alignment = laid_pairs(toe, after)
    apart = pairs.after.zero - pairs.before.zero
    density = alignment.mountings(Remounting(np.hypot(1.5, 1.5)))
    assert np.median(apart) == pytest.approx(
        quantiles_of(SHIFTS, density, np.array([0.5]))[0], abs=0.1
    )
    assert np.std(pairs.before.zero) == pytest.approx(toe.zero_sd, rel=0.15)
    still, _ = laid_pairs(toe, after, remounted=0.0)
    assert np.ptp(still.after.zero - still.before.zero) == pytest.approx(0.0, abs=1e-9)


def test_too_short_an_overlap_tells_nothing(toe) -> None:
    short = replace(toe, low=10.0)
    assert aligned(short, toe, paired_legs(toe, toe)) is None


def test_zeros_that_were_stated_of_both_visits_are_taken_off(toe) -> None:
    """The second mounting is turned by 3° and says so: the same ankle angles are compared."""
    turned = curve_of(Ankle(toe=-12.0, zero=1.0), 1)
    stated = [
        replace(curve, zero_deg=zero, zero_sd=0.5) for curve, zero in ((toe, 0.0), (turned, -3.0))
    ]
    known = rest_change(*stated, (10.0,)).differences
    for name in ("torque_rise", "slow_stiffness@10deg", "end_torque"):
        assert known[name].ci95[0] < 0.0 < known[name].ci95[1]
    unknown = rest_change(toe, turned, (10.0,)).differences
    assert np.ptp(known["torque_rise"].ci95) < np.ptp(unknown["torque_rise"].ci95)
    assert Remounting.of(*stated, 1.5) == Remounting(pytest.approx(np.hypot(0.5, 0.5)), 3.0)
