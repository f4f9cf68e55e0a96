"""A recording of the virtual subject, for whoever has none; and what downloads are called."""

import numpy as np
import pytest

import surae
from surae.studies import virtual_subject
from surae_workbench.web.routes.common import attachment


def test_the_virtual_subject_can_be_tried(serve) -> None:
    browser = serve().browser()
    answers = [browser.post("/api/demo", json={}) for _ in range(2)]
    assert [answer.status_code for answer in answers] == [201, 201]
    first, second = (answer.json() for answer in answers)
    (subject,) = browser.get("/api/subjects").json()["subjects"]
    assert (subject["code"], subject["recordings"]) == ("virtual", 2)
    assert first["subject"] == second["subject"] == subject["id"]
    assert [first["trial"], second["trial"]] == ["T1", "T2"]
    assert first["emg"] == "raw"
    assert first["duration_s"] == pytest.approx(35.0, abs=10.0)
    assert {channel["role"] for channel in first["channels"]} >= {
        "angle",
        "torque",
        "emg_ta",
        "emg_sol",
    }

    both = [
        browser.get(f"/api/recordings/{finding['id']}/window", params={"signals": "torque"}).json()
        for finding in (first, second)
    ]
    torques = [np.array(recording["signals"][0]["v"]) for recording in both]
    assert not np.array_equal(*torques)
    finding = browser.get(f"/api/recordings/{first['id']}/quality").json()["findings"]
    assert [fault for fault in finding if fault["severity"] == "error"] == []
    browser.change(recordings=[first["id"]])
    assert browser.get("/api/draft/parameters").json()["problem"] is None


def test_the_virtual_subject_is_found_again_by_a_fit() -> None:
    fitted = surae.fit(surae.example(), "muscle", starts=2)
    assert fitted.status == "converged"
    assert 99.0 < fitted.vaf < 100.0
    true = virtual_subject(seed=1).parameters
    for name in ("m", "k_tri", "l0_tri"):
        assert fitted.parameters[name].value == pytest.approx(true[name], rel=0.1)


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("muscle · trial 1", "muscle-trial-1"),
        ("muscle · muscle, left", "muscle-muscle-left"),
        ('a_b/../c\r\n"', "a_b-c"),
        ("···", "surae"),
    ],
)
def test_downloads_have_tidy_names(name, file) -> None:
    assert attachment(name, ".json") == {
        "content-disposition": f'attachment; filename="{file}.json"'
    }
