"""One request: Python, command line and workbench reach every field of it, and fit the same."""

import json
import math
import pydoc
import re
from dataclasses import fields
from inspect import signature
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

import surae
from surae.base.errors import InputError
from surae.base.records import from_plain
from surae.base.setting import settings_of as settings_in
from surae.cli import group
from surae.estimators import LeastSquaresOptions
from surae.protocol import Protocol, generate
from surae.quality import Quality
from surae.recording import MUSCLES
from surae.settings import FIT_RECORDS, FitSettings
from surae.signals import Weighting
from surae.studies import virtual_subject, virtual_trial
from surae_workbench.web.draft import changed, empty_draft, settings_of
from surae_workbench.web.schemas import DraftChange, Geometry

TABLE = Path(__file__).parents[1] / "data" / "geometry.csv"
KNOWN = TABLE.with_name("session.toml")
WEIGHTS = Weighting(((-math.inf, 1.0, 0.0), (3.0, 4.0, 2.0)), 4.0, "emg")
#: How each field is reached: keywords of `surae.fit`, options of `surae fit`, keys of a draft.
REACHED: dict[str, tuple[dict[str, Any], str, dict[str, Any]]] = {
    "model": ({"model": "muscle-tendon"}, "--model muscle-tendon", {"model": "muscle-tendon"}),
    "options": (
        {"geometry": "virtual-work", "vmax_factor": 9.0},
        "--geometry virtual-work --vmax-factor 9",
        {"options": {"geometry": "virtual-work", "vmax_factor": 9.0}},
    ),
    "fixed": (
        {"fixed": {"beta": 1.0}},
        "--fixed beta=1",
        {"parameters": {"beta": {"free": False, "value": 1.0}}},
    ),
    "free": ({"free": ["emd"]}, "--free emd", {"parameters": {"emd": {"free": True}}}),
    "start": ({"start": {"m": 2.1}}, "--start m=2.1", {"parameters": {"m": {"value": 2.1}}}),
    "bounds": (
        {"bounds": {"tau_rel": (0.2, 20.0)}},
        "--bound tau_rel=0.2:20",
        {"parameters": {"tau_rel": {"lower": 0.2, "upper": 20.0}}},
    ),
    "priors": (
        {"priors": {"f0": (2.0, 0.2)}},
        "--prior f0=2:0.2",
        {"parameters": {"f0": {"prior": {"median": 2.0, "spread": 0.2}}}},
    ),
    "population": ({"priors": "patient"}, "--priors patient", {"population": "patient"}),
    "weights": (
        {"weights": WEIGHTS},
        "--exclude :1 --weight 3:4:2 --weight-peaks 4 --peaks-of emg",
        {"weights": {"windows": [[None, 1, 0], [3, 4, 2]], "peaks": 4, "activity": "emg"}},
    ),
    "loss": (
        {"model": "muscle", "loss": "tukey"},
        "--model muscle --loss tukey",
        {"model": "muscle", "loss": "tukey"},
    ),
    "normalise": ({"normalise": "session"}, "--normalise session", {"normalise": "session"}),
    "prepared": ({"prepared": True}, "--prepared", {"prepared": True}),
    "preparation": (
        {"preparation": {"bessel_hz": 10.0, "emg_highpass_hz": False}},
        "--filter bessel_hz=10 --filter emg_highpass_hz=false",
        {"preparation": {"bessel_hz": 10, "emg_highpass_hz": False}},
    ),
    "nuisances": ({"nuisances": "none"}, "--nuisances none", {"nuisances": "none"}),
    "starts": (
        {"model": "muscle", "starts": 3},
        "--model muscle --starts 3",
        {"model": "muscle", "starts": 3},
    ),
    "seed": ({"seed": 5}, "--seed 5", {"seed": 5}),
    "geometry_of": (
        {"geometry": TABLE, "vmax_factor": 9.0, "geometry_of": "person"},
        f"--geometry {TABLE} --vmax-factor 9 --geometry-of person",
        {
            "options": {
                "geometry": {"name": TABLE.name, "text": TABLE.read_text(encoding="utf-8")},
                "vmax_factor": 9.0,
            },
            "geometry_of": "person",
        },
    ),
    "knowledge": (
        {"knowledge": KNOWN},
        f"--knowledge {KNOWN}",
        {"knowledge": {"angle_zero_deg": {"value": 0.0, "sd": 1.0}}},
    ),
    "angle_zero_sd": ({"angle_zero_sd": 1.0}, "--angle-zero-sd 1", {"angle_zero_sd": 1.0}),
}


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    """A CSV of a virtual subject at 64 Hz, envelopes, and the same again."""
    motion = generate(
        Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=64.0, duration=20.0)
    )
    made = virtual_trial(virtual_subject(3), motion)
    columns = {"time_s": made.time, "angle_rad": made.angle, "torque_Nm": made.torque}
    columns |= {f"emg_{m}_V": made.emg[:, i] for i, m in enumerate(MUSCLES)}
    folder = tmp_path_factory.mktemp("request")
    for name in ("trial.csv", "second.csv"):
        surae.write_csv(folder / name, columns, ["emg: envelope"])
    return folder / "trial.csv"


def of_draft(**change: Any) -> FitSettings:
    """What the workbench asks after a change of its draft, as requests make it."""
    draft = changed(empty_draft(), DraftChange.model_validate(change).plain())
    return settings_of(json.loads(json.dumps(draft)), ["a"])


def asked(monkeypatch, name: str, call: Any) -> FitSettings:
    """The settings that reach a function of the API, which is not called."""
    caught: list[FitSettings] = []

    def catch(*arguments: Any, **more: Any) -> None:
        caught.extend(x for x in (*arguments, *more.values()) if isinstance(x, FitSettings))
        raise surae.SuraeError("caught")

    with monkeypatch.context() as patched:
        patched.setattr(name, catch)
        # findings, which take a second of fits each, are not what is asked
        patched.setattr("surae.api.recordings.examined", lambda *_: Quality("trial", ()))
        with pytest.raises(surae.SuraeError, match="caught"):
            call()
    (settings,) = caught
    return settings


def test_every_field_is_here() -> None:
    named = {field.name for kind in FIT_RECORDS[:-1] for field in fields(kind)}
    assert set(REACHED) == named - {"estimator"}


@pytest.mark.parametrize("name", REACHED)
def test_every_field_is_reached_from_everywhere(name, trial, monkeypatch) -> None:
    keywords, options, change = REACHED[name]
    wanted = FitSettings.of(**keywords)
    assert getattr(wanted, name) != getattr(FitSettings(), name)
    command = ["fit", str(trial), *options.split()]
    of_command = asked(
        monkeypatch, "surae.api.fit_inputs", lambda: group.main(command, standalone_mode=False)
    )
    of_python = asked(
        monkeypatch, "surae.api.fitting.fit_inputs", lambda: surae.fit(trial, **keywords)
    )
    assert of_command == of_python == of_draft(**change) == wanted


def test_a_draft_of_another_joint_is_refused_with_the_way() -> None:
    with pytest.raises(ValidationError, match="surae fit --joint"):
        DraftChange(options={"joint": {"name": "wrist"}})
    assert DraftChange(options={"joint": "ankle"}).plain() == {"options": {"joint": "ankle"}}


def test_weights_of_a_draft_may_be_given_in_part() -> None:
    assert of_draft(weights={"windows": []}) == FitSettings(weights=surae.Weighting())


def together(names: set[str]) -> tuple[dict[str, Any], list[str], dict[str, Any]]:
    """Several fields at once: keywords, options, and the change of a draft."""
    keywords: dict[str, Any] = {}
    options: dict[str, str] = {}
    change: dict[str, Any] = {}
    for name, (in_python, in_command, by_draft) in REACHED.items():
        if name in names:
            keywords |= in_python
            options |= dict.fromkeys(in_command.split(" --"))
            rows = change.get("parameters", {}) | by_draft.get("parameters", {})
            change |= by_draft | ({"parameters": rows} if rows else {})
    if {"priors", "population"} <= names:
        keywords["priors"] = ("patient", REACHED["priors"][0]["priors"])
    line = " ".join("--" + option.removeprefix("--") for option in options)
    return keywords, line.split(), change


def test_all_fields_at_once_are_one_request(trial, monkeypatch) -> None:
    of_named = {"model", "loss", "starts"}
    keywords, options, change = together(set(REACHED) - {"prepared", *of_named})
    wanted = FitSettings.of(**keywords)
    command = ["fit", str(trial), *options]
    of_command = asked(
        monkeypatch, "surae.api.fit_inputs", lambda: group.main(command, standalone_mode=False)
    )
    assert of_command == of_draft(**change) == wanted
    assert from_plain(FitSettings, json.loads(json.dumps(wanted.as_dict()))) == wanted


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"starts": 3}, "starts has no effect with model auto"),
        ({"model": "muscle", "nuisances": "none"}, "nuisances has no effect with model muscle"),
        (
            {"model": "muscle", "options": {"tendon_strain": "slack-length"}},
            "tendon_strain has no effect with model muscle",
        ),
        (
            {"model": "muscle", "knowledge": {"mass_kg": 70.0}},
            "knowledge: mass_kg has no effect with model muscle",
        ),
    ],
)
def test_a_draft_refuses_what_its_model_does_not_read(change, says) -> None:
    with pytest.raises(InputError, match=says):
        of_draft(**change)


def test_what_a_draft_has_of_another_model_waits_for_it() -> None:
    known = {"mass_kg": 70.0, "angle_zero_deg": {"value": 2.0, "sd": 1.0}}
    draft = changed(empty_draft(), DraftChange(nuisances="none", knowledge=known).plain())
    named = changed(draft, DraftChange(model="muscle").plain())
    named = changed(named, DraftChange(starts=3).plain())
    asked_of_it = settings_of(named, ["a"])
    assert asked_of_it.estimator == LeastSquaresOptions(starts=3)
    assert asked_of_it.knowledge.mass_kg is None
    assert asked_of_it.fixed == {"angle_zero": math.radians(2.0)}
    again = settings_of(changed(named, DraftChange(model="auto").plain()), ["a"])
    assert again == settings_of(draft, ["a"])
    assert again.nuisances == "none"


def test_a_command_refuses_what_its_model_does_not_read(trial, tmp_path) -> None:
    (tmp_path / "session.toml").write_text("[knowledge]\naxis_mm = {value = 5.0, sd = 3.0}\n")
    for options, says in (
        ("--starts 7", "starts has no effect with model auto"),
        ("--model muscle --nuisances none", "nuisances has no effect with model muscle"),
        (
            "--model muscle --integrator explicit-euler",
            "integrator has no effect with model muscle",
        ),
        (
            f"--model muscle --knowledge {tmp_path / 'session.toml'}",
            "knowledge: axis_mm has no effect with model muscle",
        ),
    ):
        with pytest.raises(InputError, match=says):
            group.main(["fit", str(trial), *options.split()], standalone_mode=False)


def test_a_session_refuses_what_its_model_does_not_read(trial, tmp_path) -> None:
    (tmp_path / "one.csv").write_bytes(trial.read_bytes())
    (tmp_path / "session.toml").write_text("[knowledge]\naxis_mm = {value = 5.0, sd = 3.0}\n")
    session = surae.session(tmp_path)
    assert session.with_knowledge(FitSettings()).knowledge.axis_mm is not None
    for ask in (session.fit, session.run):
        with pytest.raises(InputError, match="knowledge: axis_mm has no effect with model muscle"):
            ask(model="muscle")


@pytest.mark.slow
def test_all_three_write_the_same_fit(browser, trial, tmp_path, monkeypatch) -> None:
    """A small fit, the last of Python with the settings that the command line saved."""
    keywords, options, change = together({"fixed", "priors", "weights", "seed"})
    keywords |= {"model": "muscle", "normalise": "mvc", "starts": 1}
    options += ["--model", "muscle", "--normalise", "mvc", "--starts", "1"]
    change |= {"model": "muscle", "normalise": "mvc", "starts": 1}

    monkeypatch.chdir(trial.parent)
    command = ["fit", trial.name, "--mvc", trial.name, *options, "--output"]
    group.main([*command, str(tmp_path / "command.json")], standalone_mode=False)
    id_ = browser.recording(trial)
    browser.change(recordings=[id_], mvc=[id_], **change)
    job = browser.job(browser.post("/api/fits", json={}))
    assert job["state"] == "done", job
    by_browser = browser.get(f"/api/fits/{job['result']}/fit.json").json()
    saved = surae.load(tmp_path / "command.json").settings
    surae.fit(trial.name, saved, mvc=trial.name).save(tmp_path / "python.json")

    by_python, by_command = (
        json.loads((tmp_path / name).read_text(encoding="utf-8"))
        for name in ("python.json", "command.json")
    )
    for fit in (by_python, by_command, by_browser):
        assert fit.pop("seconds") > 0
        assert from_plain(FitSettings, fit["settings"]) == FitSettings.of(**keywords)
    assert by_command == by_python
    assert by_browser == by_python


def test_help_and_completion_name_every_field() -> None:
    """Of `surae.fit`, and of what passes its keywords on."""
    every = {f.name for kind in FIT_RECORDS for f, _ in settings_in(kind)} - {"model"}
    for function in (surae.fit, surae.Session.fit, surae.Session.run):
        known = signature(function).parameters
        assert every <= known.keys(), function
    said = pydoc.render_doc(surae.fit, renderer=pydoc.plaintext)
    assert all(re.search(rf"^ +[\w, ]*\b{name}[\w, ]* : ", said, re.MULTILINE) for name in every)


def test_a_draft_keeps_a_table_over_a_second_angle() -> None:
    rows = [
        f"{a},{k},{400 + a - k / 10},{300 - a}" for a in (-30, -10, 10, 30) for k in (0, 30, 60)
    ]
    head = "angle_deg,second_angle_deg,length_tri_mm,length_tib_mm"
    table = Geometry(name="knee.csv", text="\n".join([head, *rows])).plain()
    assert table["second"][2] == pytest.approx(1.0472, abs=1e-4)
    assert Geometry(**table).plain() == table
