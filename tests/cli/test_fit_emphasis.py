"""Weights, losses, default priors and body mass on the command line."""

import json

import pytest

import surae

from .conftest import refused


def fitted(files, name="out.json"):
    return json.loads((files / name).read_text(encoding="utf-8"))


QUICK = ("--prepared", "--starts", "1", "--output", "out.json")


def test_windows_peaks_and_loss_are_those_of_the_api(run, files) -> None:
    done = run(
        "fit",
        "--model",
        "muscle",
        "trial.csv",
        *QUICK,
        "--exclude",
        "30:",
        "--exclude",
        ":1",
        "--weight",
        "3:4:2",
        "--weight-peaks",
        "4",
        "--peaks-of",
        "emg",
        "--loss",
        "huber",
    )
    assert done.code == 0, done
    assert "Weights: 30 … the end left out of the fit." in done.out
    assert "Weights: a peak of the EMG counts 5 times as much as rest." in done.out
    assert "Outliers count less (huber loss)" in done.out
    assert "(weighted " in done.out
    windows = ((30.0, float("inf"), 0.0), (float("-inf"), 1.0, 0.0), (3.0, 4.0, 2.0))
    fit_again = surae.fit(
        files / "trial.csv",
        "muscle",
        prepared=True,
        starts=1,
        weights=surae.Weighting(windows, peaks=4.0, activity="emg"),
        loss="huber",
    )
    content = fitted(files)
    assert content["vaf_weighted"] == fit_again.vaf_weighted
    assert content["outliers"]["loss"] == "huber"
    for name, p in content["parameters"].items():
        assert p["value"] == fit_again.values[name], name


def test_priors_of_a_population_and_given_ones(run, files) -> None:
    options = ("--priors", "patient", "--prior", "f0=2:0.1")
    done = run("fit", "--model", "muscle", "trial.csv", *QUICK, *options)
    assert done.code == 0, done
    assert "Priors on m, k_tri" in done.out
    priors = fitted(files)["priors"]
    assert priors["f0"] == {"median": 2.0, "spread": 0.1}
    assert priors["l0_tri"] == {"median": 0.0378, "spread": 0.2}
    fit_again = surae.fit(
        files / "trial.csv",
        "muscle",
        prepared=True,
        starts=1,
        priors=("patient", {"f0": (2.0, 0.1)}),
    )
    assert fit_again.values["m"] == fitted(files)["parameters"]["m"]["value"]
    alone = surae.fit(files / "trial.csv", "muscle", prepared=True, starts=1, priors="patient")
    assert alone.result.problem.priors["f0"].median == 1.96


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--exclude", "3"), ("--exclude 3", "start:end")),
        (("--exclude", "900:901"), ("holds no sample", "trial.csv")),
        (("--weight", "3:4"), ("start:end:weight",)),
        (("--weight-peaks", "-2"), ("peaks is -2", "at least 0")),
        (("--peaks-of", "emg"), ("--weight-peaks",)),
    ],
)
def test_wrong_use_is_one_clear_line(options, says, run, files) -> None:
    refused(run("fit", "--model", "muscle", "trial.csv", "--prepared", *options), *says)
