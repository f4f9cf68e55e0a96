"""`surae check`, and what `surae fit` makes of it."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from surae.cli.check import command
from surae.quality import recording_of
from surae.recording import columns, write_csv


@pytest.fixture
def paths(tmp_path, noisy):
    """A clean recording and one whose torque has the wrong sign."""
    recording = recording_of(noisy)
    table = columns(recording)
    write_csv(tmp_path / "clean.csv", table, ["emg: envelope"])
    table["torque_Nm"] = -table["torque_Nm"]
    write_csv(tmp_path / "wrong.csv", table, ["emg: envelope"])
    return str(tmp_path / "clean.csv"), str(tmp_path / "wrong.csv")


def run(*arguments):
    return CliRunner().invoke(command, list(arguments), standalone_mode=False)


def test_findings_are_no_failure_unless_strict(paths) -> None:
    clean, wrong = paths
    assert run(wrong).return_value == 0
    assert run(wrong, "--strict").return_value == 1
    assert run(clean, "--strict").return_value == 0


def test_the_screen_has_all_of_it_in_100_columns(paths) -> None:
    output = run(*paths).output
    assert "clean.csv: nothing found" in output
    assert "wrong.csv: 1 error" in output
    assert "torque-sign" in output
    assert "sign = -1" in output
    assert max(map(len, output.splitlines()[2:])) <= 100


def test_json_has_the_keys_of_every_finding(paths) -> None:
    data = json.loads(run(*paths, "--json").output)
    (finding,) = data["findings"]
    assert finding["code"] == "torque-sign"
    assert finding["recording"] == paths[1]
    keys = "code severity channel start_s end_s value message advice"
    assert set(keys.split()) <= set(finding)


def test_a_strict_fit_refuses_errors(paths) -> None:
    from surae.cli.fit import command as fit
    from surae.errors import InputError

    done = CliRunner().invoke(fit, [paths[1], "--prepared", "--strict"], standalone_mode=False)
    assert isinstance(done.exception, InputError)
    assert "torque-sign" in str(done.exception)


def test_a_fit_shows_what_was_found(tmp_path, noisy) -> None:
    from surae.cli.fit import command as fit

    table = columns(recording_of(noisy))
    table["torque_Nm"] = table["torque_Nm"] + 15.0
    write_csv(tmp_path / "offset.csv", table, ["emg: envelope"])
    arguments = [str(tmp_path / "offset.csv"), "--prepared", "--starts", "1"]
    output = CliRunner().invoke(fit, arguments, standalone_mode=False).output
    assert "warning torque-offset" in output
    assert np.count_nonzero(["surae check" in line for line in output.splitlines()]) == 1
