"""Norms: whose numbers they are, and when a leg is held against them."""

from dataclasses import replace

import pytest
from scipy import stats

from surae.base.errors import InputError
from surae.base.frozen import FrozenDict
from surae.inference import Adequacy, Grade, Verdict
from surae.inference.judging.reasons import against
from surae.measures import DEFINITIONS, Measure, Measures
from surae.measures.norms import placed, read_norms

STIFF = Measure(
    "slow_torque@10deg", "Nm", "…", 9.85, (9.75, 9.95), (9.75, 9.95), Verdict.IDENTIFIED, ""
)
FINE = Adequacy(Grade.ADEQUATE, (), 99.0)


def measures(measure: Measure = STIFF, adequacy: Adequacy = FINE) -> Measures:
    return Measures("muscle", adequacy, FrozenDict({measure.name: measure}))


def test_our_norms_are_of_measures_that_exist_and_say_their_source() -> None:
    known = {(d.name, d.unit) for d in DEFINITIONS}
    for norm in read_norms():
        assert (norm.measure.split("@")[0], norm.unit) in known
        assert "(20" in norm.reference


def test_a_leg_is_given_a_place_and_no_flag() -> None:
    healthy = next(p for p in placed(measures(), read_norms()) if p.norm.group == "healthy adults")
    expected = stats.t(31).cdf((9.85 - 6.21) / (3.64 * (1 + 1 / 32) ** 0.5))
    assert healthy.below == pytest.approx(expected, abs=1e-3)
    assert 0.8 < healthy.below < 0.9  # one standard deviation above the mean


@pytest.mark.parametrize(("value", "text"), [(-90.0, "< 1 %"), (6.21, "50 %"), (99.0, "> 99 %")])
def test_no_leg_is_below_or_above_all_of_a_group(value, text) -> None:
    far = replace(STIFF, value=value, ci95=(value - 0.1, value + 0.1))
    assert placed(measures(far), read_norms())[0].text == text


def test_what_is_unsure_of_the_leg_draws_it_to_the_middle() -> None:
    wide = replace(STIFF, ci95=(2.0, 17.7))
    sure, unsure = (placed(measures(m), read_norms())[0].below for m in (STIFF, wide))
    assert 0.5 < unsure < sure


@pytest.mark.parametrize(
    "told",
    [
        measures(replace(STIFF, verdict=Verdict.UNDETERMINED)),
        measures(
            adequacy=Adequacy(Grade.INADEQUATE, (against("said", text="it hardly moves"),), 99.0)
        ),
        measures(replace(STIFF, unit="Nm/kg")),
        measures(replace(STIFF, name="passive_torque@10deg")),
    ],
)
def test_a_leg_that_is_not_known_or_not_measured_so_has_no_place(told) -> None:
    assert placed(told, read_norms()) == ()


def test_a_leg_that_is_known_roughly_has_a_place_with_its_ends() -> None:
    wide = replace(STIFF, ci95=(4.0, 15.7), verdict=Verdict.WEAK)
    sure, unsure = (placed(measures(m), read_norms())[0] for m in (STIFF, wide))
    assert sure.ends is None
    low, high = unsure.between
    assert low < 0.3 < unsure.below < 0.9 < high
    assert unsure.ends == ("28 %", "> 99 %")


def test_a_laboratory_has_its_own(tmp_path) -> None:
    path = tmp_path / "own.toml"
    entry = (
        '[[norm]]\nmeasure = "slow_torque@10deg"\nunit = "Nm"\ncondition = "slow"\ngroup = "ours"\n'
        'n = 20\nmean = 9.85\nsd = 1.0\nreference = "own legs"\n'
    )
    path.write_text(entry)
    assert placed(measures(), read_norms(path))[0].below == pytest.approx(0.5)
    for wrong, told in (("n = 20", "n = 1"), ("sd = 1.0", 'sd = "wide"'), ("group", "grup")):
        path.write_text(entry.replace(wrong, told))
        with pytest.raises(InputError, match=r"norm\[0\]"):
            read_norms(path)
