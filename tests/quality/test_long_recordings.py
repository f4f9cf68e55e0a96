"""Recordings of many minutes: checked and fitted, at a cost that grows as they do."""

import time
import tracemalloc

import numpy as np
import pytest

import surae
from surae.inference.diagnosis.long import _of_windows
from surae.quality import Finding, Quality, check_recording
from surae.quality.finding import make_finding
from surae.quality.torque_model import activation
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


def long_trial(hours: float = 2.1, rate: float = 20.0) -> dict[str, np.ndarray]:
    """Columns of a leg that is moved and pushes now and then for hours."""
    t = np.arange(round(3600.0 * hours * rate)) / rate
    noise = np.random.default_rng(1).standard_normal((len(t), 5))
    angle = 0.26 * np.sin(0.63 * t) + 0.05 * np.sin(0.08 * t)
    calf = np.clip(np.sin(0.19 * t), 0.0, None) ** 2
    shin = np.clip(-np.sin(0.19 * t), 0.0, None) ** 2
    emg = 1e-4 * np.column_stack([shin, calf, calf, calf]) * (1.0 + 0.1 * noise[:, :4]) + 2e-6
    pulls = 30.0 * activation(calf, rate) - 10.0 * activation(shin, rate)
    torque = 6.0 + 10.0 * angle + 4.0 * np.exp(4.0 * angle) + pulls
    return {"time": t, "angle": angle, "torque": torque + 0.1 * noise[:, 4], "emg": np.abs(emg)}


def findings_of(columns: dict[str, np.ndarray]) -> dict[str, Finding]:
    recording = Recording.from_arrays(**columns, name="day", emg_kind="envelope")
    return {finding.code: finding for finding in surae.check(recording).findings}


def test_a_recording_of_hours_is_judged_in_windows_and_says_so() -> None:
    found = findings_of(long_trial())
    assert all(finding.severity == "info" for finding in found.values()), found
    assert "2.1 h" in found["looked-at-in-windows"].message
    short = {name: values[: 20 * 60 * 20] for name, values in long_trial().items()}
    assert "looked-at-in-windows" not in findings_of(short)


def test_what_is_wrong_for_minutes_of_hours_is_found() -> None:
    columns = long_trial()
    t = columns["time"]
    lost = (t > 4000.0) & (t < 4200.0)
    columns["emg"][lost, 2] = 3e-5
    columns["torque"][np.argmin(np.abs(t - 6000.0))] = 2000.0
    gone = (t < 5000.0) | (t > 5060.0)
    found = findings_of({name: values[gone] for name, values in columns.items()})
    assert found["emg-flat"].start_s == pytest.approx(4000.0, abs=1.0)
    assert found["emg-flat"].end_s == pytest.approx(4200.0, abs=1.0)
    assert found["torque-artefact"].start_s == pytest.approx(6000.0, abs=1.0)
    assert found["time-gap"].end_s == pytest.approx(5060.0, abs=1.0)


def test_what_is_wrong_all_along_is_said_once_of_a_recording_of_hours() -> None:
    columns = long_trial()
    found = findings_of(columns | {"torque": -columns["torque"]})
    assert found["torque-sign"].severity == "error"
    assert "of the 8 parts" in found["torque-sign"].message


def test_what_is_once_in_a_window_and_what_is_in_all_of_them() -> None:
    """A lack of one window is none of the recording; a clock is seen before it has run off."""

    def quality(*codes: str) -> Quality:
        return Quality("w", tuple(make_finding(c, None, (0.0, 1.0), None) for c in codes))

    windows = [quality("emg-clock", "active-not-active", "torque-sign", "mains-hum")]
    windows += [quality("torque-sign"), quality("active-not-active"), quality()]
    assert {f.code for f in _of_windows(windows)} == {"emg-clock", "torque-sign", "mains-hum"}
    assert not _of_windows([quality(), quality("emg-clock"), quality()])


def test_a_check_of_hours_needs_little_memory() -> None:
    columns = long_trial(4.0)
    recording = Recording.from_arrays(**columns, name="day", emg_kind="envelope")
    size = sum(channel.values.nbytes for channel in recording.channels.values())
    surae.check(recording)
    tracemalloc.start()
    surae.check(recording)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 4.0 * size
