"""EMG that was sampled without a filter before is told, other EMG is not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, decimate, sosfilt

from surae.quality import check_recording
from surae.recording import Recording


def recorded(emg: np.ndarray, rate_hz: float) -> Recording:
    time = np.arange(len(emg)) / rate_hz
    angle, torque = 0.3 * np.sin(time), 5.0 * np.sin(time) + 2e5 * np.abs(emg)
    return Recording.from_arrays(time, angle, torque, np.stack([emg] * 4, axis=1), emg_kind="raw")


@pytest.mark.parametrize(
    ("every", "filtered", "told"), [(1, False, False), (8, False, True), (8, True, False)]
)
def test_folded_emg_is_told_before_a_fit(every: int, filtered: bool, told: bool) -> None:
    rng, rate = np.random.default_rng(3), 2048.0
    time = np.arange(round(20.0 * rate)) / rate
    band = butter(2, [20.0, 400.0], "bandpass", fs=rate, output="sos")
    drive = 2e-4 * np.maximum(np.sin(2.0 * time), 0.0) ** 2
    emg = drive * sosfilt(band, rng.normal(size=time.size)) + 2e-6 * rng.normal(size=time.size)
    emg = decimate(emg, every, zero_phase=True) if filtered else emg[::every]
    findings = check_recording(recorded(emg, rate / every)).findings
    aliased = [f for f in findings if f.code == "emg-aliased"]
    assert {f.channel for f in aliased} == (
        {"emg_ta", "emg_gl", "emg_sol", "emg_gm"} if told else set()
    )
    assert all(f.severity == "warning" and "folded" in f.message for f in aliased)


def test_the_noise_of_an_amplifier_at_rest_tells_nothing() -> None:
    noise = 2e-6 * np.random.default_rng(4).normal(size=40 * 512)
    assert not [f for f in check_recording(recorded(noise, 512.0)).findings if "alias" in f.code]


@pytest.mark.parametrize(("rate", "slow"), [(100.0, True), (160.0, True), (170.0, False)])
def test_raw_emg_too_slow_for_its_filter_is_an_error_before_a_fit(rate: float, slow: bool) -> None:
    rng = np.random.default_rng(5)
    time = np.arange(round(20.0 * rate)) / rate
    emg = (2e-6 + 2e-4 * np.maximum(np.sin(2.0 * time), 0.0)) * rng.normal(size=time.size)
    findings = check_recording(recorded(emg, rate)).findings
    too_slow = [f for f in findings if f.code == "emg-aliased" and f.severity == "error"]
    assert len(too_slow) == (4 if slow else 0)
    assert all("needs 164 Hz" in f.message and "1000 Hz" in f.advice for f in too_slow)
    lower = replace(recorded(emg, rate), prepare={"emg_highpass_hz": 20.0})
    assert "error" not in {f.severity for f in check_recording(lower).findings if "alias" in f.code}


@pytest.mark.parametrize("offset", [0.0, 0.01, -0.01])
def test_emg_that_is_clipped_on_an_offset_is_told(offset: float) -> None:
    rng, time = np.random.default_rng(6), np.arange(20 * 1000) / 1000.0
    emg = (2e-6 + 2e-4 * np.maximum(np.sin(2.0 * time), 0.0)) * rng.normal(size=time.size)
    for one_side in (np.minimum(emg, 2e-4), np.maximum(emg, -2e-4)):
        found = check_recording(recorded(one_side + offset, 1000.0)).findings
        assert "emg-clipped" in {f.code for f in found if f.channel == "emg_ta"}
    assert not [
        f
        for f in check_recording(recorded(emg + offset, 1000.0)).findings
        if f.code == "emg-clipped"
    ]


@pytest.mark.parametrize(("volts", "told"), [(2e-4, True), (3e-6, False)])
def test_a_channel_of_noise_alone_is_told_unless_its_muscle_rests(volts: float, told: bool) -> None:
    rng, time = np.random.default_rng(8), np.arange(30 * 1000) / 1000.0
    emg = 2e-6 + 2e-4 * np.maximum(np.sin(2.0 * time), 0.0)[:, None] * rng.normal(size=(30000, 4))
    emg[:, 2] = volts * rng.normal(size=len(time))
    angle, torque = 0.3 * np.sin(time), 5.0 * np.sin(time) + 2e5 * np.abs(emg[:, 1])
    findings = check_recording(
        Recording.from_arrays(time, angle, torque, emg, emg_kind="raw")
    ).findings
    noise = [f.channel for f in findings if "of one strength" in f.message]
    assert len(noise) == told
