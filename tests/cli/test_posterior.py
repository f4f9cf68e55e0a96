import json

import pytest

import surae

from .conftest import refused

FEW = ("--draws", 60, "--evaluations", 700)


def test_the_posterior_beside_the_covariance(run, files) -> None:
    done = run("posterior", "fit.json", *FEW, "--seed", 3, "--output", "posterior.json")
    content = json.loads((files / "posterior.json").read_text(encoding="utf-8"))
    assert (done.code, bool(done.err)) == (
        (0, False) if content["status"] == "reliable" else (1, True)
    )
    lines = done.out.splitlines()
    assert "95 % credible" in lines[1]
    assert lines[3].split()[0] == "m"
    assert f"{content['status']}: {content['message']}" in done.out
    noise = surae.load(files / "fit.json").assessment.interval_note
    assert f"variance of the noise ×1: {noise}" in lines
    assert content["variance_inflation_reason"] == noise
    assert "posterior: posterior.json" in done.out

    again = surae.posterior(surae.load(files / "fit.json"), draws=60, evaluations=700, seed=3)
    assert content["samples"]["f0"] == again.of("f0").tolist()
    assert again["f0"].ci95 == tuple(content["parameters"]["f0"]["ci95"])


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--draws", "1"], "draws is 1; give at least 10"),
        (["--variance-inflation", "0"], "variance_inflation is 0.0; give more than 0"),
        (["--prior", "f0=2"], "name=median:spread"),
        (["--prior", "nope=2:1"], "not estimated"),
        (["--output", "fit.json"], "is read by this command"),
    ],
)
def test_wrong_use(run, files, arguments, says) -> None:
    refused(run("posterior", "fit.json", *arguments), says)
