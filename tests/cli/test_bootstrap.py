"""`surae bootstrap`, as a user would call them."""

import json

import pytest

import surae

from .conftest import refused


def test_a_bootstrap_is_shown_and_written(run, files) -> None:
    done = run("bootstrap", "fit.json", "--replicates", 45, "--seed", 3, "--output", "b.json")
    assert (done.code, done.err) == (0, "")
    assert "45 replicates; blocks of" in done.out
    assert "bootstrap: b.json" in done.out
    data = json.loads((files / "b.json").read_text(encoding="utf-8"))
    expected = surae.bootstrap(surae.load(files / "fit.json"), replicates=45, seed=3)
    assert data["parameters"]["m"]["ci95"] == list(expected.parameters["m"].ci95)
    assert (data["replicates"], data["missing"], data["seed"]) == (45, 0, 3)


def test_it_goes_on_where_it_was(run, files) -> None:
    run("bootstrap", "fit.json", "--replicates", 40, "--output", "b.json")
    done = run("bootstrap", "fit.json", "--replicates", 60, "--output", "b.json")
    assert "60 replicates, 40 of them made before" in done.out
    refused(
        run("bootstrap", "fit.json", "--seed", 1, "--output", "b.json"),
        "b.json.replicates", "another fit or other settings",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["bootstrap", "fit.json", "--replicates", "0"], "--replicates 0"),
        (["bootstrap", "fit.json", "--seed", "-1"], "--seed -1"),
        (["bootstrap", "fit.json", "--block", "0,4"], "write 0.4"),
        (["bootstrap", "fit.json", "--block", "1000"], "at most half"),
        (["bootstrap", "fit.json", "--output", "fit.json"], "is read by this command"),
        (["bootstrap", "none.json"], "none.json"),
    ],
)
def test_wrong_use(run, files, arguments, says) -> None:
    refused(run(*arguments), says)


def test_the_fit_says_which_intervals_it_gives(run, files) -> None:
    done = run(
        "fit",
        "--model",
        "muscle",
        "trial.csv",
        "--prepared",
        "--starts",
        1,
        "--output",
        "again.json",
    )
    assert "intervals: " in done.out
    data = json.loads((files / "again.json").read_text(encoding="utf-8"))
    assert data["interval"] in ("thesis", "robust")
    p = data["parameters"]["m"]
    assert p["interval"] == data["interval"]
    used = p["sem"] if data["interval"] == "thesis" else p["sem_robust"]
    half = (p["ci95"][1] - p["ci95"][0]) / 2
    assert half == pytest.approx(1.97 * used, rel=0.05)
    assert data["recordings"][0]["residual"]["p_value"] >= 0
