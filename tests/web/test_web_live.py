"""Sliders: the same torque as `simulate`, at once."""

import numpy as np
import pytest

import surae
from surae.web.draft import empty_draft, fit_keywords

from .conftest import least


def test_a_slider_gives_the_torque_of_simulate(browser, recorded, trial) -> None:
    browser.change(recordings=[recorded], prepared=True, sliders={"k_tri": 180.0})
    body = {"values": {"l0_tri": 0.047}, "points": 2000, "parts": True}
    found = browser.post("/api/live", json=body).json()
    table = browser.get("/api/draft/parameters").json()["parameters"]
    values = {one["name"]: one["slider"] for one in table} | {"l0_tri": 0.047}
    assert values["k_tri"] == 180.0
    torque = surae.simulate("muscle", values, trial)
    assert found["modelled"] == pytest.approx(torque.tolist(), rel=1e-5, abs=1e-5)
    parts = np.sum([found["parts"][name] for name in found["parts"]], axis=0)
    assert parts == pytest.approx(torque, rel=1e-4, abs=1e-4)
    measured = surae.read(trial).channels["torque"].values
    error = measured - torque
    assert found["vaf"] == pytest.approx(100 * (1 - np.sum(error**2) / np.sum(measured**2)))
    assert browser.get("/api/draft").json()["draft"]["sliders"] == {"k_tri": 180.0}


@pytest.mark.parametrize("model", ["muscle", "muscle-2010", "muscle-tendon"])
def test_sliders_are_quick(browser, recorded, model) -> None:
    browser.change(recordings=[recorded], prepared=True, model=model)

    def milliseconds() -> float:
        answers = [
            browser.post("/api/live", json={"values": {"k_tri": 150.0 + i}}) for i in range(8)
        ]
        return float(np.median([one.json()["milliseconds"] for one in answers]))

    assert least(milliseconds, 50.0) < 50.0


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
    assert answer.json()["vaf"] is None


def test_a_draft_asks_for_what_the_command_line_asks_for() -> None:
    draft = empty_draft()
    assert fit_keywords(draft, {}) == {
        "model": "muscle", "fixed": {}, "free": (), "start": {}, "bounds": {}, "priors": {},
        "loss": None, "starts": 8, "seed": 0,
    }  # fmt: skip
    draft["model"] = "muscle-tendon"
    draft["parameters"] = {
        "m": {"free": False},
        "beta": {"free": False, "value": 1.0},
        "dlt_tri": {"free": True, "value": 0.05},
        "k_tri": {"lower": 50.0},
        "f0": {"prior": {"median": 2.0, "spread": 0.2}},
        "e1": {"free": False, "value": 3.0},
    }
    draft["population"] = "patient"
    found = fit_keywords(draft, {})
    assert found["fixed"] == {"m": 2.0, "beta": 1.0}
    assert found["free"] == ("dlt_tri",)
    assert found["start"] == {"dlt_tri": 0.05}
    assert found["bounds"] == {"k_tri": (50.0, 600.0)}
    assert found["priors"] == ("patient", {"f0": (2.0, 0.2)})
