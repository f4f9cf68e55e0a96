"""The model of 2010 from the command line: simulate, fit, report, validate, and its file."""

import json

import pytest

import surae

from .conftest import refused

TRUTH = {
    "m": 2.1,
    "k_tri": 200.0,
    "x0_tri": 0.017,
    "e1": 5e5,
    "e2": 9e5,
    "e3": 1.3e6,
    "e4": 1e6,
    "f": 2.0,
    "b_tri": 800.0,
    "F0": -12.0,
}
MODEL = ("--model", "muscle-2010")


@pytest.fixture
def old(run, files):
    """The trial with the torque that the model of 2010 gives it, and its parameters."""
    (files / "old.json").write_text(json.dumps({"parameters": TRUTH}), encoding="utf-8")
    surae.simulate("muscle-2010", TRUTH, files / "trial.csv")  # compiled, or else stderr says so
    done = run("simulate", "trial.csv", *MODEL, "--parameters", "old.json", "--output", "old.csv")
    assert (done.code, done.err) == (0, "")
    return files


@pytest.mark.usefixtures("undrawn")
def test_simulated_fitted_reported_and_validated(run, old) -> None:
    header = (old / "old.csv").read_text(encoding="utf-8").splitlines()
    assert any("model muscle-2010" in line for line in header[:3])
    outputs = ("--output", "fit.json", "--report", "r.html")
    done = run("fit", "old.csv", "--prepared", *MODEL, "--starts", "2", *outputs)
    assert (done.code, done.err) == (0, "")
    assert "muscle model of 2010, reconstructed" in done.out
    lines = {line.split()[0]: line for line in done.out.splitlines() if line.strip()}
    assert set(TRUTH) <= set(lines)
    content = json.loads((old / "fit.json").read_text(encoding="utf-8"))
    assert content["model"] == "muscle-2010"
    assert list(content["parameters"]) == list(TRUTH)
    for name, value in TRUTH.items():
        assert content["parameters"][name]["value"] == pytest.approx(value, rel=1e-5)
        tied = name[0] not in "mf"  # this model ties muscles to the assumed arm and path
        assert content["parameters"][name]["verdict"] == ("undetermined" if tied else "identified")
    assert content["parameters"]["F0"]["lower"] < 0
    page = (old / "r.html").read_text(encoding="utf-8")
    assert "force shift, triceps surae" in page
    assert "muscle model of 2010, reconstructed" in page
    done = run("validate", "fit.json", "old.csv", "--output", "v.json")
    assert done.code == 0
    (recording,) = json.loads((old / "v.json").read_text(encoding="utf-8"))["recordings"]
    assert recording["vaf"] == pytest.approx(100.0, abs=1e-6)


def test_a_saved_fit_is_read_back_as_it_was(old) -> None:
    fitted = surae.fit(old / "trial.csv", model="muscle-2010", prepared=True, starts=1)
    assert fitted.values["F0"] < 0
    fitted.save(old / "a.json")
    again = surae.load(old / "a.json")
    assert again.values == fitted.values
    assert again.vaf == fitted.vaf
    assert again.parameters == fitted.parameters
    assert (again.parts().total == fitted.parts().total).all()
    again.save(old / "b.json")
    assert (old / "a.json").read_bytes() == (old / "b.json").read_bytes()


def test_a_silent_muscle_is_named_by_its_own_weight(run, old, edit) -> None:
    def without(header, rows) -> None:
        column = header.index("emg_sol_V")
        for row in (header, *rows):
            del row[column]

    edit("silent.csv", without)
    refused(run("fit", "silent.csv", "--prepared", *MODEL), "emg_sol", "e3=0")
    simulate = ("simulate", "silent.csv", *MODEL, "--output", "out.csv", "--parameters")
    done = run(*simulate, "old.json")
    assert done.code == 0
    assert done.err == "surae: silent.csv: no EMG of sol; taken as silent\n"
    quiet = {"parameters": TRUTH | {"e3": 0.0}}
    (old / "quiet.json").write_text(json.dumps(quiet), encoding="utf-8")
    assert run(*simulate, "quiet.json").err == ""
    done = run("fit", "old.csv", "--prepared", *MODEL, "--starts", "1", "--output", "fit.json")
    assert done.code == 0
    refused(run("validate", "fit.json", "silent.csv"), "no EMG of muscle 'sol'", "emg_sol")


def test_parameters_of_another_model_are_refused(run, old) -> None:
    done = run("simulate", "trial.csv", *MODEL, "--parameters", "true.json", "--output", "o.csv")
    refused(done, "true.json", "model 'muscle-2010' has no parameter 'k_tib'", "b_tri, F0")
