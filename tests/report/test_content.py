from dataclasses import replace
from datetime import datetime

import pytest

from surae.base.formatting import estimate, percentage, significant, standard_error
from surae.inference import AssessedFit
from surae.inference.judging.grade import Adequacy, Grade
from surae.inference.judging.reasons import against
from surae.report import block
from surae.report.fit import fit_report

from . import parts


def content_of(case, result=None):
    fit = AssessedFit(result or case.result, case.assessment)
    return fit_report(
        fit, versions={"surae": "1.2.3"}, created=datetime(2026, 1, 5, 14, 3)
    ).document


@pytest.fixture(scope="module")
def content(plain):
    return content_of(plain)


def rows_of(content):
    return parts.rows(parts.section(content, "Parameters"))


def summary_of(content):
    return parts.text(parts.section(content, "Summary"))


def settings_of(content):
    return parts.facts(parts.section(content, "Settings and provenance"))


def test_the_numbers_are_those_of_the_assessment(plain, content):
    rows = rows_of(content)
    assert list(rows) == list(plain.assessment.parameters)
    for name, p in plain.assessment.parameters.items():
        row = {head: cell.text for head, cell in rows[name].items()}
        # to the digit that everything together leaves; the error (34) is of the noise alone
        assert row["Value"] == estimate(p.value, p.trusted_sem, p.ci95).value
        assert (row["SEM (34)"], row["95 % interval"]) == estimate(p.value, p.sem, p.ci95)[1:]
        assert row["Robust SEM"] == standard_error(p.sem_robust)
        judged, bar = rows[name]["Verdict"], rows[name]["Between its bounds"].bar
        assert (judged.badge[0], judged.why) == (f"verdict {p.verdict}", p.note)
        assert bar.value == pytest.approx((p.value - p.lower) / (p.upper - p.lower))
        assert bar.low <= bar.value <= bar.high
    r2, rmse = plain.assessment.adequacy.r2, plain.assessment.rmse
    assert [value for _, value, _ in parts.key(content)][:2] == [
        f"{percentage(r2)} %",
        f"{significant(rmse, 3)} Nm",
    ]
    facts = parts.facts(parts.section(content, "Recording:"))
    assert facts["VAF"] == f"{percentage(plain.assessment.recordings[0].vaf)} %"
    assert facts["Samples"] == "1000 at 100 Hz"
    correlations = parts.text(parts.section(content, "Correlation"))
    assert significant(plain.assessment.ipde, 3) in correlations


def test_white_residuals_are_not_called_coloured(content):
    told = parts.text(parts.section(content, "Parameters"))
    assert "white noise, equation (34): the residual passes for white noise" in told


def test_coloured_residuals_widen_the_intervals_and_say_so(coloured):
    content, whiteness = content_of(coloured), coloured.assessment.whiteness[0]
    text = parts.text(parts.section(content, "Residual"))
    assert f"autocorrelation {significant(whiteness.lag1, 2)}" in text
    assert f"{significant(whiteness.fall_s, 2)} s to fall" in text
    parameters = parts.text(parts.section(content, "Parameters"))
    assert "robust SEM, because the residual is correlated" in parameters
    assert "Student’s t times the robust SEM" in parameters
    assert "correlated over time" in parts.text(parts.section(content, "Residual"))
    for name, row in rows_of(content).items():
        p = coloured.assessment.parameters[name]
        interval = estimate(p.value, p.sem_robust, p.ci95).interval
        assert row["95 % interval"].text == interval
        assert row["SEM (34)"].text == standard_error(p.sem)
        assert row["Robust SEM"].text == standard_error(p.sem_robust)


def test_fixed_and_bounded_parameters_say_why(joint):
    content = content_of(joint)
    rows = rows_of(content)
    beta, f0 = rows["beta"], rows["f0"]
    heads = ("Value", "SEM (34)", "95 % interval", "Between its bounds")
    assert [beta[head].text for head in heads] == ["1", "—", "—", "—"]
    assert beta["Between its bounds"].bar is None
    assert beta["Verdict"].badge == ("verdict fixed", "fixed")
    assert beta["Verdict"].why == "fixed, not estimated"
    assert f0["Verdict"].badge == ("verdict at-bound", "at bound")
    assert (f0["Value"].text, f0["95 % interval"].text) == ("1.5", "—")
    assert f0["Between its bounds"].bar.low is None
    assert "upper bound" in f0["Verdict"].why
    shown = settings_of(content)
    assert shown["Fixed"] == "beta = 1"
    assert shown["Bounds"] == "f0 = 0.3 / 1.5"
    assert "f0" in parts.text(parts.section(content, "Correlation"))
    details = next(b for b in content.blocks if b.title == "Details")
    assert sum(b.title.startswith("Recording:") for b in details.blocks) == 2


def test_a_parameter_without_influence_says_so(silent):
    content = content_of(silent)
    rows = rows_of(content)
    for name in ("g1", "l0_tib"):
        assert (rows[name]["SEM (34)"].text, rows[name]["95 % interval"].text) == ("—", "—")
        assert rows[name]["Verdict"].why == silent.assessment.parameters[name].note
        assert rows[name]["Verdict"].why.startswith("no interval: ")
    glance = next(b for b in parts.blocks(content) if isinstance(b, block.Grid))
    by_verdict = {row[0].badge[1]: row[1].pairs for _, group in glance.groups for row in group}
    assert ("g1", "undetermined") in by_verdict["undetermined"]


def test_a_failed_fit_claims_nothing(plain):
    failed = replace(plain.result, status="failed", message="no minimum reached: fit again")
    content = content_of(plain, failed)
    status, *texts = (b for b in content.blocks[0].blocks if isinstance(b, block.Text))
    assert (status.lead, status.text) == ("Fit failed.", "No minimum reached: fit again.")
    assert len(texts) == 1
    assert "not estimates" in texts[0].text
    assert "not estimates" in parts.text(parts.section(content, "Parameters"))
    assert "identified" not in texts[0].text
    assert parts.key(content)[2][1] == "—"


def test_a_single_agreeing_start_is_a_warning(plain):
    content = content_of(
        plain, replace(plain.result, solution=replace(plain.result.solution, agreeing=1))
    )
    assert "Only one of 3 starts" in summary_of(content)


def test_the_starts_are_in_the_settings(plain, content):
    assert settings_of(content)["Starts"] == (
        f"{plain.result.solution.agreeing} of 3 reach the best minimum; seed 0"
    )


def test_the_followed_part_is_that_of_the_changes_not_of_the_mean(plain):
    still = against("still", grave=True, moved=2.0)
    flat = judged(plain, Grade.INADEQUATE, (still,), r2=-193.0)
    assert flat.assessment.vaf > 99.0
    assert parts.key(content_of(flat))[0][1] == "−193.00 %"


def judged(case, grade, reasons, r2):
    return replace(case, assessment=replace(case.assessment, adequacy=Adequacy(grade, reasons, r2)))


def test_an_adequate_fit_says_so_and_nothing_else(content):
    words = parts.adequacy(content)
    assert (words.grade, words.mark) == ("adequate", "✓")
    assert words.sentence.startswith("Adequate: the model follows")
    assert "inadequate" not in summary_of(content)


def test_an_inadequate_fit_opens_with_its_reasons_and_counts_nothing(plain):
    reasons = (
        against("still", grave=True, moved=2.0),
        against("at-bound", names="f0"),
    )
    case = judged(plain, Grade.INADEQUATE, reasons, r2=12.0)
    words = parts.adequacy(content_of(case))
    assert words.reasons == (
        "the ankle hardly moves (2° in all): nothing tells stiffness from strength",
        "at a bound: f0",
    )
    assert words.sentence.startswith("Inadequate: no parameter of this fit counts")


def test_a_doubtful_fit_asks_for_caution_and_withholds_nothing(plain):
    little = against("said", text="the ankle moves little")
    content = content_of(judged(plain, Grade.DOUBTFUL, (little,), r2=94.0))
    words = parts.adequacy(content)
    assert (words.mark, words.grade) == ("!", "doubtful")
    assert "no parameter" not in words.sentence.lower()
