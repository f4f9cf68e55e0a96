"""Protocols before anybody is measured, and studies of virtual trials."""

import io
import time

import numpy as np
import pytest

import surae
from surae.base.names import FITTED
from surae.protocol import Protocol, generate, named_device, write_protocol_csv

from .conftest import PATIENCE, least

SETTINGS = {
    "profile": "multi-sine-holds",
    "chirp_amplitude": 0.2,
    "chirp_rate": 0.3,
    "rate_hz": 64.0,
}


def test_a_preview_comes_in_seconds(browser) -> None:
    body = {"settings": {**SETTINGS, "device": "achilles"}, "model": "muscle-tendon"}
    answers = []

    def seconds() -> float:
        begin = time.perf_counter()
        answers.append(browser.post("/api/protocols/preview", json=body))
        return time.perf_counter() - begin

    assert least(seconds, 5.0) < 5.0
    shown = answers[-1].json()
    assert len(shown["t"]) == len(shown["angle"]) == len(shown["effort"][3]) <= 2000
    assert any(step["given"].get("device") == "achilles" for step in shown["adaptation"])
    told = shown["prediction"]["parameters"]
    assert "dlt_tri" not in told  # model 2.0 takes it for known
    assert told["l0_tri"]["verdict"] == "weak"  # it rests on arms and paths
    velocity = next(limit for limit in shown["limits"] if "velocity" in limit["text"])
    assert not velocity["exceeded"]
    assert "°/s, within the 85.9 °/s of achilles" in velocity["text"]


def test_the_page_opens_on_a_movement_that_its_device_holds(browser) -> None:
    """It once opened on 130 Nm of the 80 that its device holds, and did not offer `auto`."""
    choices = browser.get("/api/protocols/choices").json()
    assert [one["name"] for one in choices["models"]] == list(FITTED)
    assert choices["start"]["model"] == "auto"
    assert choices["start"]["settings"]["device"] == "achilles"
    shown = browser.post("/api/protocols/preview", json=choices["start"])
    assert shown.status_code == 200, shown.text
    assert [limit["text"] for limit in shown.json()["limits"] if limit["exceeded"]] == []
    allowed = browser.post("/api/protocols/csv", json={"settings": choices["start"]["settings"]})
    assert allowed.status_code == 200, allowed.text


def test_a_movement_is_seen_before_what_it_would_tell(browser) -> None:
    start = browser.get("/api/protocols/choices").json()["start"] | {"model": "muscle"}
    seen = browser.post("/api/protocols/preview", json=start | {"predict": False}).json()
    whole = browser.post("/api/protocols/preview", json=start).json()
    assert seen["prediction"] is None
    assert whole["prediction"]["parameters"]
    assert all(seen[key] == whole[key] for key in seen.keys() - {"prediction"})


def test_a_preview_says_what_an_expectation_says(browser) -> None:
    body = {
        "settings": {**SETTINGS, "device": "achilles"},
        "model": "muscle",
        "population": "healthy",
        "noise": 1.0,
    }
    shown = browser.post("/api/protocols/preview", json=body).json()["prediction"]
    motion = generate(Protocol(**SETTINGS, device=named_device("achilles")))
    told = surae.expect(motion, "muscle", population="healthy", noise=1.0, legs=6).to_json()
    assert {name: shown[name] for name in told} == told


@pytest.mark.slow
def test_a_film_narrows_what_a_plan_would_tell(browser) -> None:
    start = browser.get("/api/protocols/choices").json()["start"]
    plain, filmed = (
        browser.post("/api/protocols/preview", json=start | {"film": film}).json()["prediction"]
        for film in ("", "tib")
    )
    l0 = [each["parameters"]["l0_tib"]["relative_sem"] for each in (plain, filmed)]
    assert l0[1] < l0[0]
    refused = browser.post("/api/protocols/preview", json=start | {"film": "heart"})
    assert refused.status_code == 400


def test_nothing_is_exported_beyond_limits_or_without_a_device_but_for_a_reason(browser) -> None:
    for device, words in ((None, "No device"), ("achilles", "torque of virtual legs")):
        body = {"settings": {**SETTINGS, "device": device}}
        refused = browser.post("/api/protocols/csv", json=body)
        assert refused.status_code == 400
        assert words in refused.json()["error"]
        given = browser.post("/api/protocols/csv", json=body | {"reason": "a simulation"})
        assert given.content.startswith(b"# without limits: a simulation\n")
    gentle = {
        **SETTINGS,
        "profile": "sine",
        "task": "passive",
        "chirp_amplitude": 0.0,
        "angle_range": [-0.6, 0.2],
        "device": "achilles",
    }
    allowed = browser.post("/api/protocols/csv", json={"settings": gentle})
    assert allowed.status_code == 200
    assert allowed.content.startswith(b"time_s")


@pytest.mark.parametrize(
    "change",
    [
        {"profile": "other"},
        {"device": "other"},
        {"angle_range": [0.5, 0.4]},
        {"chirp_amplitude": 2.0},
        {"duration": 600.0, "rate_hz": 2000.0, "profile": "sine"},
        {"rate_hz": 1e-3},
    ],
)
def test_impossible_protocols_are_refused(browser, change) -> None:
    body = {"settings": {**SETTINGS, **change}}
    answer = browser.post("/api/protocols/preview", json=body)
    assert answer.status_code == 400, answer.text
    assert "\n" not in answer.json()["error"]


@pytest.mark.parametrize(
    "change", [{"task": "other"}, {"chirp_rate": -1.0}, {"rate_hz": 0}, {"duration": 601.0}]
)
def test_a_protocol_keeps_to_the_limits_of_its_settings(browser, change) -> None:
    answer = browser.post("/api/protocols/preview", json={"settings": {**SETTINGS, **change}})
    assert answer.status_code == 422, answer.text
    assert next(iter(change)) in answer.json()["error"]


def test_a_protocol_of_an_older_project_keeps_its_range(browser, server) -> None:
    old = {"name": "old", "settings": {"profile": "sine", "task": "passive", "range": [-0.6, 0.2]}}
    id_ = server.bench.database.add("protocol", old)
    kept = {p["id"]: p["settings"] for p in browser.get("/api/protocols").json()["protocols"]}[id_]
    assert kept["angle_range"] == [-0.6, 0.2]
    assert kept["rate_hz"] == Protocol(profile="sine").rate_hz
    assert browser.post("/api/protocols/csv", json={"settings": kept, "reason": "x"}).is_success
    browser.delete(f"/api/protocols/{id_}")


def test_a_kept_protocol_is_the_command_lines_file(browser, tmp_path) -> None:
    made = browser.post("/api/protocols", json={"name": "mine", "settings": SETTINGS}).json()
    assert made["id"] in [kept["id"] for kept in browser.get("/api/protocols").json()["protocols"]]
    note = "without limits: no robot"
    write_protocol_csv(generate(Protocol(**SETTINGS)), tmp_path / "p.csv", note=note)
    body = {"settings": made["settings"], "name": made["name"]}
    assert browser.post("/api/protocols/csv", json=body).status_code == 400
    kept = browser.post("/api/protocols/csv", json=body | {"reason": "no robot"})
    assert kept.content == (tmp_path / "p.csv").read_bytes()
    assert "mine.csv" in kept.headers["content-disposition"]
    assert browser.delete(f"/api/protocols/{made['id']}").status_code == 204


def test_a_protocol_is_designed_in_the_browser(browser) -> None:
    asked = {
        "device": "achilles",
        "angle_range": [-0.6, 0.3],
        "rate_hz": 64.0,
        "durations": [10, 12],
        "model": "muscle",
        "evaluations": 15,
        "aim": "mean",
        "population": "healthy",
    }
    job = browser.job(browser.post("/api/protocols/design", json=asked))
    assert job["state"] == "done", job
    assert "largest error" in job["message"]
    kept = {p["name"]: p for p in browser.get("/api/protocols").json()["protocols"]}
    made = kept["designed 12 s mean"]
    assert "designed 10 s mean" in kept
    shown = browser.post("/api/protocols/preview", json={"settings": made["settings"]}).json()
    assert shown["seconds"] == 12.0
    assert not any(limit["exceeded"] for limit in shown["limits"])
    told = surae.design(
        12.0,
        model="muscle",
        angle_range=(-0.6, 0.3),
        rate_hz=64.0,
        aim="mean",
        evaluations=15,
        population="healthy",
        noise=0.5,
    )
    exported = browser.post("/api/protocols/csv", json={"settings": made["settings"]})
    lines = exported.text.splitlines()
    angle = np.array([line.split(",")[1] for line in lines[1:]], float)
    np.testing.assert_allclose(angle, told.trajectory.angle, atol=1e-9)
    for kept_one in kept.values():
        browser.delete(f"/api/protocols/{kept_one['id']}")


@pytest.mark.slow
def test_a_design_that_is_stopped_keeps_the_best_so_far(browser) -> None:
    asked = {
        "device": "achilles",
        "angle_range": [-0.6, 0.3],
        "rate_hz": 64.0,
        "durations": [11.0],
        "evaluations": 12000,
    }
    job, end = browser.post("/api/protocols/design", json=asked).json(), time.monotonic() + PATIENCE
    while not ((job["progress"] or {}).get("done") or 0) > 0:
        assert time.monotonic() < end, job
        time.sleep(0.05)
        job = browser.get(f"/api/jobs/{job['id']}").json()
    assert browser.post(f"/api/jobs/{job['id']}/cancel").status_code == 200
    while job["state"] in ("queued", "running"):
        assert time.monotonic() < end, job
        time.sleep(0.05)
        job = browser.get(f"/api/jobs/{job['id']}").json()
    assert job["state"] == "cancelled"
    assert "largest error" in job["message"]
    kept = [one["name"] for one in browser.get("/api/protocols").json()["protocols"]]
    assert "designed 11 s worst" in kept


def test_a_plan_that_breaks_the_limits_is_told_and_not_exported(browser) -> None:
    plan = {
        "name": "wild",
        "seconds": 10.0,
        "origin": 0.0,
        "blend": 0.1,
        "ramps": [[1.0, 1.0, 9.0]],
        "shakes": [],
        "bursts": [],
    }
    settings = {
        "profile": "designed",
        "device": "achilles",
        "plan": plan,
        "angle_range": [-0.9, 0.6],
        "limits": [-0.9, 0.6, 1e3, 1e3],
        "rate_hz": 64.0,
    }
    shown = browser.post("/api/protocols/preview", json={"settings": settings}).json()
    assert [x for x in shown["limits"] if x["exceeded"] and "velocity" in x["text"]]
    assert browser.post("/api/protocols/csv", json={"settings": settings}).status_code == 400
    for broken in (
        {"limits": [0.6, -0.9, 1, 1]},
        {"plan": {**plan, "ramps": [[1, 1, 0]]}},
        {"limits": [-9, 9, 1, 1]},
    ):
        answer = browser.post("/api/protocols/preview", json={"settings": settings | broken})
        assert answer.status_code in (400, 422), answer.text


@pytest.mark.slow
def test_a_study_runs_and_is_opened(browser) -> None:
    toml = (
        'name = "small"\nprotocol = ["sine", "multi-sine"]\nrate_hz = 20\nstarts = 1\n'
        "noise = 0.05\nsubjects = 2\n"
    )
    assert browser.post("/api/studies", json={"toml": "x = 1"}).status_code == 400
    made = browser.post("/api/studies", json={"toml": toml}).json()
    assert made["rows"] == 4
    end = time.monotonic() + PATIENCE
    now = made
    while now["state"] in ("queued", "running", "new"):
        assert time.monotonic() < end, now
        time.sleep(0.1)
        studies = browser.get("/api/studies").json()["studies"]
        (now,) = (study for study in studies if study["id"] == made["id"])
    assert now["state"] == "done", now
    assert now["done"] == 4
    text = browser.get(f"/api/studies/{made['id']}/table.csv").text
    assert len(list(io.StringIO(text))) == 5
    assert browser.post(f"/api/studies/{made['id']}/start").status_code == 202
