"""Options that make no sense: one line that names the option and what to write."""

import math
import re

import pytest

import surae
from surae import estimators
from surae.base.errors import InputError
from surae.cli.options import bare_name, entry, number, preparation, span, weighted_span
from surae.model.registry import MODELS

from .conftest import refused


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--model", "zz"], ("'zz'", "muscle-tendon")),
        (["--fixed", "zz=1"], ("'zz'", "k_tri")),
        (["--fixed", "m"], ("--fixed m", "name=value")),
        (["--fixed", "m=a"], ("--fixed m=a", "'a' is not a number")),
        (["--fixed", "m=2,5"], ("--fixed m=2,5", "write 2.5")),
        (["--fixed", "m=1", "--fixed", "m=2"], ("--fixed m", "twice")),
        (["--free", "m=2"], ("--free m=2", "without a value")),
        (["--start", "m=10"], ("start of m is 10", "1.2 … 3")),
        (["--start", "m=2", "--fixed", "m=2"], ("start of m has no effect",)),
        (["--bound", "m=1"], ("--bound m=1", "name=lower:upper")),
        (["--bound", "m=1:2", "--fixed", "m=2"], ("bounds of m have no effect",)),
        (["--fixed", "beta=99"], ("fixed value of beta is 99, outside its bounds 0.2 … 4",)),
        (["--filter", "bessel=3"], ("setting 'bessel' is not known",)),
        (["--report", "r.docx"], ("r.docx", ".html or .pdf")),
        (["--starts", "0"], ("starts is 0; give at least 1",)),
        (["--starts", "1000000000"], ("starts is 1000000000; give at most 10000",)),
        (["--seed", "-1"], ("seed is -1; give at least 0",)),
        (["--geometry", "zz"], ("--geometry", "'zz'", "virtual-work")),
        (["--theta-foot", "nan"], ("theta_foot is nan", "give a number")),
        (["--x-ref-tri", "-1"], ("x_ref_tri is -1.0; give more than 0",)),
    ],
)
def test_a_wrong_option(run, files, options, says) -> None:
    refused(
        run(
            "fit", "--model", "muscle", "trial.csv", "--prepared", "--output", "out.json", *options
        ),
        *says,
    )
    assert not (files / "out.json").exists()


def test_texts_of_values() -> None:
    assert entry("--fixed", " m = 2 ", "value", "m=1") == ("m", 2.0)
    assert entry("--bound", "m = 1 : 4", "lower:upper", "m=1:4") == ("m", (1.0, 4.0))
    assert number("x", "-1.5e-3") == -0.0015
    assert bare_name("--free", " m ") == "m"
    assert span("--exclude", ":3") == (-math.inf, 3.0, 0.0)
    assert weighted_span("--weight", "3::2") == (3.0, math.inf, 2.0)
    assert preparation("--filter", "bessel_hz=false") == ("bessel_hz", False)
    assert preparation("--filter", "bessel_order=4") == ("bessel_order", 4)
    with pytest.raises(InputError, match=r"x: '1,2,3' is not a number$"):
        number("x", "1,2,3")


@pytest.mark.parametrize("command", ["fit", "simulate"])
def test_the_help_lists_every_model(run, command) -> None:
    text = re.sub(r"-\s+", "-", run(command, "--help").out)  # lines break behind hyphens
    listed = re.split(r"[\s,.]+", text)
    assert set(MODELS) <= set(listed)


def test_the_help_states_the_true_defaults(run) -> None:
    text = " ".join(run("fit", "--model", "muscle", "--help").out.split())
    assert f"--starts N Number of starts, of a named model. [default: {estimators.STARTS}]" in text
    assert "--seed N Seed of the random starts. [default: 0]" in text
    assert surae.FitSettings().seed == 0
