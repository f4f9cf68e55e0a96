"""What puts a signal right is an option of every command that reads recordings."""

import numpy as np
import pytest

import surae

from .conftest import refused

RIGHT = ("--sign", "angle=-1", "--swap", "ta:sol")


def test_signals_are_put_right_where_they_are_read(run, files) -> None:
    assert run("check", "trial.csv", *RIGHT).code == 0
    assert run("convert", "trial.csv", "out.csv", *RIGHT).code == 0
    before, after = surae.read("trial.csv").channels, surae.read("out.csv").channels
    np.testing.assert_allclose(after["angle"].values, -before["angle"].values, rtol=1e-6)
    np.testing.assert_allclose(after["emg_ta"].values, before["emg_sol"].values, rtol=1e-6)


@pytest.mark.parametrize(
    ("option", "words"),
    [
        (("--sign", "angle=x"), "not a number"),
        (("--sign", "angle=3"), "1 or -1"),
        (("--swap", "ta"), "two muscles"),
        (("--offset", "ankle=3"), "no such signal"),
        (("--scale", "torque=2", "--scale", "torque=3"), "given twice"),
    ],
)
def test_a_slip_is_refused(run, files, option, words) -> None:
    refused(run("check", "trial.csv", *option), words)
