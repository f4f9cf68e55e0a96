"""Parameters and fits that cannot be used: one line that names the file and what is wrong."""

import json

import pytest

from .conftest import refused


def _parameters(files, change) -> str:
    content = json.loads((files / "true.json").read_text(encoding="utf-8"))
    change(content["parameters"])
    (files / "p.json").write_text(json.dumps(content), encoding="utf-8")
    return "p.json"


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda p: p.clear(), ("no parameters",)),
        (lambda p: p.pop("f0"), ("needs a value for: f0",)),
        (lambda p: p.update(zz=1.0), ("'zz'", "k_tri")),
        (lambda p: p.update(m="2"), ("parameters.m: '2'", "number")),
    ],
)
def test_wrong_parameters(run, files, change, says) -> None:
    path = _parameters(files, change)
    done = run("simulate", "trial.csv", "--parameters", path, "--output", "out.csv")
    refused(done, "p.json: ", *says)
    assert not (files / "out.csv").exists()


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", ("JSON", "line 1")),
        (b'{"parameters": {"m": 2.0,}}', ("JSON", "line 1", "column 26")),
        (b'{"parameters": {"m": 1' + 5000 * b"0" + b"}}", ("thousands of digits",)),
        (b"[" * 100_000, ("nested too deeply",)),
        (b"\xff\xfe", ("not a text file",)),
    ],
)
def test_what_is_no_json_of_parameters(run, files, content, says) -> None:
    (files / "p.json").write_bytes(content)
    done = run("simulate", "trial.csv", "--parameters", "p.json", "--output", "out.csv")
    refused(done, "p.json: ", *says)


def test_a_recording_is_no_fit(run, files) -> None:
    (files / "notes.txt").write_text("nothing\nat all\n", encoding="utf-8")
    refused(run("measures", "trial.csv"), "trial.csv: this is a recording; fit it first")
    refused(run("measures", "notes.txt"), "notes.txt: not JSON")


def _set(*keys_and_value):
    *keys, last, value = keys_and_value

    def change(content) -> None:
        for key in keys:
            content = content[key]
        content[last] = value

    return change


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda f: f.pop("R"), ("R: it is missing",)),
        (_set("R", "data", "!!!"), ("damaged",)),
        (_set("parameters", "m", "value", -5), ("m is -5 kg",)),
    ],
)
def test_a_damaged_fit(run, edit_fit, change, says) -> None:
    edit_fit("f.json", change)
    refused(run("validate", "f.json", "trial.csv"), "f.json: ", *says)


def test_files_that_are_missing(run, files) -> None:
    refused(run("validate", "gone.json", "trial.csv"), "gone.json", "no such file")
    refused(run("validate", "fit.json", "gone.csv"), "gone.csv", "no such file")
    done = run("simulate", "trial.csv", "--parameters", "gone.json", "--output", "out.csv")
    refused(done, "gone.json", "no such file")
    done = run("simulate", "gone.csv", "--parameters", "true.json", "--output", "out.csv")
    refused(done, "gone.csv", "no such file")
