"""Sliders: the same torque as `simulate`, at once."""

import numpy as np
import pytest

import surae
from surae.model import MODELS
from surae.settings import FitSettings
from surae.signals import Weighting
from surae_workbench.web.draft import changed, empty_draft, settings_of, shown, upgraded


def test_a_slider_gives_the_torque_of_simulate(browser, recorded, trial) -> None:
    browser.change(recordings=[recorded], prepared=True, sliders={"k_tri": 180.0})
    body = {"values": {"l0_tri": 0.047}, "points": 2000}
    answer = browser.post("/api/live", json=body).json()
    table = browser.get("/api/draft/parameters").json()["parameters"]
    values = {row["name"]: row["slider"] for row in table} | {"l0_tri": 0.047}
    assert values["k_tri"] == 180.0
    torque = surae.simulate("muscle", values, trial)
    assert answer["modelled"] == pytest.approx(torque.tolist(), rel=1e-5, abs=1e-5)
    measured = surae.read(trial).channels["torque"].values
    error = measured - torque
    assert answer["r2"] == pytest.approx(
        100 * (1 - np.sum(error**2) / np.sum((measured - measured.mean()) ** 2))
    )
    assert browser.get("/api/draft").json()["draft"]["sliders"] == {"k_tri": 180.0}


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ({"values": {"x": 1.0}}, "no parameter 'x'"),
        ({"values": {"k_tri": -1.0}}, "k_tri"),
        ({"recording": "0" * 16}, "no such recording"),
    ],
)
def test_wrong_values_are_refused(browser, recorded, body, says) -> None:
    browser.change(recordings=[recorded], prepared=True)
    answer = browser.post("/api/live", json=body)
    assert answer.status_code in (400, 404)
    assert says in answer.json()["error"]


def test_values_that_overflow_are_no_server_error(browser, recorded) -> None:
    browser.change(recordings=[recorded], prepared=True)
    body = {"values": {"k_tri": 1e12, "x0_tri": 1e-9}}
    answer = browser.post("/api/live", json=body)
    assert answer.status_code == 200
    assert answer.json()["r2"] is None


def test_a_draft_is_a_request() -> None:
    draft = empty_draft()
    assert settings_of(draft, ["a"]) == FitSettings()
    rows = {
        "m": {"free": False},
        "beta": {"free": False, "value": 1.0},
        "dlt_tri": {"free": True, "value": 0.05},
        "k_tri": {"lower": 50.0},
        "f0": {"prior": {"median": 2.0, "spread": 0.2}},
        "e1": {"free": False, "value": 3.0},
    }
    change = {"model": "muscle-tendon", "population": "patient", "parameters": rows}
    draft = changed(draft, change)
    asked = settings_of(draft, ["a"])
    assert asked == FitSettings.of(
        "muscle-tendon",
        fixed={"m": 2.0, "beta": 1.0},
        free=("dlt_tri",),
        start={"dlt_tri": 0.05},
        bounds={"k_tri": (50.0, 600.0)},
        priors=("patient", {"f0": (2.0, 0.2)}),
    )
    assert shown(draft)["parameters"] == {
        **rows,
        "m": {"free": False, "value": 2.0},
        "k_tri": {"lower": 50.0, "upper": 600.0},
    }
    draft = changed(draft, {"exclusions": {"b": [[1, 2]]}, "parameters": {"beta": None}})
    assert settings_of(draft, ["a"]) == FitSettings.of(asked, fixed={"m": 2.0})
    alone = settings_of(draft, ["b"]).weights
    assert alone == Weighting(((1.0, 2.0, 0.0),))
    assert settings_of(draft, ["a", "b"]).weights == (Weighting(), alone)


@pytest.mark.parametrize("model", MODELS)
def test_another_model_is_asked_what_it_has_parameters_for(model) -> None:
    given = {"fixed": {"beta": 1.0}, "free": ["emd", "reflex", "dlt_tri"], "start": {"m": 2.1}}
    settings = settings_of({**empty_draft(), **given, "model": model}, ["a"])
    names = MODELS[model].names
    assert settings.model == model
    assert set(settings.fixed) == {"beta"} & {*names}
    assert settings.free == ("emd", "reflex", *({"dlt_tri"} & {*names}))
    assert set(settings.start) == {"m"} & {*names}


def test_of_a_draft_what_is_not_known_is_left_out() -> None:
    kept = {"recordings": ["a" * 16], "starts": 3, "peaks": 4.0, "seed": "x"}
    assert upgraded(kept) == empty_draft() | {"recordings": ["a" * 16], "starts": 3}
    for damaged in (None, [], {"parameters": 3}):
        assert upgraded(damaged) == empty_draft()
