"""Every option on every model: a fit, or what is made of it, moves; or a line refuses it."""

import json
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import surae
from surae.base.errors import InputError
from surae.base.setting import settings_of
from surae.estimators import names_of
from surae.inference.saved.fit_json import as_dict
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES
from surae.settings import FIT_RECORDS
from surae.studies import virtual_subject, virtual_trial

sys.path.append(str(Path(__file__).parents[2] / "docs" / "_ext"))
import options_table

#: What is not the fit: how it was asked for, by whom and how long it took.
ASKED = ("settings", "options", "seconds", "versions", "surae", "sha256")
EACH = [
    pytest.param(name, model, marks=() if options_table.refused(name, model) else pytest.mark.slow)
    for model in options_table.COLUMNS
    for name in options_table.TRIED
]


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    """A recording of raw signals, so that preparation has something to do."""
    motion = generate(Protocol(profile="multiple-holds", rate_hz=64.0, duration=12.0))
    made = virtual_trial(virtual_subject(3), motion, noise=0.3, seed=1)
    columns = {"time_s": made.time, "angle_rad": made.angle, "torque_Nm": made.torque}
    columns |= {f"emg_{m}_V": made.emg[:, i] for i, m in enumerate(MUSCLES)}
    path = tmp_path_factory.mktemp("option") / "trial.csv"
    surae.write_csv(path, columns, ["emg: envelope"])
    return path


@pytest.fixture(scope="module")
def fitted(trial):
    """What a model and keywords find: FIT.json but for how it was asked, and measures."""

    @cache
    def found(model: str, text: str) -> str:
        given = options[text]
        few = {} if model == "auto" or "starts" in given else {"starts": 1}
        fit = surae.fit(trial, model, quality=(), **few, **given)
        data = {k: v for k, v in as_dict(fit).items() if k not in ASKED}
        measures = {name: m.ci95 for name, m in fit.measures().items()}
        return json.dumps([data, measures], sort_keys=True, default=str)

    options: dict[str, dict[str, Any]] = {}

    def ask(model: str, given: dict[str, Any]) -> str:
        options[str(given)] = given
        return found(model, str(given))

    return ask


def test_every_option_is_tried():
    settings = {each.name for kind in FIT_RECORDS for each, _ in settings_of(kind)}
    tried = {name.partition(":")[0] for name in options_table.TRIED}
    assert tried == settings - {"model", "options"}


@pytest.mark.parametrize(("name", "model"), EACH)
def test_an_option_moves_the_fit_or_is_refused(name, model, fitted):
    tried = options_table.TRIED[name]
    if said := options_table.refused(name, model):
        assert said.startswith(f"{name} has no effect with model {model}")
        assert ";" in said
        assert "\n" not in said
        return
    without = dict(tried.beside)
    assert fitted(model, without | dict(tried.given)) != fitted(model, without)


@pytest.mark.parametrize("model", options_table.COLUMNS)
def test_what_nobody_gave_is_never_refused(model):
    settings = surae.FitSettings.of(model)
    assert surae.FitSettings.of(settings, seed=1).estimator == settings.estimator
    assert surae.FitSettings.of(model, **dict.fromkeys(names_of())) == settings


@pytest.mark.parametrize(
    ("model", "given", "says"),
    [
        ("auto", {"starts": 8}, "starts has no effect with model auto; leave it out, or name a"),
        ("auto", {"loss": "huber"}, "loss has no effect with model auto"),
        ("muscle", {"nuisances": "all"}, "nuisances has no effect with model muscle; .* auto"),
        (
            "muscle",
            {"emg_ref": (1e-4,) * 4},
            "emg_ref has no effect with model muscle; .*emg_shape",
        ),
        ("auto", {"x_ref_tri": 0.09}, "x_ref_tri has no effect with .* geometry thesis; .*virtual"),
        (
            "muscle",
            {"options": surae.ModelOptions(integrator="explicit-euler")},
            "integrator has no effect with model muscle",
        ),
    ],
)
def test_even_a_default_is_refused_where_it_is_given_in_vain(model, given, says):
    with pytest.raises(InputError, match=says):
        surae.FitSettings.of(model, **given)
