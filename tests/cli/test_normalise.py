"""`surae fit --normalise`, and that validation uses the fit's reference again."""

import json

import pytest

from surae import load

from .conftest import refused


@pytest.fixture
def half(edit):
    """A trial with half the EMG: weights that carry over predict only half its active torque."""

    def weaken(header, rows):
        for row in rows:
            for column, name in enumerate(header):
                if name.startswith("emg"):
                    row[column] = repr(0.5 * float(row[column]))

    return edit("half.csv", weaken)


def test_a_session(files, run, half):
    done = run(
        "fit",
        "--model",
        "muscle",
        "trial.csv",
        "--prepared",
        "--normalise",
        "session",
        "--starts",
        "2",
        "--output",
        "n.json",
    )
    assert done.code == 0, done
    assert "EMG normalised: divided by the session's largest envelope (of 1 recording" in done.out
    content = json.loads((files / "n.json").read_text(encoding="utf-8"))
    assert content["parameters"]["g1"]["unit"] == "N"
    (trace,) = content["traces"]
    assert trace["emg_reference"]["kind"] == "session"
    assert trace["emg_reference"]["values_V"]["ta"] > 0
    reference = load("n.json").result.problem.inputs[0].emg_reference
    volts = load("fit.json")
    for number, value in enumerate(reference.values, start=1):
        normal = content["parameters"][f"g{number}"]["value"]
        assert normal == pytest.approx(value * volts.values[f"g{number}"], rel=1e-2)
    for name in ("half.csv", "trial.csv"):
        vaf = []
        for fit in ("n.json", "fit.json"):
            assert run("validate", fit, name, "--prepared", "--output", "v.json").code == 0
            (row,) = json.loads((files / "v.json").read_text(encoding="utf-8"))["recordings"]
            vaf.append(row["vaf"])
        assert vaf[0] == pytest.approx(vaf[1], abs=0.05)


def test_maximum_contractions(files, run, half):
    done = run(
        "fit",
        "--model",
        "muscle",
        "half.csv",
        "--prepared",
        "--normalise",
        "mvc",
        "--mvc",
        "trial.csv",
        "--starts",
        "1",
        "--output",
        "n.json",
    )
    assert done.code == 0, done
    reference = load("n.json").result.problem.inputs[0].emg_reference
    assert reference.kind == "mvc"
    assert [file.path for file in reference.files] == ["trial.csv"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--normalise", "trial"), "'trial' is not one of"),
        (("--normalise", "mvc"), "give mvc"),
        (("--mvc", "trial.csv"), "mvc has no effect without normalise='mvc'"),
        (
            ("--normalise", "session", "--mvc", "trial.csv"),
            "recordings of MVC have no effect on session",
        ),
        (("--normalise", "mvc", "--mvc", "no.csv"), "no such file"),
    ],
)
def test_wrong_use_is_one_line(files, run, arguments, says):
    refused(run("fit", "--model", "muscle", "trial.csv", "--prepared", *arguments), says)


def test_validation_has_no_normalisation_of_its_own(files, run):
    done = run("validate", "fit.json", "trial.csv", "--normalise", "session")
    refused(done, "--normalise")
