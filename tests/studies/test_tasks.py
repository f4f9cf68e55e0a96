"""A task is its settings and its program: what changes its key, and what its outcome is."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest

from surae.base.errors import ComputationError
from surae.base.records import from_plain
from surae.inference import assess, fit_problem, make_problem
from surae.protocol import Protocol, generate
from surae.studies import tasks as study_tasks
from surae.studies import virtual, virtual_subject, virtual_trial
from surae.studies.study import parse_study
from surae.studies.tasks import TaskOutcome, outcome_of, run_task, task_of

TEXT = 'protocol = "ramp-and-hold"\nrate_hz = 50\nstarts = 1\nchirp_amplitude = 0.2\n'


def tasks(text):
    return [task_of(c) for c in parse_study(text).combinations()]


def test_an_outcome_is_that_of_the_same_fit_by_hand() -> None:
    (task,) = tasks(TEXT + "seed = 4\nsubjects = [2]\nnoise = 0\n")
    outcome = run_task(task)
    settings = Protocol(profile="ramp-and-hold", rate_hz=50.0, chirp_amplitude=0.2)
    subject = virtual_subject(4_000_002)
    trial = virtual_trial(subject, generate(settings), noise=0.0)
    by_hand = fit_problem(make_problem([trial]), starts=1, seed=4)
    worth = assess(by_hand)
    assert (outcome.status, outcome.vaf, outcome.ipde) == (by_hand.status, worth.vaf, worth.ipde)
    assert {e.name: e.value for e in outcome.estimates} == by_hand.values
    assert {e.name: e.sem for e in outcome.estimates} == {
        name: p.sem for name, p in worth.parameters.items()
    }
    assert {e.name: e.true for e in outcome.estimates} == dict(subject.parameters)
    assert outcome.seconds > 0


@pytest.mark.slow
def test_the_noise_is_another_in_every_cell_and_repeat_and_the_same_for_all_models(monkeypatch):
    seeds = {}
    trial = virtual.virtual_trial

    def noted(*args, **settings):
        seeds.setdefault(settings["model"], []).append(settings["seed"])
        return trial(*args, **settings)

    monkeypatch.setattr(virtual, "virtual_trial", noted)
    cells = 'model = ["muscle", "muscle-tendon"]\ntask = ["active", "part-passive"]\nrepeats = 2\n'
    for task in tasks(TEXT + cells + "chirp_rate = [0.1, 0.2]\n"):
        run_task(task)
    assert len(set(seeds["muscle"])) == 8
    assert seeds["muscle"] == seeds["muscle-tendon"]


def test_another_model_may_be_fitted_than_simulates() -> None:
    one, two = tasks(TEXT + 'fitted = ["muscle", "muscle-tendon"]\n')
    assert run_task(one).vaf == run_task(tasks(TEXT)[0]).vaf
    assert run_task(two).vaf < run_task(one).vaf


def test_auto_is_fitted_and_its_laboratory_left_out() -> None:
    (task,) = tasks(TEXT + 'fitted = "auto"\n')
    outcome = run_task(task)
    assert outcome.vaf > 99.0
    names = [estimate.name for estimate in outcome.estimates]
    assert {"k_tri", "l0_tri", "g1"} <= set(names)
    assert not [name for name in names if name.startswith(("xt_", "emg_"))]


def test_freed_tendon_parameters_are_estimated() -> None:
    (task,) = tasks(TEXT + 'model = "muscle-tendon-strain"\n')
    estimates = run_task(task).estimates
    assert [e.name for e in estimates[-2:]] == ["dlt_tri", "dlt_tib"]
    assert len(estimates) == 17
    (table2,) = tasks(TEXT + 'model = "muscle-tendon"\n')
    assert [e.true for e in run_task(table2).estimates] == [e.true for e in estimates[:15]]


def test_whatever_goes_wrong_is_an_outcome_with_its_reason() -> None:
    (task,) = tasks(TEXT)
    outcome = run_task(replace(task, population="martian"))
    assert outcome.status == "failed"
    assert outcome.message.startswith("InputError: population 'martian' is not known")
    assert (outcome.vaf, outcome.estimates) == (None, ())


@pytest.mark.parametrize(
    "change",
    [
        "noise = 0.1",
        "seed = 2",
        "starts = 2",
        'task = "active"',
        'population = "patient"',
        "rate_hz = 60",
        'geometry = "virtual-work"',
        "chirp_rate = 0.3",
        "repeats = [2]",
    ],
)
def test_whatever_matters_changes_the_key(change) -> None:
    name = change.split(" ", maxsplit=1)[0]
    rest = "".join(line + "\n" for line in TEXT.splitlines() if not line.startswith(name))
    assert tasks(TEXT)[0].key != tasks(rest + change + "\n")[0].key


def test_what_does_not_matter_is_shared() -> None:
    still = TEXT.replace("chirp_amplitude = 0.2", "chirp_amplitude = 0.0")
    assert len({t.key for t in tasks(still + "chirp_rate = [0.1, 0.2, 0.3]\n")}) == 1
    assert len({t.key for t in tasks(TEXT + "noise = 0\nrepeats = 3\n")}) == 1
    assert len({t.key for t in tasks(TEXT + "repeats = 3\n")}) == 3


def test_another_program_has_other_keys(monkeypatch) -> None:
    (task,) = tasks(TEXT)
    before = task.key
    monkeypatch.setattr("surae.studies.tasks.fingerprint", lambda: "another")
    assert task.key != before


def test_a_worker_gives_the_same_and_refuses_another_program(monkeypatch) -> None:
    (task,) = tasks(TEXT + 'geometry = "virtual-work"\n')
    call = json.loads(json.dumps({"key": task.key, "settings": asdict(task)}))
    outcome = from_plain(TaskOutcome, outcome_of(**call))
    assert replace(outcome, seconds=0) == replace(run_task(task), seconds=0)
    monkeypatch.setattr("surae.studies.tasks.fingerprint", lambda: "another")
    with pytest.raises(ComputationError, match="a worker has another surae"):
        outcome_of(**call)


def test_the_fingerprint_follows_the_sources(tmp_path, monkeypatch) -> None:
    for folder in (*study_tasks._COMPUTING,):
        (tmp_path / folder).mkdir()
    kernel, shown = tmp_path / "model" / "kernel.py", tmp_path / "report.py"
    kernel.write_text("a = 1\n")
    monkeypatch.setattr(study_tasks, "_PACKAGE", tmp_path)
    fresh = study_tasks.fingerprint.__wrapped__
    before = fresh()
    shown.write_text("b = 1\n")
    assert fresh() == before
    kernel.write_text("a = 2\n")
    assert fresh() != before


def test_subjects_differ_and_do_not_depend_on_the_noise() -> None:
    many = tasks(TEXT + "subjects = 2\nrepeats = 2\n")
    truth = [[e.true for e in run_task(task).estimates] for task in many]
    assert truth[0] == truth[1]
    assert truth[2] == truth[3]
    assert not np.any(np.isclose(truth[0], truth[2], rtol=1e-12))
