"""`--free emd`, `--fixed emd=…`, `--free reflex`, and P.json with them."""

import json

import numpy as np
import pytest

import surae

from .conftest import refused
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


def test_an_ordinary_fit_has_the_fifteen(run, files) -> None:
    assert fit(run).code == 0
    assert list(found(files)["parameters"]) == [*surae.load(files / "fit.json").parameters]
    assert len(found(files)["parameters"]) == 15


def test_a_delay_is_estimated(run, files) -> None:
    truth = json.loads((files / "true.json").read_text(encoding="utf-8"))["parameters"]
    parameters = {"parameters": truth | {"emd": 0.0437}}
    (files / "late.json").write_text(json.dumps(parameters), encoding="utf-8")
    assert simulate(run, "--parameters", "late.json").code == 0
    done = run(
        "fit",
        "--model",
        "muscle",
        "out.csv",
        "--prepared",
        "--starts",
        "1",
        "--free",
        "emd",
        "--output",
        "f.json",
    )
    assert done.code == 0
    assert "emd" in done.out
    emd = found(files)["parameters"]["emd"]
    assert emd["value"] == pytest.approx(0.0437, abs=1e-5)
    assert (emd["unit"], emd["free"], emd["lower"], emd["upper"]) == ("s", True, 0.0, 0.2)
    assert "emd" in found(files)["correlation"]["names"]


def test_a_delay_is_set(run, files) -> None:
    assert fit(run, "--fixed", "emd=0.05").code == 0
    emd = found(files)["parameters"]["emd"]
    assert (emd["value"], emd["free"], emd["verdict"]) == (0.05, False, "fixed")
    assert "emd" not in found(files)["free"]


def test_the_reflex_is_freed_as_a_whole_or_in_part(run, files) -> None:
    assert fit(run, "--free", "reflex").code in (0, 1)
    assert found(files)["free"][-3:] == ["reflex_tri", "reflex_tib", "reflex_delay"]
    assert fit(run, "--free", "reflex", "--fixed", "reflex_tib=0").code in (0, 1)
    assert found(files)["free"][-2:] == ["reflex_tri", "reflex_delay"]
    assert found(files)["parameters"]["reflex_tib"]["value"] == 0.0


def test_refusals(run, files) -> None:
    refused(fit(run, "--free", "reflex_delay"), "the reflex is off")
    refused(fit(run, "--fixed", "emd=-1"), "emd is -1 s; it must be zero or more")
    refused(fit(run, "--free", "emd", "--fixed", "emd=0.1"), "emd")


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
