import json
from dataclasses import replace

import pytest

import surae

from .conftest import refused
from .test_startup import COMPUTING, imported

FAST = ("--prepared", "--starts", "1", "--tendon-strain", "slack-length")


@pytest.mark.slow
def test_the_figures_are_those_of_the_api(run, files) -> None:
    done = run("compare", "trial.csv", *FAST, "--models", "muscle, muscle-tendon", "--output", "c")
    assert (done.code, done.err) == (0, "")
    written = json.loads((files / "c").read_text(encoding="utf-8"))
    comparison = surae.compare(
        files / "trial.csv",
        ["muscle", "muscle-tendon"],
        prepared=True,
        starts=1,
        tendon_strain="slack-length",
    )
    assert written["conclusion"] == comparison.conclusion
    assert written["finding"] == comparison.finding == "rigid-suffices"
    assert [s["held_out"]["vaf"] for s in written["models"]] == [
        s.held_out.vaf for s in comparison.models
    ]
    assert written["settings"]["options"]["tendon_strain"] == "slack-length"
    assert written["recordings"] == ["trial.csv"]


def test_what_is_shown(run, files) -> None:
    done = run("compare", "trial.csv", *FAST, "--output", "c.json")
    assert done.code == 0
    for model in ("muscle", "muscle-tendon", "muscle-tendon-strain", "muscle-tendon-toe"):
        assert f"\n{model} " in done.out
    assert "A rigid tendon suffices: " in done.out
    assert "Each of 4 contiguous blocks is left out" in done.out
    assert "samples as " in done.out
    assert "by more than their 95 % intervals" in done.out
    assert done.out.endswith("comparison: c.json\n")
    assert all(len(line) <= 132 for line in done.out.splitlines())


def test_stopped_by_the_user(run, files, monkeypatch) -> None:
    real = surae.assessment.comparison.compare.solve
    calls = []

    def stopped(*arguments, **options):
        calls.append(arguments)
        if len(calls) > 3:
            raise KeyboardInterrupt
        return real(*arguments, **options)

    monkeypatch.setattr("surae.assessment.comparison.compare.solve", stopped)
    done = run("compare", "trial.csv", *FAST, "--models", "muscle,muscle-tendon", "--output", "c")
    assert done.code == 130
    assert "what is complete is shown and written" in done.err
    written = json.loads((files / "c").read_text(encoding="utf-8"))
    assert written["finding"] is None
    assert len(written["missing"]) == 7
    calls.extend([()] * 3)
    done = run("compare", "trial.csv", *FAST, "--output", "none")
    assert (done.code, done.out) == (130, "")
    assert done.err.strip() == "surae: stopped by the user"
    assert not (files / "none").exists()


def test_a_comparison_that_failed(run, files, monkeypatch) -> None:
    real = surae.assessment.comparison.compare.solve
    monkeypatch.setattr(
        "surae.assessment.comparison.compare.solve",
        lambda problem, **options: replace(real(problem, **options), status="failed"),
    )
    done = run("compare", "trial.csv", *FAST, "--models", "muscle,muscle-tendon", "--output", "c")
    assert done.code == 1
    assert "No conclusion: the fit of the rigid model failed." in done.out
    assert done.err == "surae: No conclusion: the fit of the rigid model failed.\n"
    assert json.loads((files / "c").read_text(encoding="utf-8"))["n_effective"] is None


def test_wrong_use(run, files) -> None:
    refused(run("compare", "trial.csv", *FAST, "--models", "muscle"), "muscle-tendon-strain")
    refused(run("compare", "trial.csv", "--models", "muscle,,"), "--models muscle,,", "commas")
    refused(run("compare", "trial.csv", *FAST, "--models", "muscle,elastic"), "'elastic'")
    refused(run("compare", "trial.csv", "./trial.csv"), "given twice")
    refused(run("compare", "trial.csv", "--starts", "0"), "--starts 0")
    refused(run("compare", "trial.csv", "--fixed", "beta"), "--fixed beta")
    refused(run("compare", "trial.csv", *FAST, "--fixed", "speed=1"), "'speed'")
    refused(run("compare", "none.csv"), "none.csv")
    refused(run("compare", "trial.csv", *FAST, "--output", "trial.csv"), "is read by this command")
    refused(run("compare", "trial.csv", *FAST, "--output", "gone/c.json"), "make it first")


@pytest.mark.parametrize("arguments", [["compare", "--help"], ["compare"]])
def test_help_comes_at_once(arguments) -> None:
    assert imported(*arguments) & (COMPUTING | {"numpy", "rich"}) == set()
