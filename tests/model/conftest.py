"""Rich random inputs for the models, with exact derivatives of the angle."""

from collections.abc import Callable

import numpy as np
import pytest

from surae.signals import ModelInputs

MakeInputs = Callable[..., ModelInputs]


def random_inputs(
    seed: int = 0,
    *,
    rate_hz: float = 256.0,
    seconds: float = 6.0,
    emg_scale: float = 3e-4,
    reach: float = 0.6,
) -> ModelInputs:
    """Eight sines up to 1.5 Hz (4.5 rad/s at most) about −0.15 rad, and four positive EMGs.

    The phases come from the seed, so that no two channels are alike; everything is a closed form
    of time, so that another rate gives samples of the same movement.
    """
    rng = np.random.default_rng(seed)
    n = round(seconds * rate_hz)
    time = np.arange(n) / rate_hz
    omega = 2 * np.pi * rng.uniform(0.1, 1.5, 8)
    size = rng.uniform(0.3, 1.0, 8)
    size *= reach / size.sum()
    phase = np.outer(time, omega) + rng.uniform(0, 2 * np.pi, 8)
    waves = rng.uniform(0.3, 2.5, (3, 4)), rng.uniform(0, 2 * np.pi, (3, 4))
    emg = sum(np.sin(2 * np.pi * np.outer(time, f) + p) for f, p in zip(*waves, strict=True)) ** 2
    return ModelInputs(
        name=f"random {seed}",
        rate_hz=rate_hz,
        time=time,
        angle=-0.15 + np.sin(phase) @ size,
        velocity=np.cos(phase) @ (size * omega),
        acceleration=-np.sin(phase) @ (size * omega**2),
        emg=emg_scale * emg / 4,
        emg_unit="V",
        torque=None,
    )


@pytest.fixture(scope="session")
def make_inputs() -> MakeInputs:
    return random_inputs
