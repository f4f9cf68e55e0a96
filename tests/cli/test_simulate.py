import csv
import json
from pathlib import Path

import numpy as np

import surae

from .conftest import refused

PARTS = ("tissue_Nm", "neural_Nm", "inertial_Nm", "gravitational_Nm")


def columns(path: Path) -> dict[str, np.ndarray]:
    lines = (line for line in path.read_text(encoding="utf-8").splitlines() if line[0] != "#")
    header, *rows = csv.reader(lines)
    return dict(zip(header, np.array(rows, dtype=float).T, strict=True))


def simulate(run, *arguments: object):
    return run("simulate", "trial.csv", "--output", "out.csv", *arguments)


def test_the_output_has_the_input_the_torque_and_parts_that_add_up(run, files) -> None:
    done = simulate(run, "--model", "muscle", "--parameters", "true.json")
    assert done == (0, "simulated: out.csv\n", "")
    given, table = columns(files / "trial.csv"), columns(files / "out.csv")
    assert [*table][: len(given)] == [*given]
    for name in given.keys() - {"torque_Nm"}:
        np.testing.assert_array_equal(table[name], given[name])
    parts = sum(table[name] for name in PARTS)
    np.testing.assert_allclose(parts, table["torque_Nm"], rtol=0, atol=1e-12)
    for name in ("tissue", "neural"):
        groups = table[f"{name}_tri_Nm"] + table[f"{name}_tib_Nm"]
        np.testing.assert_allclose(groups, table[f"{name}_Nm"], rtol=0, atol=1e-12)


def test_the_torque_is_that_of_the_api_and_near_the_measured(run, files) -> None:
    assert simulate(run, "--parameters", "true.json").code == 0
    given, table = columns(files / "trial.csv"), columns(files / "out.csv")
    truth = json.loads((files / "true.json").read_text(encoding="utf-8"))["parameters"]
    recording = surae.read(files / "trial.csv")
    exact = surae.simulate("muscle", truth, recording)
    np.testing.assert_allclose(table["torque_Nm"], exact, rtol=0, atol=1e-12)
    residual = table["torque_Nm"] - given["torque_Nm"]
    assert 0.25 < residual.std() < 0.35  # the noise of the trial, 0.3 Nm


def test_a_fit_brings_its_model_and_options(run, files) -> None:
    options = ("--geometry", "virtual-work", "--theta-foot", "0.1")
    fitted = run(
        "fit",
        "--model",
        "muscle",
        "trial.csv",
        "--prepared",
        "--starts",
        "1",
        "--output",
        "vw.json",
        *options,
    )
    assert fitted.code in (0, 1)
    assert simulate(run, "--parameters", "vw.json").code == 0
    fit = surae.load(files / "vw.json")
    measured = columns(files / "trial.csv")["torque_Nm"]
    torque = columns(files / "out.csv")["torque_Nm"]
    np.testing.assert_allclose(measured - torque, fit.result.residuals[0], rtol=0, atol=1e-9)
    assert simulate(run, "--parameters", "vw.json", "--geometry", "thesis").code == 0
    other = columns(files / "out.csv")["torque_Nm"]
    assert np.abs(other - torque).max() > 0.1


def test_weights_of_another_unit_are_refused(run, edit, files) -> None:
    def normalise(header: list[str], rows: list[list[str]]) -> None:
        header[3:] = [name.replace("_V", "_1") for name in header[3:]]

    edit("one.csv", normalise)
    done = run("simulate", "one.csv", "--parameters", "fit.json", "--output", "out.csv")
    refused(done, "one.csv", "'1'", "fit.json", "'V'", "weights")


def test_a_muscle_without_emg_is_noticed(run, edit) -> None:
    def drop(header: list[str], rows: list[list[str]]) -> None:
        column = header.index("emg_sol_V")
        for row in [header, *rows]:
            del row[column]

    edit("part.csv", drop)
    done = run("simulate", "part.csv", "--parameters", "true.json", "--output", "out.csv")
    assert done.code == 0
    assert done.err == "surae: part.csv: no EMG of sol; taken as silent\n"


def test_parameters_that_overflow(run, files) -> None:
    content = json.loads((files / "true.json").read_text(encoding="utf-8"))
    content["parameters"]["k_tri"] = 1e6
    (files / "p.json").write_text(json.dumps(content), encoding="utf-8")
    refused(simulate(run, "--parameters", "p.json"), "p.json", "overflows", code=1)
    assert not (files / "out.csv").exists()
