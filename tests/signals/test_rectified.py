"""What is known of the noise of envelopes that are made of raw EMG."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from ankle_legs.movement import effort
from surae.base.frozen import read_only
from surae.recording import Recording
from surae.signals import ModelInputs, inputs_as_given, noise_alone, prepare, steady_emg
from surae.signals.rectified import expected_drives, rectified_density

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


def test_the_expected_drive_pulls_no_gradient_and_is_nearer() -> None:
    rng = np.random.default_rng(4)
    time = np.arange(round(60.0 * 256.0)) / 256.0
    drive = bursts(time)
    inputs = prepare(recorded(np.stack([raw_emg(rng, 256.0, drive)] * 4, axis=1), 256.0))
    calm = expected_drives(inputs)
    truth = drive * (inputs.emg[:, 0].mean() / drive.mean())
    before, after = (each.emg[:, 0] - truth for each in (inputs, calm))
    assert np.std(after) < 0.35 * np.std(before)
    slopes = [float(truth @ e.emg[:, 0] / (e.emg[:, 0] @ e.emg[:, 0])) for e in (inputs, calm)]
    assert slopes[0] < 0.8
    assert slopes[1] == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("density", [0.6e-3, 3e-3])
def test_bursts_of_another_author_keep_their_edges(density: float) -> None:
    """Two thirds of the noise go, and neither bursts nor rest are blurred.

    A stationary filter (Wiener's) leaves no less noise, 2.6 and 4.9 of blur, and bursts in what is
    rest; muscles then seem to let go slowly.
    """
    rate, found = 64.0, []
    for seed in range(2):
        rng = np.random.default_rng(seed)
        time = np.arange(round(35.0 * rate)) / rate
        drive = effort(rng, time, "active") + 3e-3
        shape = 1.0 / (density * rate)
        noisy = drive * rng.gamma(shape, 1.0 / shape, drive.shape)
        motion = np.sin(time), np.cos(time), -np.sin(time)
        inputs = inputs_as_given("given", rate, time, motion, noisy.T)
        left = expected_drives(replace(inputs, rectified=(density,) * 4)).emg.T - drive
        bent = np.gradient(np.gradient(drive, axis=1), axis=1)
        blur = np.sum(left * bent) / np.sum(bent**2)
        found.append((np.std(left) / np.std(noisy - drive), blur, left[drive < 0.02].mean()))
    kept, blur, at_rest = np.mean(found, axis=0)
    assert kept < 0.4
    assert abs(blur) < 1.6
    assert abs(at_rest) < 2e-4


def test_envelopes_of_unknown_making_stay_as_they_are() -> None:
    time = np.arange(3000) / 100.0
    emg = np.stack([bursts(time)] * 4, axis=1)
    inputs = inputs_as_given("given", 100.0, time, (np.sin(time), np.cos(time), -np.sin(time)), emg)
    assert inputs.rectified == ()
    assert expected_drives(inputs) is inputs


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
