"""`surae validate` with a report, and with one recording left out in turn."""

import json

import pytest

import surae

from .conftest import refused


@pytest.fixture
def three(edit):
    """The trial in three parts of its own, as files."""

    def part(first: int, last: int):
        def change(header: list[str], rows: list[list[str]]) -> None:
            rows[:] = rows[first:last]

        return change

    return [edit(f"{i}.csv", part(800 * i, 800 * (i + 1))).name for i in range(3)]


def test_each_is_predicted_from_the_others(run, files, three) -> None:
    options = ("--leave-one-out", "--prepared", "--starts", "1", "--fixed", "beta=1")
    done = run("validate", *options, *three, "--output", "v.json", "--figure", "v.pdf")
    assert done.code == 0, done
    assert "all together" in done.out
    assert (files / "v.pdf").read_bytes().startswith(b"%PDF-")
    content = json.loads((files / "v.json").read_text(encoding="utf-8"))
    assert content["model"] == "muscle"
    assert [recording["path"] for recording in content["recordings"]] == three
    left_out = surae.leave_one_out(
        [files / name for name in three], prepared=True, starts=1, fixed={"beta": 1.0}
    )
    assert content["pooled"] == {
        "vaf": left_out.pooled.vaf, "rmse_Nm": left_out.pooled.rmse, "bias_Nm": left_out.pooled.bias
    }  # fmt: skip
    for recording, made in zip(content["recordings"], left_out.recordings, strict=True):
        assert recording["vaf"] == made.prediction.vaf
        assert recording["rmse_Nm"] == made.prediction.rmse
        assert recording["bias_Nm"] == made.prediction.bias
        assert recording["parameters"] == dict(made.fit.values)
        assert recording["status"] == made.fit.status


def test_options_of_the_fit_go_along(run, files, three) -> None:
    options = ("--leave-one-out", "--prepared", "--starts", "1", "--model", "muscle-2010")
    done = run(
        "validate", *options, *three[:2], "--exclude", ":1", "--loss", "tukey",
        "--priors", "healthy", "--output", "v.json",
    )  # fmt: skip
    assert done.code == 0, done
    content = json.loads((files / "v.json").read_text(encoding="utf-8"))
    assert content["model"] == "muscle-2010"


@pytest.mark.slow
def test_the_report_shows_the_predictions(run, files, three) -> None:
    done = run("validate", "fit.json", *three[:2], "--report", "v.html", "--exclude", "2:3")
    assert done.code == 0, done
    assert "report: v.html" in done.out
    page = (files / "v.html").read_text(encoding="utf-8")
    section = page.split('id="predictions"')[1].split("</section>")[0]
    assert section.count("data:image/png") == 2


def test_wrong_use(run, files, three) -> None:
    refused(run("validate", "--leave-one-out", *three, "--report", "v.html"), "--report")
    refused(run("validate", "--leave-one-out", three[0], three[0]), "given twice")
    refused(run("validate", "--leave-one-out", three[0]), "REC")
    refused(run("validate", "--leave-one-out", "fit.json", three[0]), "fit.json")
    refused(run("validate", "fit.json", three[0], "--model", "muscle"), "--model has no effect")
    refused(run("validate", "fit.json", three[0], "--robust"), "--robust has no effect")
    refused(run("validate", "fit.json", three[0], "--priors", "healthy"), "--priors has no effect")
    refused(run("validate", "fit.json", three[0], "--geometry", "thesis"), "--geometry has no")
