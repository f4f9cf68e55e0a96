import json

import numpy as np
import pytest

import surae

from .conftest import refused


@pytest.fixture
def second(edit):
    """The second half of the trial, with another noise."""

    def half(header: list[str], rows: list[list[str]]) -> None:
        del rows[:1200]
        noise = np.random.default_rng(2).standard_normal(len(rows))
        for row, more in zip(rows, noise, strict=True):
            row[2] = repr(float(row[2]) + 0.5 * float(more))

    return edit("second half.csv", half)


def test_the_figures_are_those_of_the_api(run, files, second) -> None:
    done = run("validate", "fit.json", "second half.csv", "--output", "v.json")
    assert (done.code, done.err) == (0, "")
    assert "second half.csv" in done.out
    assert "validation: v.json" in done.out
    content = json.loads((files / "v.json").read_text(encoding="utf-8"))
    assert list(content) == ["recordings"]
    (recording,) = content["recordings"]
    predicted = surae.load(files / "fit.json").predict(second)
    assert recording == {
        "path": "second half.csv",
        "vaf": predicted.vaf,
        "rmse_Nm": predicted.rmse,
        "bias_Nm": predicted.bias,
        "torque_ci95_covers": predicted.covers,
        "template_vaf": None,
        "template_reason": predicted.baselines.template_reason,
        "ridge_vaf": predicted.baselines.ridge,
        "r2": predicted.adequacy.r2,
        "grade": str(predicted.adequacy.grade),
        "reasons": list(predicted.adequacy.reasons),
    }
    assert f"second half.csv: {predicted.adequacy.grade}: " in done.out
    assert 90 < recording["vaf"] < 100
    assert f"{recording['vaf']:.2f}" in done.out


def test_several_recordings_keep_their_order(run, files, second) -> None:
    done = run("validate", "fit.json", "second half.csv", "trial.csv", "--output", "v.json")
    assert done.code == 0
    content = json.loads((files / "v.json").read_text(encoding="utf-8"))
    assert [recording["path"] for recording in content["recordings"]] == [
        "second half.csv",
        "trial.csv",
    ]
    assert content["recordings"][0]["vaf"] < content["recordings"][1]["vaf"]


def test_the_recordings_of_the_fit_prove_nothing(run, files, second) -> None:
    done = run("validate", "fit.json", "trial.csv", "second half.csv")
    assert "trial.csv was used in the fit" in done.out
    assert "second half.csv was used" not in done.out


def test_what_cannot_be_predicted(run, files, edit) -> None:
    def without(name: str):
        def change(header: list[str], rows: list[list[str]]) -> None:
            column = header.index(name)
            for row in [header, *rows]:
                del row[column]

        return change

    def normalise(header: list[str], rows: list[list[str]]) -> None:
        header[3:] = [name.replace("_V", "_1") for name in header[3:]]

    edit("a.csv", without("torque_Nm"))
    refused(run("validate", "fit.json", "a.csv"), "a.csv", "no torque")
    edit("b.csv", without("emg_sol_V"))
    refused(run("validate", "fit.json", "b.csv"), "b.csv", "'sol'", "emg_sol")
    edit("c.csv", normalise)
    refused(run("validate", "fit.json", "c.csv"), "c.csv", "'1'", "'V'")


def test_a_fit_whose_numbers_overflow_is_refused(run, files, edit_fit) -> None:
    def change(content) -> None:
        content["parameters"]["k_tri"].update(value=1e6)

    edit_fit("f.json", change)
    done = run("validate", "f.json", "trial.csv", "--output", "v.json")
    refused(done, "f.json", "not those that were fitted")

    def unsealed(content) -> None:
        change(content)
        del content["sha256"]  # as files of before have none

    edit_fit("f.json", unsealed)
    done = run("validate", "f.json", "trial.csv", "--output", "v.json")
    refused(done, "f.json", "beyond any leg")
    assert not (files / "v.json").exists()


def test_one_mapping_describes_what_is_predicted(run, files, second) -> None:
    names, *rows = second.read_text(encoding="utf-8").splitlines()
    roles = [name.rpartition("_") for name in names.split(",")[1:]]
    foreign = ["time_s", *(f"c{i}" for i, _ in enumerate(roles))]
    text = "\n".join([",".join(foreign), *rows])
    (files / "foreign.csv").write_text(text, encoding="utf-8")
    mapping = [
        f'channels.{role} = {{ column = "c{i}", unit = "{unit}" }}'
        for i, (role, _, unit) in enumerate(roles)
    ]
    (files / "map.toml").write_text("\n".join(mapping), encoding="utf-8")
    vafs = []
    for file, more in (("second half.csv", ()), ("foreign.csv", ("--mapping", "map.toml"))):
        done = run("validate", "fit.json", file, *more, "--output", "v.json")
        assert (done.code, done.err) == (0, "")
        content = json.loads((files / "v.json").read_text(encoding="utf-8"))
        vafs.append(content["recordings"][0]["vaf"])
    assert vafs[0] == vafs[1]
