"""Fits asked for over HTTP: the same as from Python, followed, stopped, killed."""

import os
import signal
import time

import pytest

from .conftest import PATIENCE


def small(browser, recording: str, **change) -> None:
    browser.change(recordings=[recording], prepared=True, starts=1, **change)


def test_a_fit_is_followed(browser, recorded) -> None:
    small(browser, recorded)
    _, events = browser.followed()
    assert events[0][0] == "state"
    assert events[-1][0] == "end"
    assert events[-1][1]["state"] == "done"
    news = [data for event, data in events if event == "progress" and "values" in data]
    assert news, events
    assert set(news[-1]["values"]) >= {"m", "k_tri", "beta"}
    assert followed_closely(browser, news[-1]) > 90


def followed_closely(browser, news: dict) -> float:
    """How closely a fit follows the torque by now, as its page shows it."""
    body = {"model": news["model"], "values": news["values"]}
    return browser.post("/api/live", json=body).json()["r2"] or 0.0


def long(browser, recording: str) -> dict:
    """A fit that takes far longer than a test."""
    browser.change(recordings=[recording], prepared=True, starts=1000, model="muscle-tendon")
    return browser.post("/api/fits", json={}).json()


def wait(browser, id_: str, state: str) -> dict:
    """The job in a state; one that runs, once its own model is better than where it began.

    The search goes through a simpler model first, which may follow the torque more closely.
    """
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        job = browser.get(f"/api/jobs/{id_}").json()
        progress = job["progress"] or {}
        ahead = (
            progress.get("model") == "muscle-tendon" and followed_closely(browser, progress) > 60.0
        )
        if job["state"] == state and (state != "running" or ahead):
            return job
        time.sleep(0.05)
    raise AssertionError(job)


@pytest.mark.slow
def test_jobs_wait_in_a_line_and_end_alone(server, recorded) -> None:
    """Of two that run one is killed, and the other is stopped and keeps the best so far."""
    browser = server.browser()
    stopped, killed, waiting = (long(browser, recorded)["id"] for _ in range(3))
    assert browser.get(f"/api/jobs/{waiting}").json()["position"] == 1
    active = browser.get("/api/jobs", params={"active": True}).json()["jobs"]
    assert {stopped, killed, waiting} <= {job["id"] for job in active}
    assert server.browser().get(f"/api/jobs/{stopped}").json()["mine"] is False
    wait(browser, stopped, "running")
    assert browser.post(f"/api/jobs/{waiting}/cancel").status_code == 200
    wait(browser, waiting, "cancelled")
    os.kill(server.bench.jobs._workers[killed].process, signal.SIGKILL)
    ended = wait(browser, killed, "failed")
    assert ended["result"] is None
    assert "killed or crashed" in ended["message"]
    small(browser, recorded)
    beside = browser.post("/api/fits", json={})
    assert browser.job(beside)["state"] == "done"  # by the worker whose process is another now
    assert browser.post(f"/api/jobs/{stopped}/cancel").status_code == 200
    ended = wait(browser, stopped, "cancelled")
    fit = browser.get(f"/api/fits/{ended['result']}").json()
    assert fit["summary"]["r2"] > 50
    kept = browser.get(f"/api/fits/{ended['result']}/fit.json").text
    assert "stopped by the user" in kept
    assert browser.post(f"/api/jobs/{stopped}/cancel").status_code == 409


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"recordings": []}, "choose"),
        ({"parameters": {"m": {"lower": 3.0, "upper": 1.0}}}, "bounds of m"),
        ({"parameters": {"m": {"free": False, "value": -1.0}}}, "m is -1"),
        ({"exclusions": None}, "leave no sample"),
    ],
)
def test_a_draft_that_cannot_be_fitted_is_refused_at_once(browser, recorded, change, says) -> None:
    small(browser, recorded)
    if change == {"exclusions": None}:
        change = {"exclusions": {recorded: [[-1.0, 100.0]]}}
    browser.change(**change)
    answer = browser.post("/api/fits", json={})
    assert answer.status_code == 400
    assert says in answer.json()["error"]
    told = browser.get("/api/draft/parameters").json()
    assert says in told["problem"]


def test_a_fit_is_understood(browser, recorded) -> None:
    small(browser, recorded, exclusions={recorded: [[3.0, 4.0]]})
    job = browser.job(browser.post("/api/fits", json={}))
    id_ = job["result"]
    fit = browser.get(f"/api/fits/{id_}").json()
    assert fit["summary"]["title"] == "muscle model [1.0]"  # people read names, no ids
    assert fit["settings"]["exclusions"] == {recorded: [[3.0, 4.0]]}
    page = browser.get(f"/fits/{id_}").text
    for said in (
        "Estimates of all parameters with their uncertainty",
        "data:image/png;base64,",
        'id="signals"',
    ):
        assert said in page  # the page shows the report itself
    body = {"recordings": [recorded]}
    predicted = browser.post(f"/api/fits/{id_}/validate", json=body).json()["html"]
    assert "Predicting other recordings" in predicted
    assert "data:image/png;base64," in predicted
    profiled = browser.post(f"/api/fits/{id_}/profile", json={"parameters": ["m"]})
    assert profiled.json()["fit"] == id_
    assert profiled.json()["recordings"] == [recorded]
    assert browser.job(profiled)["state"] == "done"
    profile = browser.get(f"/api/fits/{id_}").json()["profiles"]["m"]
    assert profile["lower"] < fit["parameters"]["m"]["value"] < profile["upper"]
    assert browser.post(f"/api/fits/{id_}/profile", json={"parameters": ["x"]}).status_code == 400
    rows = browser.get("/api/cohort").json()["rows"]
    assert any(row["fit"] == id_ for row in rows)
    table = browser.get("/api/cohort.csv").text.splitlines()
    assert table[0].startswith("subject,group,side")
    assert "muscle model [1.0]" in table[1]  # people read names; the id stands beside it
    assert len(table) == len(rows) + 1
    assert browser.delete(f"/api/fits/{id_}").status_code == 204
    assert browser.get(f"/api/fits/{id_}").status_code == 404
