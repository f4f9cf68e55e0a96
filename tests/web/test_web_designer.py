"""Protocols before anybody is measured, and studies of virtual trials."""

import io
import time

import numpy as np
import pytest

from surae.estimation import fit_problem, make_problem
from surae.protocol import Protocol, generate, write_csv
from surae.studies import virtual_trial
from surae.web.designer import predicted, typical_subject

from .conftest import PATIENCE, least

SETTINGS = {"profile": "multi-sine-holds", "chirp_amplitude": 0.2, "chirp_rate": 0.3,
            "rate_hz": 64.0}  # fmt: skip


def test_predicted_errors_are_those_of_a_fit() -> None:
    motion = generate(Protocol(**SETTINGS))
    found = predicted(motion, "muscle", "healthy", 0.05)
    subject = typical_subject("healthy")
    trial = virtual_trial(subject, motion, noise=0.0)
    rng = np.random.default_rng(4)
    noisy = trial.torque + found["noise_Nm"] * rng.standard_normal(trial.n)
    from dataclasses import replace

    from surae.assessment import assess

    problem = make_problem([replace(trial, torque=noisy)], start=subject.parameters)
    fitted = assess(fit_problem(problem, starts=1))
    for one in found["parameters"]:
        assert fitted.parameters[one["name"]].sem == pytest.approx(one["sem"], rel=0.25)
    assert fitted.ipde == pytest.approx(found["ipde"], rel=0.1)


def test_a_preview_comes_in_seconds(browser) -> None:
    body = {"settings": {**SETTINGS, "device": "achilles"}, "model": "muscle-tendon"}
    answers = []

    def seconds() -> float:
        begin = time.perf_counter()
        answers.append(browser.post("/api/protocols/preview", json=body))
        return time.perf_counter() - begin

    assert least(seconds, 5.0) < 5.0
    found = answers[-1].json()
    assert len(found["t"]) == len(found["angle"]) == len(found["effort"][3]) <= 2000
    assert found["adaptation"]["device"] == "achilles"
    assert 0 < found["coverage"]["share"] < 1
    verdicts = {one["name"]: one["verdict"] for one in found["prediction"]["parameters"]}
    assert verdicts["dlt_tri"] == "fixed"
    assert verdicts["l0_tri"] == "identified"


@pytest.mark.parametrize(
    "change",
    [
        {"profile": "other"},
        {"task": "other"},
        {"device": "other"},
        {"range": [0.5, 0.4]},
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


def test_a_kept_protocol_is_the_command_lines_file(browser, tmp_path) -> None:
    made = browser.post("/api/protocols", json={"name": "mine", "settings": SETTINGS}).json()
    assert made["id"] in [one["id"] for one in browser.get("/api/protocols").json()["protocols"]]
    write_csv(generate(Protocol(**SETTINGS)), tmp_path / "p.csv")
    kept = browser.get(f"/api/protocols/{made['id']}/protocol.csv")
    assert kept.content == (tmp_path / "p.csv").read_bytes()
    assert "mine.csv" in kept.headers["content-disposition"]
    body = {"settings": SETTINGS}
    assert browser.post("/api/protocols/csv", json=body).content == kept.content
    assert browser.delete(f"/api/protocols/{made['id']}").status_code == 204


def test_a_study_runs_and_is_opened(browser) -> None:
    toml = (
        'name = "small"\nprotocol = ["sine", "multi-sine"]\nrate_hz = 20\nstarts = 1\n'
        "noise = 0.05\nsubjects = 2\n"
    )
    assert browser.post("/api/studies", json={"toml": "x = 1"}).status_code == 400
    made = browser.post("/api/studies", json={"toml": toml}).json()
    assert made["rows"] == 4
    end = time.monotonic() + PATIENCE
    while (now := browser.get(f"/api/studies/{made['id']}").json())["state"] in (
        "queued",
        "running",
        "new",
    ):
        assert time.monotonic() < end, now
        time.sleep(0.1)
    assert now["state"] == "done", now
    table = browser.get(f"/api/studies/{made['id']}/table").json()
    assert table["total"] == len(table["rows"]) == 4
    text = browser.get(f"/api/studies/{made['id']}/table.csv").text
    assert len(list(io.StringIO(text))) == 5
    figure = browser.get(f"/api/studies/{made['id']}/figure.svg", params={"x": "protocol"})
    assert figure.headers["content-type"].startswith("image/svg")
    assert browser.post(f"/api/studies/{made['id']}/start").status_code == 202
