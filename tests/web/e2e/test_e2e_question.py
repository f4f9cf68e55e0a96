"""What a second visit shall answer is asked before anybody has seen it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from surae.protocol import Protocol, generate
from surae.recording import write_csv
from surae.studies import virtual_subject, virtual_trial

from .conftest import MUSCLES, WHOLE, Desk, expect

DAYS = {"march": "2026-03-04", "june": "2026-06-04"}
LESS = 0.6  # of the passive torque, at the second visit


@pytest.fixture(scope="module")
def visits(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A short trial of one leg in March and in June, when its tissue is softer."""
    moves = generate(
        Protocol(
            profile="multiple-holds",
            task="part-passive",
            chirp_amplitude=0.1,
            chirp_rate=0.2,
            rate_hz=64.0,
            duration=35.0,
        )
    )
    leg = virtual_subject(1)
    softer = {
        f"x0_{group}": leg.parameters[f"x0_{group}"] - np.log(LESS) / leg.parameters[f"k_{group}"]
        for group in ("tri", "tib")
    }
    made = {}
    for seed, (name, parameters) in enumerate({"march": {}, "june": softer}.items()):
        subject = replace(leg, parameters={**leg.parameters, **parameters})
        trial = virtual_trial(subject, moves, seed=seed)
        emg = {f"emg_{m}_V": np.maximum(trial.emg[:, i], 0.0) for i, m in enumerate(MUSCLES)}
        columns = {"time_s": trial.time, "angle_rad": trial.angle, "torque_Nm": trial.torque, **emg}
        made[name] = tmp_path_factory.mktemp("visits") / f"{name}.csv"
        write_csv(made[name], columns, ["emg: envelope"])
    return made


def test_a_second_visit_is_asked_before_it_is_seen(desk: Desk, visits: dict[str, Path]) -> None:
    desk.api("PATCH", "/api/draft", {"change": WHOLE, "label": "quick"})
    who = desk.api(
        "POST", "/api/subjects", {"code": "S8", "group": "", "notes": "", "body_mass": None}
    )
    trials = {}
    for name, path in visits.items():
        trials[name] = desk.add(path)
        told = {"subject": who["id"], "side": "left", "visit": DAYS[name]}
        desk.api("PATCH", f"/api/recordings/{trials[name]}", told)
    asked = {"recordings": [trials["march"]], "name": "march"}
    first = desk.wait_for_job(desk.api("POST", "/api/sessions", asked))

    page = desk.go("/analyse")
    box = page.locator("#recordings")
    for name in visits:  # the trials of the second visit alone
        box.get_by_role("checkbox", name=name).set_checked(name == "june")
    question = page.get_by_label("There is an earlier visit of this leg.")
    question.wait_for()
    expect(question).to_have_value("")
    question.select_option("Is it stiffer or softer, over its whole curve?")
    page.get_by_role("button", name="Analyse").click()
    page.wait_for_url("**/sessions/*")
    page.get_by_text("Did it change?").wait_for()
    page.locator("#before").select_option(first["result"])
    card = page.locator(".report [aria-labelledby=change]")
    # the answer is to what was asked: of so little rest, that there is none
    expect(card).to_contain_text("Torque at rest over the whole curve: no verdict")
    expect(card).to_contain_text("The leg rests for 11 s only")
    expect(card.locator("tbody tr").first).to_contain_text("Torque at rest over the whole curve")
    expect(card).to_contain_text("Fixed beforehand, or changed")
    legs = desk.api("GET", "/api/sessions")["sessions"]
    assert len([leg for leg in legs if leg["subject"] == who["id"]]) == 2
