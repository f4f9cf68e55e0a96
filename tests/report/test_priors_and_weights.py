"""What was known beforehand, and what was left out: the report says both."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.frozen import read_only
from surae.inference import Prior, fit_problem, make_problem, whiteness
from surae.report.figures.research import residual_figure
from surae.report.figures.torque import torque_figure
from surae.report.provenance import excluded_spans, excluded_text, prior_note, prior_text
from surae.report.traces import traces_of

from . import parts
from .test_content import content_of, rows_of, settings_of


@pytest.fixture(scope="module")
def informed(make_trial, make_fitted):
    """A trial with a spoilt stretch that is left out, and priors on two parameters."""
    clean = make_trial()
    weight, torque = np.ones(1000), clean.torque.copy()
    weight[200:250] = weight[300] = 0.0
    torque[200:250] += 500.0
    inputs = replace(clean, weight=read_only(weight), torque=read_only(torque))
    priors = {"l0_tri": (0.044, 0.2), "k_rel": (0.4, 0.5)}
    return make_fitted(fit_problem(make_problem([inputs], priors=priors), starts=1))


def test_priors_are_in_the_settings_and_at_the_parameters(informed, plain):
    content = content_of(informed)
    settings = settings_of(content)
    assert settings["Priors"] == "l0_tri = 0.044 / 0.2, k_rel = 0.4 / 0.5"
    rows = rows_of(content)
    assert "with prior 0.044 ± 20 %" in rows["l0_tri"]["Verdict"].why
    assert "prior" not in rows["l0_tib"]["Verdict"].why
    assert "; with prior 0.044 ± 20 %" in informed.words
    assert "the prior, one standard deviation to either side" in informed.words
    assert "Priors" not in settings_of(content_of(plain))
    assert 'class="prior"' not in plain.words
    assert informed.words.count('class="prior"') == 2


def test_the_mark_spans_a_standard_deviation_within_the_bounds(informed):
    rows = rows_of(content_of(informed))
    bar = rows["l0_tri"]["Between its bounds"].bar
    p = informed.assessment.parameters["l0_tri"]
    ends = np.array([0.044 * np.exp(-0.2), 0.044, 0.044 * np.exp(0.2)])
    assert bar.prior == pytest.approx((ends - p.lower) / (p.upper - p.lower))
    assert "prior from" in bar.alt
    assert rows["l0_tib"]["Between its bounds"].bar.prior is None


@pytest.mark.parametrize(
    ("spread", "text"),
    [(0.2, "0.04 m ± 20 %"), (0.025, "0.04 m ± 2.5 %"), (1.0, "0.04 m, times or divided by 2.72")],
)
def test_a_prior_in_words(spread, text):
    assert prior_text(Prior(0.04, spread), "m") == text


def test_a_prior_that_decides_is_said_to():
    prior = Prior(0.04, 0.2)
    assert prior_note(prior, 0.04, 0.0079).endswith("to which the data add little")
    assert (
        prior_note(prior, 0.04, 0.002)
        == prior_note(prior, 0.04, None)
        == ("with prior 0.04 ± 20 %")
    )


def test_spans_of_weight_zero():
    assert excluded_spans(None) == ()
    assert excluded_spans(np.ones(3)) == ()
    assert excluded_spans(np.array([0.0, 0.0, 0.5, 1.0, 0.0, 2.0, 0.0])) == ((0, 1), (4, 4), (6, 6))
    assert excluded_spans(np.zeros(2)) == ((0, 1),)


def test_spans_in_words():
    time = np.arange(40) / 10
    weight = np.ones(40)
    assert excluded_text(time, weight) == ""
    weight[5:8] = weight[20] = 0.0
    assert excluded_text(time, weight) == "4 of 40 samples, weight 0: 0.5 … 0.7 s, 2 s"
    weight[::2] = 0.0
    text = excluded_text(time, weight)
    assert text.startswith("22 of 40 samples, weight 0: 0 s, 0.2 s, 0.4 … 0.8 s, 1 s,")
    assert text.endswith("and 12 spans more")


def test_what_was_left_out_is_said_and_hatched(informed):
    content = content_of(informed)
    expected = "51 of 1000 samples, weight 0: 2 … 2.49 s, 3 s"
    facts = parts.facts(parts.section(content, "Recording:"))
    assert facts["Left out of the fit"] == expected
    assert informed.words.count(expected) == 1
    traces = traces_of(informed.result)[0]
    white = whiteness(traces.residual[traces.counted], 100.0)
    for figure in (
        torque_figure(traces),
        residual_figure(traces.time, traces.residual, white, traces.excluded),
    ):
        hatched = [p for axes in figure.axes for p in axes.patches if p.get_hatch()]
        assert len(hatched) == 2
        spans = [(p.get_x(), p.get_x() + p.get_width()) for p in hatched]
        assert np.array(spans) == pytest.approx(np.array([(1.995, 2.495), (2.995, 3.005)]))


def test_what_was_left_out_is_in_no_number(informed):
    traces = traces_of(informed.result)[0]
    assert np.abs(traces.residual).max() > 400
    content = content_of(informed)
    note = parts.key(content)[1][2]
    rms = float(np.sqrt(np.mean(traces.measured[traces.counted] ** 2)))
    assert note == f"torque itself {rms:.3g} Nm"
    assert "passes for white noise" in informed.words


def test_all_samples_count_without_weights(plain):
    assert "Left out" not in plain.words
    assert traces_of(plain.result)[0].counted.all()


@pytest.mark.parametrize(
    ("model", "fixed"),
    [
        pytest.param("muscle", {"m": 1e200}, marks=pytest.mark.slow),
        pytest.param("muscle", {"k_tri": 1e6, "x0_tri": 1e-3}, marks=pytest.mark.slow),
        pytest.param("muscle-tendon", {"k_tri": 1e6, "x0_tri": 1e-3}, marks=pytest.mark.slow),
        ("muscle-tendon", {"g1": 1e300}),
    ],
)
def test_a_fit_that_overflows_has_a_report(model, fixed, make_trial, make_fitted):
    bounds = {name: (0.5 * value, 2.0 * value) for name, value in fixed.items()}
    problem = make_problem([make_trial()], model, fixed=fixed, bounds=bounds)
    result = fit_problem(problem, starts=1)
    page = make_fitted(result).words
    if not np.isfinite(result.residuals[0]).all():
        assert "its torque is not finite, first at sample 1 (0 s)" in page
    else:
        assert "its torque is not finite" not in page
    if result.status == "failed":
        assert "not estimates" in page
    assert "nan" not in page.split("<main>")[1].split("data:image")[0]
