"""An EMG delay and a stretch reflex: switched on, moved, fitted; and a fit that is followed."""

from typing import Any

import numpy as np
import pytest

import surae
from surae.model import get_model
from surae.model.registry import with_optional
from surae_workbench.web import fit_progress

REFLEX = ("reflex_tri", "reflex_tib", "reflex_delay")


def names(browser) -> dict[str, dict]:
    return {
        parameter["name"]: parameter
        for parameter in browser.get("/api/draft/parameters").json()["parameters"]
    }


def test_a_drive_is_in_the_table_while_it_is_mentioned(browser, recorded) -> None:
    emd, reflex = browser.get("/api/models").json()["drives"]
    assert emd == {"name": "emd", "label": "Estimate an EMG delay", "parameters": ["emd"]}
    assert reflex["parameters"] == list(REFLEX)
    browser.change(recordings=[recorded], prepared=True)
    assert not names(browser).keys() & {"emd", *REFLEX}
    refused = browser.post("/api/live", json={"values": {"emd": 0.04}})
    assert refused.status_code == 400
    browser.change(parameters={"emd": {"free": True}, **{n: {"free": True} for n in REFLEX}})
    listed = names(browser)
    assert listed.keys() > {"emd", *REFLEX, "m"}
    assert [n for n, row in listed.items() if row["optional"]] == ["emd", *REFLEX]
    assert listed["emd"]["free"] is True
    browser.change(parameters={"emd": {}})  # held at its default: still there
    assert names(browser)["emd"]["free"] is False
    browser.change(parameters={"emd": None, **dict.fromkeys(REFLEX)})
    assert not names(browser).keys() & {"emd", *REFLEX}


def test_a_slider_moves_the_delay(browser, recorded, trial) -> None:
    browser.change(recordings=[recorded], prepared=True, parameters={"emd": {"free": True}})
    answer = browser.post("/api/live", json={"values": {"emd": 0.08}, "points": 2000}).json()
    values = {name: parameter["slider"] for name, parameter in names(browser).items()} | {
        "emd": 0.08
    }
    torque = surae.simulate("muscle", values, trial)
    assert answer["modelled"] == pytest.approx(torque.tolist(), rel=1e-5, abs=1e-5)
    still = browser.post("/api/live", json={"values": {}, "points": 2000}).json()
    assert still["modelled"] != answer["modelled"]


def test_a_fit_that_goes_through_a_simpler_model_is_drawn(browser, recorded, trial) -> None:
    """As it goes on a fit tells its own model, and all values of it."""
    browser.change(recordings=[recorded], prepared=True, model="muscle-tendon")
    spec = with_optional(get_model("muscle"), ("emd",))
    values = {p.name: 0.1 if p.name == "emd" else p.start for p in spec.parameters}
    body = {"model": "muscle", "values": values, "points": 2000}
    drawn = browser.post("/api/live", json=body).json()["modelled"]
    assert drawn == pytest.approx(surae.simulate("muscle", values, trial).tolist(), 1e-5, 1e-5)


def test_a_fit_tells_of_its_better_points(monkeypatch) -> None:
    told: list[dict[str, Any]] = []
    monkeypatch.setattr(fit_progress, "tell", lambda message: told.append(dict(message)))
    following, spec = fit_progress.FitProgress(3), get_model("muscle")
    values = np.array([p.start for p in spec.parameters])
    for _ in range(5):  # at once: only the first is told
        following.point(spec, values, 1.0)
    following.start(1, 3, 1.0)
    assert [(m["done"], m["iteration"], m["model"]) for m in told] == [
        (0, 1, "muscle"),
        (1, 5, "muscle"),
    ]
    assert told[0]["values"]["m"] == pytest.approx(values[spec.names.index("m")])
