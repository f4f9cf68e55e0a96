"""An EMG delay and a stretch reflex: switched on, moved, fitted; and a fit that is followed."""

from typing import Any

import numpy as np
import pytest

import surae
from surae.model import get_model
from surae.model.registry import with_optional
from surae.protocol import Protocol, generate
from surae.settings import FitSettings
from surae.signals import thinned, thinning_factor
from surae.studies import virtual_subject, virtual_trial
from surae_workbench.web.fit_progress import FitProgress

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


@pytest.fixture(scope="module")
def chirped():
    protocol = Protocol(
        profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=125.0
    )
    return virtual_trial(virtual_subject(1), generate(protocol), noise=0.0)


@pytest.fixture
def told(monkeypatch) -> list[dict[str, Any]]:
    """What the process that makes a fit tells its parent."""
    messages: list[dict[str, Any]] = []
    monkeypatch.setattr("surae_workbench.web.fit_progress.tell", messages.append)
    return messages


def test_a_chirp_is_followed_with_all_its_peaks(chirped, told) -> None:
    following = FitProgress([chirped], ["a" * 16], FitSettings(starts=1))
    spec = get_model("muscle")
    following.point(spec, np.array([p.start for p in spec.parameters]), 1.0)
    (trace,) = told[0]["traces"]
    assert 400 < len(trace["t"]) == len(trace["measured"]) == len(trace["modelled"]) <= 1000
    whole = thinned(chirped, thinning_factor(chirped, 60.0, 500)).torque
    shown = np.array(trace["measured"])
    assert (shown.min(), shown.max()) == pytest.approx((whole.min(), whole.max()), rel=1e-5)
    # Up and down as often and as far, but for the last, fastest swings; every fifth sample alone
    # would show a slower chirp, of a fifth of the way.
    way = np.abs(np.diff(shown)).sum() / np.abs(np.diff(whole)).sum()
    assert 0.8 < way <= 1.0


def test_a_drive_joins_a_fit_that_is_under_way(chirped, told) -> None:
    following = FitProgress([chirped], ["a" * 16], FitSettings(starts=1))
    plain = get_model("muscle")
    driven = with_optional(plain, ("emd",))
    for spec in (plain, driven):
        following._last = 0.0
        values = np.array([0.1 if p.name == "emd" else p.start for p in spec.parameters])
        following.point(spec, values, 1.0)
    first, second = (line["traces"][0]["modelled"] for line in told)
    assert first != second
    assert told[1]["values"]["emd"] == 0.1


def test_many_recordings_share_the_points(chirped, told) -> None:
    ids = [f"{i:016x}" for i in range(20)]
    following = FitProgress([chirped] * 20, ids, FitSettings(starts=1))
    spec = get_model("muscle")
    following.point(spec, np.array([p.start for p in spec.parameters]), 1.0)
    assert all(len(trace["t"]) <= 400 for trace in told[0]["traces"])
