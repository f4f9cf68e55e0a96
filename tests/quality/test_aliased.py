"""EMG that was sampled without a filter before is told, other EMG is not."""

import numpy as np
import pytest
from scipy.signal import butter, decimate, sosfilt

from surae.quality import check_recording
from surae.recording import Recording


def recorded(emg: np.ndarray, rate_hz: float) -> Recording:
    time = np.arange(len(emg)) / rate_hz
    angle, torque = 0.3 * np.sin(time), 5.0 * np.sin(time) + 2e5 * np.abs(emg)
    return Recording.from_arrays(time, angle, torque, np.stack([emg] * 4, axis=1), emg_kind="raw")


@pytest.mark.parametrize(("every", "filtered", "told"), [(1, False, False), (8, False, True),
                                                         (8, True, False)])  # fmt: skip
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
