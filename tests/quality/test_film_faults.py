"""What the gate finds in a film of fascicles, planted in one that fits angle and torque."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from surae.base.frozen import read_only
from surae.quality.registry import check_recording
from surae.recording import Channel, Recording

_TIME = np.arange(0.0, 20.0, 0.005)
_FRAMES = np.arange(0.7, 19.4, 0.03)


def _length(time: np.ndarray) -> np.ndarray:
    angle = 0.4 * np.sin(1.3 * time) + 0.1 * np.sin(3.1 * time)
    torque = -20.0 + 15.0 * np.sin(0.9 * time + 1.0)
    noise = np.random.default_rng(1).normal(0.0, 2e-4, len(time))
    return 0.068 - 0.03 * angle + 2.4e-4 * torque + noise


def _filmed(time: np.ndarray = _FRAMES, length: np.ndarray | None = None) -> Recording:
    angle = 0.4 * np.sin(1.3 * _TIME) + 0.1 * np.sin(3.1 * _TIME)
    torque = -20.0 + 15.0 * np.sin(0.9 * _TIME + 1.0)
    values = _length(time) if length is None else length
    channels = (
        Channel("angle", _TIME, read_only(angle), "rad", "made"),
        Channel("torque", _TIME, read_only(torque), "Nm", "made"),
        Channel("fascicle_tib", read_only(time), read_only(values), "m", "made"),
    )
    return Recording("filmed", {channel.role: channel for channel in channels})


def _codes(recording: Recording) -> set[str]:
    return {f.code for f in check_recording(recording).findings if f.code.startswith("film-")}


def _jumping(length: np.ndarray) -> np.ndarray:
    length[200:] += 6e-3
    return length


def _repeating(length: np.ndarray) -> np.ndarray:
    return np.repeat(length[::2], 2)[: len(length)]


FAULTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "film-unit": lambda length: 10.0 * length,
    "film-jump": _jumping,
    "film-repeated": _repeating,
    "film-drift": lambda length: length + np.linspace(0.0, 8e-3, len(length)),
    "film-clock": lambda length: np.roll(length, 5),
}


def test_a_good_film_has_no_findings() -> None:
    assert _codes(_filmed()) == set()


@pytest.mark.parametrize("code", FAULTS)
def test_a_planted_fault_is_found(code: str) -> None:
    assert code in _codes(_filmed(length=FAULTS[code](_length(_FRAMES))))


def test_lost_frames_are_found_and_hide_no_other_signal() -> None:
    kept = np.r_[0:100, 180 : len(_FRAMES)]
    recording = _filmed(_FRAMES[kept])
    codes = {finding.code for finding in check_recording(recording).findings}
    assert "film-lost" in codes
    assert "time-gap" not in codes


def test_a_film_of_a_part_shortens_no_check_of_the_rest() -> None:
    recording = _filmed(_FRAMES[:60])
    short = check_recording(recording)
    whole = check_recording(replace(recording, channels=recording.signals))
    assert {f.code for f in short.findings} == {f.code for f in whole.findings}
