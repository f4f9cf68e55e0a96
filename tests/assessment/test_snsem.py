"""Standard errors against those of simulations."""

import json
from dataclasses import replace

import pytest

from surae.assessment import Baseline, assess
from surae.assessment.saved.fit_json import load_saved, save_fit
from surae.assessment.uncertainty.snsem import snsem
from surae.errors import InputError
from surae.model import ModelOptions

BASELINE = Baseline("muscle", ModelOptions(), {"m": 0.001, "g1": 1e4, "f0": 0.02}, "3 subjects")


def test_the_ratio_is_that_of_the_thesis(fitted) -> None:
    assessment = assess(fitted, BASELINE)
    assert set(assessment.snsem) == {"m", "g1", "f0"}
    for name, ratio in assessment.snsem.items():
        assert ratio == pytest.approx(assessment.parameters[name].sem / BASELINE.sem[name])
    assert assess(fitted).snsem == {}


def test_where_there_is_no_standard_error_there_is_no_ratio() -> None:
    assert snsem(BASELINE, {"m": None, "f0": 0.04, "beta": 0.1}) == {
        "m": None,
        "f0": pytest.approx(2.0),
    }


def test_weights_of_a_normalised_envelope_have_another_unit() -> None:
    assert set(snsem(BASELINE, {"m": 0.002, "g1": 10.0}, "1")) == {"m"}


def test_a_baseline_of_another_model(fitted) -> None:
    with pytest.raises(InputError, match="of model 'muscle-2010', the fit of 'muscle'"):
        assess(fitted, replace(BASELINE, model="muscle-2010", sem={"m": 0.004}))
    with pytest.raises(InputError, match="other model options"):
        assess(fitted, replace(BASELINE, options=ModelOptions(vmax_factor=10.0)))


def test_a_baseline_survives_the_file_of_the_fit(fitted, tmp_path) -> None:
    save_fit(tmp_path / "f.json", fitted, assess(fitted, BASELINE))
    content = json.loads((tmp_path / "f.json").read_text(encoding="utf-8"))
    assert content["snsem"]["values"] == dict(assess(fitted, BASELINE).snsem)
    baseline = load_saved(tmp_path / "f.json").baseline
    assert baseline == BASELINE
