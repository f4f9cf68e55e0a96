"""What neighbours' users ask of a result: residual, criteria, tables, stretches left out."""

import math
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.api.fitting import JUDGING
from surae.base.errors import InputError
from surae.inference.judging.goodness import akaike, bayesian
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial


@pytest.fixture(scope="module")
def inputs():
    protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=64.0)
    return virtual_trial(virtual_subject(3), generate(protocol), noise=0.05)


@pytest.fixture(scope="module")
def fits(inputs):
    left_out = surae.fit(inputs, "muscle", starts=1, exclude=[(5.0, 9.0)])
    fixed = surae.fit(inputs, "muscle", starts=1, fixed={"m": 3.5})
    return {"all": surae.fit(inputs, "muscle", starts=1), "fixed": fixed, "part": left_out}


def test_criteria_are_those_of_their_equations() -> None:
    assert akaike(100, 50.0, 3) == pytest.approx(100 * math.log(0.5) + 6)
    assert bayesian(100, 50.0, 3) == pytest.approx(100 * math.log(0.5) + 3 * math.log(100))
    assert akaike(100, math.inf, 3) is None
    assert akaike(0, 1.0, 3) is None
    assert bayesian(0, 1.0, 3) is None


def test_residual_is_measured_minus_modelled(fits, inputs) -> None:
    fit = fits["all"]
    modelled = surae.simulate("muscle", fit.values, inputs)
    np.testing.assert_allclose(fit.residual, inputs.torque - modelled, atol=1e-9)
    k = sum(p.free for p in fit.parameters.values())
    chi2 = float(fit.residual @ fit.residual)
    assert fit.aic == pytest.approx(akaike(len(fit.residual), chi2, k))


def test_fits_of_the_same_samples_are_compared(fits) -> None:
    made = surae.compare({"all": fits["all"], "fixed": fits["fixed"]})
    assert made["all"].above_aic == 0.0
    assert made["fixed"].above_aic > 10.0
    assert made["fixed"].free == made["all"].free - 1
    table = made.to_dataframe()
    assert list(table.index) == ["all", "fixed"]
    assert "not independent" in repr(made)


def test_no_criterion_compares_fits_of_other_samples(fits) -> None:
    made = surae.compare({"all": fits["all"], "part": fits["part"]})
    assert made["part"].n < made["all"].n
    assert made["part"].above_aic is None
    assert made["all"].above_bic is None
    with pytest.raises(InputError, match="at least two"):
        surae.compare({"all": fits["all"]})


def test_a_stretch_that_is_excluded_does_not_count(fits, inputs) -> None:
    spoilt = inputs.torque.copy()
    spoilt[(inputs.time >= 5.0) & (inputs.time <= 9.0)] += 30.0
    other = replace(inputs, torque=spoilt)
    made = surae.fit(other, "muscle", starts=1, exclude=[(5.0, 9.0)])
    assert made.values == pytest.approx(dict(fits["part"].values), rel=1e-6)
    weights = surae.api.Weighting(windows=((5.0, 9.0, 0.0),))
    by_weights = surae.fit(inputs, "muscle", starts=1, weights=weights)
    assert by_weights.values == fits["part"].values


@pytest.mark.parametrize("wrong", [[2.0], [(1.0, 2.0, 0.0)], [(3.0, 2.0)], [(900.0, 901.0)]])
def test_what_is_no_stretch_is_refused(inputs, wrong) -> None:
    with pytest.raises(InputError):
        surae.fit(inputs, "muscle", starts=1, exclude=wrong)


def test_the_report_has_every_parameter_in_lmfits_layout(fits) -> None:
    text = fits["fixed"].fit_report(min_correlation=0.5)
    assert text.startswith("[[Fit Statistics]]")
    assert "m:       3.5 kg (fixed)" in text
    for name in fits["fixed"].parameters:
        assert f"    {name}:" in text
    assert text.isascii() is False  # chi-square's unit; numbers themselves are ASCII
    assert "−" not in text
    sizes = [abs(float(line.rpartition("=")[2])) for line in text.splitlines() if "C(" in line]
    assert sizes == sorted(sizes, reverse=True)
    assert min(sizes) >= 0.5


def test_every_answer_is_a_table_of_numbers(fits) -> None:
    measures = fits["all"].measures(angles=[0.0])
    table = measures.to_dataframe()
    one = measures["passive_torque@0deg"]
    assert table.loc["passive_torque@0deg", "ci95_low"] == one.ci95[0]
    assert table.loc["passive_torque@0deg", "unit"] == "Nm"
    assert "sdc" in table.columns
    assert "ci95" not in table.columns
    profiles = surae.profile(fits["all"], ["f0"])
    assert profiles.to_dataframe().loc["f0", "value"] == profiles["f0"].value
    change = surae.change(fits["all"], fits["fixed"])
    assert set(change.to_dataframe().index) == {*change.measures, *change.parameters}


def test_a_name_that_is_not_there_names_the_nearest(fits) -> None:
    with pytest.raises(KeyError, match="end_stiffness"):
        fits["all"].measures()["end_stifness"]
    with pytest.raises(KeyError, match="f0"):
        surae.profile(fits["all"], ["f0"])["f_0"]


def test_a_line_of_progress_does_not_end_before_the_work(inputs, monkeypatch) -> None:
    """What is searched is counted; that it is judged then is said, once all starts are done."""
    told: list[tuple[object, ...]] = []
    monkeypatch.setattr(
        "surae.api.fitting.line_of_progress",
        lambda _: nullcontext(lambda *news: told.append(news)),
    )
    surae.fit(inputs, "muscle", starts=2)
    counted = [news[:2] for news in told if len(news) > 1]
    assert counted[-1] == (2, 2)
    assert told[-1] == (JUDGING,)
    assert told.count((JUDGING,)) == 1
