import pytest

import surae
from surae import api

from .conftest import refused


def test_a_trial_is_written_that_surae_reads(run, tmp_path) -> None:
    done = run("example", "trial.csv")
    assert (done.code, done.err) == (0, "")
    assert set(surae.read(tmp_path / "trial.csv").channels) >= {"angle", "torque", "emg_sol"}


@pytest.mark.parametrize("arguments", [[], ["trial.csv", "--folder", "leg"]])
def test_one_of_both_is_written(run, arguments) -> None:
    refused(run("example", *arguments), "FILE.csv to write, or --folder DIR")


@pytest.mark.slow
def test_a_folder_of_trials_is_a_leg_of_holds_and_movements(tmp_path) -> None:
    files = api.example_leg(tmp_path)
    trials = surae.session(files).trials
    assert sum(trial.use == "hold" for trial in trials) == 4
    assert sorted(trial.effort for trial in trials if trial.use == "fit") == [
        "active",
        "active",
        "passive",
    ]
    assert not any(trial.problem for trial in trials)
