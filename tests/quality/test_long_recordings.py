"""Recordings of many minutes: checked and fitted, at a cost that grows as they do."""

import time
import tracemalloc

import numpy as np
import pytest

import surae
from surae.quality import check_recording
from surae.recording import Recording


def steady(seconds: float, rate: float = 100.0) -> Recording:
    """A leg that is moved up and down without an end, and pushes now and then."""
    t = np.arange(round(seconds * rate)) / rate
    noise = np.random.default_rng(0).standard_normal((len(t), 5))
    angle = 0.25 * np.sin(np.pi * t)
    active = np.clip(np.sin(0.8 * t), 0.0, None)
    emg = np.abs(1e-4 * active[:, None] * (1.0 + 0.1 * noise[:, :4]) + 1e-6)
    torque = 20.0 * angle + 30.0 * active + 5.0 + 0.1 * noise[:, 4]
    return Recording.from_arrays(t, angle, torque, emg, name="steady", emg_kind="envelope")


@pytest.mark.parametrize("seconds", [319.0, 321.0, 1800.0])
def test_a_recording_of_any_length_is_checked(seconds: float) -> None:
    codes = {finding.code for finding in check_recording(steady(seconds, 25.0)).findings}
    assert "trial-too-short" not in codes
    assert "rom-not-covered" in codes


def test_seven_minutes_are_checked_and_fitted() -> None:
    fit = surae.fit(steady(420.0, 25.0), "muscle", prepared=True, starts=1)
    assert fit.status != "failed"
    assert len(fit.quality) == 1


def test_a_check_costs_as_much_more_as_the_recording_is_longer() -> None:
    """What grew with the square of the length would need sixteen times as much."""
    work, memory = [], []
    for seconds in (100.0, 400.0):
        recording = steady(seconds)
        check_recording(recording)
        begun = time.process_time()
        tracemalloc.start()
        check_recording(recording)
        memory.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        work.append(time.process_time() - begun)
    assert memory[1] < 5.0 * memory[0]
    assert work[1] < 10.0 * work[0]
