"""A recording of the virtual subject, for whoever has none; and what downloads are called."""

import numpy as np
import pytest

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

    def torque(recording):
        path = f"/api/recordings/{recording['id']}/window"
        window = browser.get(path, params={"signals": "torque"}).json()
        return np.array(window["signals"][0]["v"])

    torques = [torque(recording) for recording in (first, second)]
    assert not np.array_equal(*torques)
    finding = browser.get(f"/api/recordings/{first['id']}/quality").json()["findings"]
    assert [fault for fault in finding if fault["severity"] == "error"] == []
    browser.change(recordings=[first["id"]])
    assert browser.get("/api/draft/parameters").json()["problem"] is None
    told = browser.get(f"/api/recordings/{first['id']}/description").json()["mapping"]
    told["channels"]["torque"]["offset"] = 3.0
    answer = browser.post("/api/descriptions", json={"recordings": [first["id"]], "mapping": told})
    assert answer.status_code == 200, answer.text
    assert torque(first) == pytest.approx(torques[0] + 3.0)


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
