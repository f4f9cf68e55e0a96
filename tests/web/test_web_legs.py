"""Sessions in the workbench: the trials of a leg are sorted, fitted and crossed as by `surae`."""

import re

import numpy as np
import pytest

import surae
from surae.protocol import Protocol, generate
from surae.recording import read, write_csv
from surae.report import part_of
from surae.studies import virtual_subject, virtual_trial
from undrawn import blank_figures

MUSCLES = ("ta", "gl", "sol", "gm")


@pytest.fixture(scope="session")
def files(tmp_path_factory):
    """Two trials that move, and one that holds still."""
    folder = tmp_path_factory.mktemp("leg")
    motion = generate(
        Protocol(profile="multiple-holds", chirp_amplitude=0.2, rate_hz=64.0, duration=12.0)
    )
    made = []
    for seed, name in enumerate(("walk one", "walk two", "hold")):
        trial = virtual_trial(virtual_subject(3), motion, seed=seed)
        angle = 0.1 + 0.001 * trial.angle if name == "hold" else trial.angle
        table = {"time_s": trial.time, "angle_rad": angle, "torque_Nm": trial.torque}
        table |= {f"emg_{m}_V": np.maximum(trial.emg[:, i], 0) for i, m in enumerate(MUSCLES)}
        made.append(folder / f"{name}.csv")
        write_csv(made[-1], table, ["emg: envelope"])
    return made


@pytest.fixture(scope="session")  # the server is one: a name comes once
def imported(server, files):
    browser = server.browser()
    return {path.stem: browser.recording(path) for path in files}


def test_trials_are_sorted_and_an_effort_can_be_told(browser, imported) -> None:
    asked = {"recordings": list(imported.values())}
    told = {t["name"]: t for t in browser.post("/api/sessions/trials", json=asked).json()["trials"]}
    assert [told[name]["fitted"] for name in imported] == [True, True, False]
    assert "holds still" in told["hold"]["what"]
    assert told["hold"]["use"] == "torque at a held angle"
    asked["efforts"] = {imported["hold"]: "maximal"}
    told = {t["name"]: t for t in browser.post("/api/sessions/trials", json=asked).json()["trials"]}
    assert told["hold"]["use"] == "reference for EMG"
    assert told["hold"]["stated"]


@pytest.mark.slow
def test_a_session_is_that_of_surae(browser, imported, files) -> None:
    browser.change(recordings=[], prepared=True, starts=1)
    asked = {"recordings": list(imported.values()), "name": "leg"}
    job = browser.job(browser.post("/api/sessions", json=asked))
    assert job["state"] == "done", job
    told = browser.get(f"/api/sessions/{job['result']}").json()
    result = surae.session([read(path) for path in files], name="leg").run(
        model="muscle", prepared=True, starts=1
    )
    assert told["summary"]["grade"] == str(result.joint.adequacy.grade)
    shown = browser.get(f"/sessions/{job['result']}").text
    with blank_figures():  # the words are compared
        ours = part_of(**result.blocks())
    article = shown[shown.index('<article class="report"') :]
    assert text_of(ours) == text_of(article.partition(">")[2])
    assert "<h2" in article  # blocks, and no text of them
    assert ".report {" in browser.get("/report.css").text
    names = {fit["name"] for fit in browser.get("/api/fits").json()["fits"]}
    assert names >= {"leg · walk one", "leg · walk two", "leg · all together"}
    joint = browser.get(f"/api/fits/{told['summary']['fit']}").json()
    assert joint["summary"]["recordings"] == [imported["walk one"], imported["walk two"]]
    page = browser.get(f"/api/sessions/{job['result']}/report.html?language=de")
    assert "Wie steif ist es?" in page.text
    assert told["visits"] == []
    compared_with_another_visit(browser, imported, job["result"])
    (listed,) = browser.get("/api/sessions").json()["sessions"]
    assert (listed["name"], listed["trials"]) == ("leg", 3)
    assert listed["fit"] == told["summary"]["fit"]
    assert browser.delete(f"/api/sessions/{job['result']}").status_code == 204
    assert browser.get("/api/sessions").json()["sessions"] == []
    assert browser.get(f"/api/fits/{told['summary']['fit']}").status_code == 200


def compared_with_another_visit(browser, imported, id_):
    """A visit is named, dated and compared; the comparison is kept, and is in files of a report."""
    place = f"/api/sessions/{id_}"
    assert browser.patch(place, json={"visit": "2026-13-01"}).status_code == 422
    assert browser.patch(place, json={"before": id_}).status_code == 400
    code = browser.post("/api/subjects", json={"code": "V1"}).json()["id"]
    told = {"name": "ankle", "side": "left", "visit": "2026-03-02", "subject": code}
    patched = browser.patch(place, json=told).json()
    assert {key: patched[key] for key in told} == told
    assert browser.get(f"/api/recordings/{imported['hold']}").json()["visit"] == "2026-03-02"
    asked = {"recordings": [imported["walk one"]], "name": "later", "question": "end_stiffness"}
    assert browser.post("/api/sessions", json=asked | {"question": "luck"}).status_code == 422
    other = browser.job(browser.post("/api/sessions", json=asked))["result"]
    assert browser.get(f"{place}/change").json() == {"html": ""}
    assert browser.patch(place, json={"before": other}).json()["before"] == other
    assert "Measures fixed beforehand" in browser.get(f"{place}/change").json()["html"]
    later = browser.patch(f"/api/sessions/{other}", json={"before": id_}).json()
    assert later["question"] == "end_stiffness"  # it was asked before anybody saw this visit
    assert browser.get(f"/api/sessions/{other}/change").json()["html"]
    browser.patch(place, json={"visit": None})
    refused = browser.get(f"{place}/change")
    assert (refused.status_code, "on which day" in refused.json()["error"]) == (400, True)
    assert browser.get(f"/api/sessions/{id_}").json()["summary"]["visit"] == ""
    browser.patch(place, json={"visit": "2026-03-02"})
    page = browser.get(f"{place}/report.html?language=de")
    assert "later → ankle" in page.text
    assert 'filename="ankle-2026-03-02-de.html"' in page.headers["content-disposition"]
    (row,) = (r for r in browser.get("/api/cohort").json()["rows"] if r["name"] == "ankle")
    assert row["measures"]["end_stiffness"]["value"] > 0.0
    assert browser.delete(f"/api/sessions/{other}").status_code == 204
    assert browser.get(f"{place}/change").json() == {
        "html": ""
    }  # what it was compared with is gone
    browser.patch(place, json={"name": "leg"})


def test_what_no_session_can_be_made_of_is_refused(browser, imported) -> None:
    moving, still = imported["walk one"], imported["hold"]
    refused = browser.post("/api/sessions", json={"recordings": [still]})
    assert (refused.status_code, "moves" in refused.json()["error"]) == (400, True)
    browser.change(exclusions={moving: [[1.0, 2.0]]})
    refused = browser.post("/api/sessions", json={"recordings": [moving, still]})
    assert refused.status_code == 400
    assert "left out" in refused.json()["error"]
    browser.change(exclusions={moving: None})


def text_of(page):
    """What a reader reads of a page's report."""
    body = page.partition("</article>")[0]
    return " ".join(re.sub(r"<[^>]+>", " ", body).split())
