"""`--free emd`, `--fixed emd=…`, `--free reflex`, and P.json with them."""

import json

import numpy as np
import pytest

import surae

from .test_simulate import columns, simulate


def fit(run, *arguments: object):
    return run(
        "fit",
        "--model",
        "muscle",
        "trial.csv",
        "--prepared",
        "--starts",
        "1",
        "--output",
        "f.json",
        *arguments,
    )


def found(files) -> dict:
    return json.loads((files / "f.json").read_text(encoding="utf-8"))


def test_simulate_takes_what_a_fit_with_drives_wrote(run, files) -> None:
    assert fit(run, "--fixed", "emd=0.03", "--free", "reflex").code in (0, 1)
    assert simulate(run, "--parameters", "f.json").code == 0
    table = columns(files / "out.csv")
    assert "reflex_Nm" in table
    again = surae.load(files / "f.json")
    modelled = again.result.problem.inputs[0].torque - again.result.residuals[0]
    np.testing.assert_allclose(table["torque_Nm"], modelled, rtol=0, atol=1e-9)


def test_validation_uses_the_delay(run, files) -> None:
    assert fit(run, "--fixed", "emd=0.03").code == 0
    assert run("validate", "f.json", "trial.csv", "--prepared", "--output", "v.json").code == 0
    told = json.loads((files / "v.json").read_text(encoding="utf-8"))["recordings"][0]["vaf"]
    assert told == pytest.approx(found(files)["vaf"], abs=1e-6)
