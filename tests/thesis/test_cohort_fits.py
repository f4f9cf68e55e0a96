"""What is computed of one subject of the cohort, and which of it is asked for."""

import json

import numpy as np
import pytest

from surae_thesis.cohort import work
from surae_thesis.cohort.members import ACTIVE_PROTOCOL, PASSIVE_PROTOCOL, make_cohort
from surae_thesis.cohort.results import Size
from surae_thesis.section import Context


@pytest.fixture(scope="module")
def outcome():
    """The first subject's fits; few samples, as only their form is looked at."""
    patch = pytest.MonkeyPatch()
    patch.setattr(work, "RATE_HZ", 20.0)
    yield work.member_job(seed=1, member=3, made={"gain": 0.0}, repetitions=2, explicit=False)
    patch.undo()


def test_the_full_size_is_that_of_the_thesis(tmp_path):
    size = Size.of(Context(folder=tmp_path))
    assert (size.subjects, size.repetitions) == (14, 3)
    quick = Size.of(Context(folder=tmp_path, quick=True))
    assert quick.subjects < 4


@pytest.mark.slow
def test_every_model_is_fitted_to_every_recording_alone(outcome):
    labels = {tuple(label.split()[1:]) for label in outcome}
    models = {model for model, protocol, _ in labels if protocol == ACTIVE_PROTOCOL}
    assert models == set(work.MODELS)
    assert {r for _, _, r in labels} == {"1", "2"}
    assert {m for m, p, _ in labels if p == PASSIVE_PROTOCOL} == {"1.0", "2.0"}


@pytest.mark.slow
def test_the_first_repetition_predicts_the_others_and_the_passive_protocol(outcome):
    predicted = outcome[f"implicit 1.0 {ACTIVE_PROTOCOL} 1"]["predicted"]
    assert [(p["protocol"], p["repetition"]) for p in predicted] == [
        (ACTIVE_PROTOCOL, 2),
        (PASSIVE_PROTOCOL, 1),
        (PASSIVE_PROTOCOL, 2),
    ]
    assert all(p["vaf"] > 50.0 for p in predicted)
    assert outcome[f"implicit 1.0 {ACTIVE_PROTOCOL} 2"]["predicted"] == []


@pytest.mark.slow
def test_a_fit_gives_plain_data_with_the_truth_beside_it(outcome):
    assert json.loads(json.dumps(outcome, allow_nan=False)) == outcome
    who = make_cohort(1)[3].subject
    fit = outcome[f"implicit 2.1 {ACTIVE_PROTOCOL} 1"]
    parameters = fit["parameters"]
    assert parameters["l0_tri"]["true"] == who.parameters["l0_tri"]
    assert parameters["dlt_tri"]["true"] == who.tendons["dlt_tri"]
    assert parameters["g1"]["true"] is None
    assert "pt_tri" not in parameters
    assert fit["vaf"] > 95.0
    names, matrix = fit["correlation"]["names"], np.array(fit["correlation"]["matrix"])
    assert set(names) <= {n for n, p in parameters.items() if not p["at_bound"]}
    np.testing.assert_allclose(np.diag(matrix), 1.0)
    assert fit["sizes"]["neural"] > fit["sizes"]["inertial"] > 0.0


@pytest.mark.slow
def test_the_thesis_s_scheme_fits_the_same_recordings():
    fits = work.member_job(seed=1, member=3, made={"gain": 0.0}, repetitions=1, explicit=True)
    label = f"2.0 {ACTIVE_PROTOCOL} 1"
    assert fits[f"explicit {label}"]["vaf"] < fits[f"wide {label}"]["vaf"]
    assert fits[f"wide {label}"]["vaf"] < fits[f"implicit {label}"]["vaf"] + 0.1
    assert f"explicit 1.0 {ACTIVE_PROTOCOL} 1" not in fits


@pytest.mark.slow
def test_only_a_strain_of_the_slack_length_reaches_the_torques_of_the_thesis():
    strengths = [work.strength_job(seed=1, member=number) for number in (0, 3)]
    for strength in strengths:
        assert strength["measured"] > 1.4 * strength["printed"]
    assert max(strength["measured"] for strength in strengths) > 55.0


@pytest.mark.slow
def test_a_baseline_is_the_mean_of_simulations(monkeypatch):
    monkeypatch.setattr(work, "RATE_HZ", 64.0)
    both, *single = (
        work.baseline_job(seed=1, protocol="multiple-holds", model="2.1", subjects=n)
        for n in (2, 1)
    )
    assert set(both) >= {"m", "k_tri", "g1", "l0_tri", "f0", "dlt_tri"}
    assert all(value > 0.0 for value in both.values())
    assert both != single[0]
