"""A trial is judged by what its folder knows of each electrode: relaxed is not dead."""

from dataclasses import replace

import numpy as np
import pytest

import surae
import surae.api
from surae.base.frozen import read_only
from surae.recording import Recording


@pytest.fixture(scope="module")
def leg() -> dict[str, Recording]:
    """An active and a relaxed trial of one leg of another generator, raw EMG."""
    make = pytest.importorskip("ankle_legs.make")
    one = make.leg("a", 31)
    trials = {}
    for kind in ("active", "passive"):
        columns = one.columns(one.record(1, 35.0, kind), 1, raw=True)
        emg = np.column_stack([v for name, v in columns.items() if name[:4] == "emg_"])
        signals = (columns[name] for name in ("time_s", "angle_rad", "torque_Nm"))
        trials[kind] = replace(Recording.from_arrays(*signals, emg, emg_kind="raw"), name=kind)
    return trials


def with_emg(recording: Recording, muscle: str, values) -> Recording:
    role = f"emg_{muscle}"
    channel = replace(recording.channels[role], values=read_only(np.asarray(values)))
    return replace(recording, channels={**recording.channels, role: channel})


def noise_in(recording: Recording, muscle: str, volts: float) -> Recording:
    n = len(recording.channels[f"emg_{muscle}"].values)
    return with_emg(recording, muscle, volts * np.random.default_rng(5).standard_normal(n))


def flat(trials) -> list[dict[str, str]]:
    """Severity of what is said to be flat, by channel, of each trial."""
    return [
        {f.channel: f.severity for f in quality.findings if f.code == "emg-flat"}
        for quality in surae.api.check_together(trials)
    ]


@pytest.mark.parametrize("gain", [1.0, 1e3, 1e-3])
def test_noise_of_one_strength_is_what_a_relaxed_trial_shows(leg, gain) -> None:
    relaxed = leg["passive"]
    for muscle in ("ta", "gl", "sol", "gm"):
        relaxed = noise_in(relaxed, muscle, 3e-6)
    trials = [leg["active"], relaxed]
    for muscle in ("ta", "gl", "sol", "gm"):
        trials = [with_emg(t, muscle, gain * t.channels[f"emg_{muscle}"].values) for t in trials]
    assert flat(trials) == [{}, {}]
    assert flat(trials[1:]) == [{}]  # nor is it, alone


def test_noise_alone_is_a_dead_electrode_where_the_torque_shows_its_muscle(leg) -> None:
    """Of a head beside others that work it is a doubt: one of them may rest."""
    dead = noise_in(leg["active"], "ta", 2e-6)
    assert flat([leg["active"], dead])[1] == {"emg_ta": "error"}
    beside = noise_in(leg["active"], "sol", 2e-6)
    assert flat([leg["active"], beside])[1] == {"emg_sol": "warning"}


def test_a_constant_is_an_error_where_the_electrode_works_elsewhere(leg) -> None:
    constant = with_emg(leg["active"], "gl", np.zeros(len(leg["active"].channels["emg_gl"].values)))
    assert flat([leg["active"], constant])[1] == {"emg_gl": "error"}
    # of a muscle that no trial has it is as one that is missing, and leaves no trial out
    assert flat([constant, replace(constant, name="again")]) == [{"emg_gl": "warning"}] * 2
