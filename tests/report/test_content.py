from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest

from surae.assessment.adequacy import Adequacy, Grade
from surae.report.content import make_content
from surae.report.formatting import estimate, percentage, significant, standard_error
from surae.report.traces import traces_of
from surae.report.wording import closeness


def content_of(case, result=None):
    result = result or case.result
    return make_content(
        result, case.assessment, traces_of(result), versions={"surae": "1.2.3"},
        created=datetime(2026, 1, 5, 14, 3),
    )  # fmt: skip


@pytest.fixture(scope="module")
def content(plain):
    return content_of(plain)


def rows_of(content):
    return {row.name: row for group in content.groups for row in group.rows}


def test_the_numbers_are_those_of_the_assessment(plain, content):
    rows = rows_of(content)
    assert list(rows) == list(plain.assessment.parameters)
    for name, p in plain.assessment.parameters.items():
        row = rows[name]
        assert (row.value, row.sem, row.interval) == estimate(p.value, p.sem, p.ci95)
        assert row.sem_robust == standard_error(p.sem_robust)
        assert (row.verdict, row.note) == (p.verdict, p.note)
        assert row.bar.value == pytest.approx((p.value - p.lower) / (p.upper - p.lower))
        assert row.bar.low <= row.bar.value <= row.bar.high
    r2, rmse = plain.assessment.adequacy.r2, plain.assessment.rmse
    assert [item.value for item in content.key][:2] == [
        f"{percentage(r2)} %", f"{significant(rmse, 3)} Nm",
    ]  # fmt: skip
    facts = {fact.label: fact.value for fact in content.recordings[0].facts}
    assert facts["VAF"] == f"{percentage(plain.assessment.recordings[0].vaf)} %"
    assert facts["Samples"] == "1000 at 100 Hz"
    assert np.array(content.correlation.matrix) == pytest.approx(
        plain.assessment.covariance.correlation
    )
    assert significant(plain.assessment.ipde, 3) in content.correlation.ipde


def test_the_block_is_passive_against_active(content):
    assert content.correlation.passive == ("k_tri", "k_tib", "x0_tri", "x0_tib", "tau_rel", "k_rel")
    assert content.correlation.active == (
        "g1", "g2", "g3", "g4", "l0_tri", "l0_tib", "f0", "beta",
    )  # fmt: skip


def test_every_start_is_listed(plain, content):
    assert [row.sse for row in content.starts] == [
        significant(start.sse, 6) for start in plain.result.starts
    ]
    assert sum(row.agrees for row in content.starts) == plain.result.agreeing
    lowest = min(start.sse for start in plain.result.starts)
    best = [start.sse == lowest for start in plain.result.starts]
    assert [row.excess == "best" for row in content.starts] == best


def test_white_residuals_are_not_called_coloured(content):
    assert content.caution == ""
    assert "passes for white noise" in " ".join(content.summary)


def test_coloured_residuals_widen_the_intervals_and_say_so(coloured):
    content, whiteness = content_of(coloured), coloured.assessment.whiteness[0]
    text = " ".join(content.summary)
    assert f"correlate by {significant(whiteness.lag1, 2)}" in text
    assert f"{significant(whiteness.fall_s, 2)} s to fall" in text
    assert "too small by a factor of" in text
    assert "robust SEM, because the residual is correlated" in content.caution
    assert "correlated over time" in content.recordings[0].residual_text
    assert content.interval == "robust"
    for name, row in rows_of(content).items():
        p = coloured.assessment.parameters[name]
        assert row.interval == estimate(p.value, p.sem_robust, p.ci95).interval
        assert (row.sem, row.sem_robust) == (standard_error(p.sem), standard_error(p.sem_robust))


def test_fixed_and_bounded_parameters_say_why(joint):
    content = content_of(joint)
    rows = rows_of(content)
    beta, f0 = rows["beta"], rows["f0"]
    assert (beta.verdict, beta.value, beta.sem, beta.interval, beta.bounds, beta.bar) == (
        "fixed", "1", "—", "—", "—", None,
    )  # fmt: skip
    assert beta.note == "fixed, not estimated"
    assert (f0.verdict, f0.value, f0.interval, f0.bar.low) == ("at-bound", "1.5", "—", None)
    assert "upper bound" in f0.note
    shown = {setting.label: setting.value for setting in content.settings}
    assert shown["Fixed parameters"] == "beta = 1"
    assert shown["Bounds"] == "f0: 0.3 … 1.5 instead of 0.3 … 15"
    assert "beta" not in content.correlation.names
    assert "f0" in content.correlation.note
    assert len(content.recordings) == len(content.sources) == 2


def test_a_parameter_without_influence_says_so(silent):
    content = content_of(silent)
    rows = rows_of(content)
    for name in ("g1", "l0_tib"):
        assert (rows[name].sem, rows[name].interval) == ("—", "—")
        assert rows[name].note == silent.assessment.parameters[name].note
        assert rows[name].note.startswith("no interval: ")
        assert not rows[name].determined
    (open_,) = [some for some in content.glance if some.verdict == "undetermined"]
    assert ("g1", "undetermined") in open_.parameters
    assert "leaves g1 and l0_tib undetermined" in " ".join(content.summary)


def test_a_failed_fit_claims_nothing(plain):
    failed = replace(plain.result, status="failed", message="no minimum reached: fit again")
    content = content_of(plain, failed)
    assert len(content.summary) == 1
    assert "not estimates" in content.summary[0]
    assert "not estimates" in content.caution
    assert "identified" not in content.summary[0]
    assert content.key[2].value == "—"


def test_a_single_agreeing_start_is_a_warning(plain):
    content = content_of(plain, replace(plain.result, agreeing=1))
    assert "Only one of 3 starts" in content.summary[-1]


def test_the_starts_are_in_the_settings(content, silent):
    several = {setting.label: setting.value for setting in content.settings}
    settings = {setting.label: setting.value for setting in content_of(silent).settings}
    assert (several["Starts"], settings["Starts"]) == (
        "3, random ones with seed 0",
        "the default one",
    )


def test_closeness_is_that_of_the_changes_not_of_the_mean(plain):
    assert [closeness(v) for v in (99.5, 96.0, 85.0, 70.0, -193.0)] == [
        "very closely", "closely", "only roughly", "poorly", "poorly",
    ]  # fmt: skip
    flat = judged(plain, Grade.INADEQUATE, ("the ankle hardly moves",), r2=-193.0)
    assert flat.assessment.vaf > 99.0
    assert "poorly: it explains −193.00 %" in content_of(flat).summary[0]


def judged(case, grade, reasons, r2):
    return replace(case, assessment=replace(case.assessment, adequacy=Adequacy(grade, reasons, r2)))


def test_an_adequate_fit_says_so_and_nothing_else(content):
    assert (content.adequacy.grade, content.adequacy.mark) == ("adequate", "✓")
    assert content.adequacy.sentence.startswith("Adequate: the model follows")
    assert "inadequate" not in " ".join(content.summary)


def test_an_inadequate_fit_opens_with_its_reasons_and_counts_nothing(plain):
    reasons = ("the ankle hardly moves", "f0 lies at a bound")
    case = judged(plain, Grade.INADEQUATE, reasons, r2=12.0)
    content, text = content_of(case), " ".join(content_of(case).summary)
    assert content.adequacy.reasons == reasons
    assert content.adequacy.sentence.startswith("Inadequate: no parameter of this fit counts")
    assert "No parameter is identified, not even with" in text
    assert "parameters are identified" not in text


def test_a_doubtful_fit_asks_for_caution_and_withholds_nothing(plain):
    content = content_of(judged(plain, Grade.DOUBTFUL, ("the ankle moves little",), r2=94.0))
    assert (content.adequacy.mark, content.adequacy.grade) == ("!", "doubtful")
    assert "no parameter" not in content.adequacy.sentence.lower()
    assert "parameters are identified" in " ".join(content.summary)
