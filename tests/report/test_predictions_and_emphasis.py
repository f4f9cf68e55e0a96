"""Weights, losses, default priors, simulations and predictions: the report says what was used."""

from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest

from surae.base.frozen import read_only
from surae.inference import AssessedFit, assess, fit_problem, fit_robust, make_problem
from surae.inference.judging.validation import predict_others
from surae.report.figures.torque import predictions_figure
from surae.report.fit import fit_report
from surae.report.sections import predictions_section
from surae.signals import Weighting, weighted
from undrawn import blank_figures

from . import parts
from .test_content import content_of, settings_of, summary_of

CREATED = datetime(2026, 1, 5, 14, 3)


def texts(case):
    content = content_of(case)
    return settings_of(content), summary_of(content)


def judged(result):
    """A fit and what it is worth, without its page."""
    return AssessedFit(result, assess(result))


@pytest.fixture(scope="module")
def struck(make_trial):
    """A trial with a burst of 300 Nm over a tenth of a second."""
    inputs = make_trial()
    torque = inputs.torque.copy()
    torque[400:410] -= 300.0
    return replace(inputs, torque=read_only(torque))


@pytest.fixture(scope="module")
def spared(struck, make_fitted):
    return make_fitted(fit_robust(make_problem([struck]), starts=1))


def test_a_loss_is_told_with_what_it_spared(spared, plain):
    summary = texts(spared)[1]
    assert "Outliers count less (huber loss)" in summary
    assert "With the samples counted as in the fit, the VAF is" in summary
    assert "no stray artefacts" not in summary
    facts = parts.facts(parts.section(content_of(spared), "Recording:"))
    assert "VAF, weighted as in the fit" in facts
    summary = texts(plain)[1]
    assert "Outliers" not in summary
    assert "samples" not in summary


def test_many_outliers_are_said_to_be_none(make_trial):
    inputs = make_trial()
    missed = 60.0 * (inputs.time % 1.0 < 0.08)
    result = fit_robust(make_problem([replace(inputs, torque=inputs.torque + missed)]), starts=1)
    assert result.solution.outliers.share == pytest.approx(0.08, abs=0.02)
    assert "So many are no stray artefacts" in texts(judged(result))[1]


def test_weights_are_told(make_trial, make_fitted):
    inputs = weighted([make_trial()], Weighting(windows=((1.0, 2.0, 0.0),), peaks=4.0))
    case = make_fitted(fit_problem(make_problem(inputs), starts=1))
    assert "Some samples count more than others" in texts(case)[1]
    assert "Weights: 1 … 2 s left out of the fit." in case.words
    assert "counts 5 times as much as rest" in case.words
    assert "because some samples count more than others" in case.words


def test_default_priors_are_told_from_given_ones(make_trial):
    problem = make_problem([make_trial()], population="healthy")
    settings, _ = texts(judged(fit_problem(problem, starts=1)))
    assert settings["Priors"] == "healthy"


@pytest.fixture(scope="module")
def predictions(plain, make_trial):
    weight = np.ones(1000)
    weight[100:200] = 0.0
    other = make_trial(seed=7)
    shifted = replace(other, name="<b>shifted</b>", torque=read_only(other.torque + 30.0))
    trials = [replace(other, weight=weight), shifted]
    return predict_others(plain.result, trials, plain.assessment.uncertainty)


@pytest.fixture(scope="module")
def page(plain, predictions):
    """A report with predictions."""
    with blank_figures():
        return fit_report(plain, versions={}, created=CREATED, predictions=predictions).page()


def section_of(page, name):
    return page.split(f'id="{name}"')[1].split("</section>")[0]


def test_predictions_have_a_section_a_table_and_a_figure(plain, page):
    section = section_of(page, "predictions")
    assert "Predicting other recordings" in section
    assert section.count("<tr>") == 4  # heading, two recordings, together
    assert section.count("data:image/png") == 1
    assert "<b>shifted</b>" not in section
    assert "&lt;b&gt;shifted&lt;/b&gt;" in section
    assert "carry over only in part" in section
    assert "Predicting other recordings" not in plain.words


def test_a_good_prediction_is_not_warned_of(plain, predictions):
    (section,) = predictions_section(plain.assessment, predictions[:1])
    assert "carry over only in part" not in parts.text(section)
    assert list(parts.rows(section)) == ["trial 1"]
    assert predictions_section(plain.assessment, []) == ()


def test_the_figure_shows_both_torques_of_each_recording(predictions):
    first, second = predictions_figure(predictions).axes
    measured, predicted = first.get_lines()
    np.testing.assert_array_equal(measured.get_ydata(), predictions[0].measured)
    np.testing.assert_array_equal(predicted.get_ydata(), predictions[0].torque)
    assert [p for p in first.patches if p.get_hatch()]
    assert not [p for p in second.patches if p.get_hatch()]
