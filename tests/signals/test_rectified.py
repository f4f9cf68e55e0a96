"""What is known of the noise of envelopes that are made of raw EMG."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from surae.base.frozen import read_only
from surae.recording import Recording
from surae.signals import ModelInputs, noise_alone, prepare, steady_emg
from surae.signals.rectified import rectified_density

SECONDS = 300.0


def raw_emg(rng: np.random.Generator, rate_hz: float, drive: np.ndarray) -> np.ndarray:
    """Gaussian noise of 20 to 400 Hz, or up to Nyquist, whose mean modulus is the drive."""
    noise = rng.normal(size=drive.size)
    high = min(400.0, 0.49 * rate_hz)
    noise = sosfilt(butter(2, [20.0, high], "bandpass", fs=rate_hz, output="sos"), noise)
    return drive * noise / np.mean(np.abs(noise))


def recorded(emg: np.ndarray, rate_hz: float, torque: np.ndarray | None = None) -> Recording:
    time = np.arange(len(emg)) / rate_hz
    angle = 0.2 * np.sin(time)
    return Recording.from_arrays(time, angle, torque, emg, emg_kind="raw")


@pytest.mark.parametrize("rate_hz", [200.0, 256.0, 341.0, 512.0, 1024.0, 2048.0, 4096.0])
def test_the_density_is_that_of_monte_carlo(rate_hz: float) -> None:
    """Averages of the envelope over a second scatter by the density, whatever the rate."""
    rng = np.random.default_rng(round(rate_hz))
    size = 20e-6
    emg = raw_emg(rng, rate_hz, np.full((round(SECONDS * rate_hz)), size))
    inputs = prepare(recorded(np.stack([emg] * 4, axis=1), rate_hz))
    envelope = inputs.emg[:, 0] / inputs.emg[:, 0].mean()
    width = round(0.5 * inputs.rate_hz)
    averages = envelope[: len(envelope) // width * width].reshape(-1, width).mean(axis=1)
    scattered = 0.5 * np.var(averages, ddof=1)  # of averages over half a second
    # 600 averages tell a variance to 6 %
    assert inputs.rectified[0] == pytest.approx(scattered, rel=0.18)
    assert len(set(inputs.rectified)) == 1


def test_the_density_of_white_noise_has_a_closed_form() -> None:
    white = np.random.default_rng(1).normal(size=200_000)
    assert rectified_density(white, 500.0) == pytest.approx((np.pi / 2 - 1) / 500.0, rel=0.02)
    assert rectified_density(3.0 * white, 500.0) == rectified_density(white, 500.0)
    assert rectified_density(np.zeros(1000), 500.0) == 0.0


def bursts(time: np.ndarray) -> np.ndarray:
    return 1e-4 * np.maximum(np.sin(2 * np.pi * 0.4 * time), 0.0) ** 2 + 2e-6


def with_emg(*columns: np.ndarray, rate_hz: float) -> ModelInputs:
    return prepare(recorded(np.stack(columns, axis=1), rate_hz))


@pytest.mark.parametrize("rate_hz", [204.8, 1024.0])
def test_noise_is_steady_and_an_effort_is_not(rate_hz: float) -> None:
    rng = np.random.default_rng(2)
    time = np.arange(round(30.0 * rate_hz)) / rate_hz
    noise = 5e-6 * rng.normal(size=(2, time.size))
    effort = raw_emg(rng, rate_hz, bursts(time) * 5.0)
    tonic = raw_emg(rng, rate_hz, np.full(time.size, 1e-4))
    inputs = with_emg(effort, noise[0], tonic, noise[1], rate_hz=rate_hz)
    assert steady_emg([inputs]) == (False, True, True, True)
    assert noise_alone([inputs]) == {1, 3}
    louder = replace(inputs, emg=read_only(inputs.emg * np.where(np.arange(4) == 1, 50.0, 1.0)))
    assert noise_alone([louder]) == {3}


@pytest.mark.parametrize("every", [2, 3, 4])
def test_a_slow_rate_makes_envelopes_smaller_by_what_aliases_below_the_high_pass(every) -> None:
    emg = np.random.default_rng(every).normal(size=(round(60.0 * 1024), 4))
    whole = prepare(recorded(emg, 1024.0))
    slow = prepare(recorded(emg[::every], 1024.0 / every))
    smaller = np.log(whole.emg[:, 0].mean() / slow.emg[:, 0].mean())
    assert slow.emg_lost == pytest.approx(smaller, abs=0.02)
    assert whole.emg_lost == 0.0
