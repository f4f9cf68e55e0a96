"""What weights and losses do to the figures of a fit."""

import json
from dataclasses import replace

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.inference import AssessedFit, Interval, assess, fit_problem, fit_robust, make_problem
from surae.inference.judging.goodness import vaf, weighted_vaf
from surae.inference.saved.fit_json import load_saved, save_fit
from surae.model import ModelOptions, get_model
from surae.signals import Weighting, thinned, weighted


def test_weighted_vaf_by_hand() -> None:
    torque, residual = np.array([1.0, 2.0, 3.0]), np.array([0.5, 0.0, -1.0])
    weight = np.array([1.0, 1.0, 4.0])
    expected = 100 * (1 - (0.25 + 4.0) / (1.0 + 4.0 + 36.0))
    assert weighted_vaf([(torque, residual, weight)]) == pytest.approx(expected)
    assert weighted_vaf([(torque, residual, np.full(3, 2.0))]) is None
    # Two recordings that count differently, each alike within.
    parts = [(torque, residual, np.ones(3)), (torque, residual, np.full(3, 2.0))]
    assert weighted_vaf(parts) == pytest.approx(vaf(torque, residual))
    assert np.isnan(weighted_vaf([(torque, np.array([np.nan, 0.0, 0.0]), weight)]))


def test_vaf_of_a_fit_is_plain_and_beside_it_weighted(noisy) -> None:
    (inputs,) = weighted([noisy], Weighting(windows=((0.0, 3.0, 0.0),), peaks=9.0))
    result = fit_problem(make_problem([inputs]), starts=1)
    assessment = assess(result)
    (residual,), counted = result.residuals, inputs.weight > 0
    assert assessment.vaf == pytest.approx(vaf(inputs.torque[counted], residual[counted]))
    root = np.sqrt(inputs.weight)
    assert assessment.vaf_weighted == pytest.approx(vaf(root * inputs.torque, root * residual))
    assert assessment.vaf_weighted > assessment.vaf
    assert assessment.recordings[0].vaf_weighted == assessment.vaf_weighted
    assert assessment.interval is Interval.ROBUST
    assert assessment.interval_note == "some samples count more than others"


def test_without_weights_or_with_gaps_only_there_is_one_vaf(noisy, fitted) -> None:
    assert assess(fitted).vaf_weighted is None
    (inputs,) = weighted([noisy], Weighting(windows=((0.0, 3.0, 0.0),)))
    assessment = assess(fit_problem(make_problem([inputs]), starts=1))
    assert assessment.vaf_weighted is None
    assert assessment.recordings[0].vaf_weighted is None
    assert "samples count" not in assessment.interval_note


@pytest.fixture(scope="module")
def short(clean, subject):
    """The trial without noise at a quarter of its rate, for many fits."""
    inputs = thinned(clean, 4)
    spec = get_model("muscle")
    vector = spec.vector(subject.parameters, ModelOptions())
    torque = spec.simulator(inputs, ModelOptions()).torque(vector)
    return replace(inputs, torque=read_only(torque))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["peaks", "window", "huber"])
def test_standard_errors_of_weighted_fits_are_the_spread_of_the_estimates(kind, short, subject):
    """Weights that say what matters, not what is precise: J'WJ alone would be wrong."""
    free = ("k_tri", "g3", "l0_tri", "f0")
    fixed = {name: value for name, value in subject.parameters.items() if name not in free}
    start = {name: subject.parameters[name] for name in free}
    weighting = {
        "peaks": Weighting(peaks=9.0),
        "window": Weighting(windows=((20.0, 25.0, 20.0),)),
    }.get(kind, Weighting())
    values, robust, plain = [], [], []
    for seed in range(60):
        noise = 1.3 * np.random.default_rng(seed).standard_normal(short.n)
        trial = replace(short, torque=read_only(short.torque + noise))
        problem = make_problem(weighted([trial], weighting), fixed=fixed, start=start)
        result = (fit_robust if kind == "huber" else fit_problem)(problem, starts=1)
        found = [assess(result).parameters[name] for name in free]
        values.append([p.value for p in found])
        robust.append([p.sem_robust for p in found])
        plain.append([p.sem for p in found])
    spread = np.std(values, axis=0, ddof=1)
    ratio = np.sqrt(np.mean(np.square(robust), axis=0)) / spread
    # Each spread is known to 9 %, their mean better.
    assert ratio == pytest.approx(1.0, abs=0.3)
    assert ratio.mean() == pytest.approx(1.0, abs=0.15)
    assert np.mean(np.sqrt(np.mean(np.square(plain), axis=0)) / spread) < ratio.mean()
    if kind == "window":
        assert np.mean(np.mean(plain, axis=0) / spread) < 0.7


@pytest.fixture(scope="module")
def robust_fit(noisy):
    (inputs,) = weighted([noisy], Weighting(peaks=2.0))
    torque = inputs.torque.copy()
    torque[1000:1010] -= 300.0
    return fit_robust(make_problem([replace(inputs, torque=read_only(torque))]), "tukey", starts=1)


def test_a_robust_weighted_fit_survives_its_file(robust_fit, tmp_path) -> None:
    assessment = assess(robust_fit)
    save_fit(tmp_path / "fit.json", AssessedFit(robust_fit, assessment))
    content = json.loads((tmp_path / "fit.json").read_text(encoding="utf-8"))
    assert content["vaf_weighted"] == assessment.vaf_weighted
    assert content["recordings"][0]["vaf_weighted"] == assessment.vaf_weighted
    assert content["outliers"]["loss"] == "tukey"
    assert content["outliers"]["scale_Nm"] == robust_fit.solution.outliers.scale
    loaded = load_saved(tmp_path / "fit.json").result
    assert loaded.problem.inputs[0].emphasised
    np.testing.assert_array_equal(
        loaded.solution.outliers.weights[0], robust_fit.solution.outliers.weights[0]
    )
    again = assess(loaded)
    for name, p in assessment.parameters.items():
        assert again.parameters[name].sem_robust == p.sem_robust, name
    assert again.vaf_weighted == assessment.vaf_weighted


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"loss": "cauchy"}, "outliers"),
        ({"scale_Nm": 0.0}, "outliers"),
        ({"widening": "wide"}, "damaged"),
        ({"weights": []}, "damaged"),
    ],
)
def test_damaged_outliers(change, says, robust_fit, tmp_path) -> None:
    path = tmp_path / "fit.json"
    save_fit(path, AssessedFit(robust_fit, assess(robust_fit)))
    content = json.loads(path.read_text(encoding="utf-8"))
    content["outliers"] |= change
    path.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(InputError, match=says):
        load_saved(path)


def test_an_older_file_has_neither(fitted, tmp_path) -> None:
    path = tmp_path / "fit.json"
    save_fit(path, AssessedFit(fitted, assess(fitted)))
    content = json.loads(path.read_text(encoding="utf-8"))
    for name in ("outliers", "vaf_weighted"):
        assert content.pop(name) is None
    del content["traces"][0]["emphasised"]
    del content["sha256"]  # nor what its numbers are checked by
    content["snsem"] = None  # which files no longer have
    path.write_text(json.dumps(content), encoding="utf-8")
    loaded = load_saved(path).result
    assert loaded.solution.outliers is None
    assert not loaded.problem.inputs[0].emphasised
