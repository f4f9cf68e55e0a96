"""The same signals through `prepared=True` and through the default door give the same answer."""

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

import surae
from surae.recording import Channel, Recording
from surae.signals import ModelInputs, Preparation

#: Density of the torque's noise, as its standard deviation at 128 Hz [Nm].
NOISE = 0.3
#: What a value or a half-width may differ by, in half-widths of the default door.
APART = 0.1


@pytest.fixture(scope="module")
def slow() -> ModelInputs:
    """A virtual trial whose EMG are envelopes, slow enough for every rate."""
    return surae.prepare(surae.example(), Preparation(rate_hz=64.0, emg_lowpass_hz=6.0))


def at_rate(slow: ModelInputs, rate_hz: float) -> Recording:
    """The trial at a rate, its torque with white noise of the same density whatever the rate."""
    time = np.arange(slow.time[0], slow.time[-1], 1.0 / rate_hz)

    def upon(values: np.ndarray) -> np.ndarray:
        return make_interp_spline(slow.time, values, k=5)(time)

    noise = NOISE * np.sqrt(rate_hz / 128.0) * np.random.default_rng(7).standard_normal(len(time))
    columns = {"angle": (upon(slow.angle), "rad"), "torque": (upon(slow.torque) + noise, "Nm")}
    for i, muscle in enumerate(("ta", "gl", "sol", "gm")):
        columns[f"emg_{muscle}"] = (np.maximum(upon(slow.emg[:, i]), 0.0), "V")
    channels = {r: Channel(r, time, v, unit, "test") for r, (v, unit) in columns.items()}
    return Recording("trial", channels, emg="envelope")


@pytest.mark.slow
@pytest.mark.parametrize(
    "rate_hz",
    [
        64.0,
        pytest.param(
            128.0,
            marks=pytest.mark.xfail(
                strict=True,
                reason="a plate's weight comes in by one door alone: the evidence stands between",
            ),
        ),
        256.0,
        512.0,
        2048.0,
    ],
)
def test_both_doors_tell_the_same(slow, rate_hz) -> None:
    trial = at_rate(slow, rate_hz)
    prepared, default = (
        surae.fit(trial, prepared=way, quality=()).parameters for way in (True, False)
    )
    for name, there in default.items():
        if there.ci95 is None:
            continue
        here = prepared[name]
        half = np.ptp(there.ci95) / 2.0
        assert abs(here.value - there.value) <= APART * half, name
        assert abs(np.ptp(here.ci95) / 2.0 - half) <= APART * half, name


@pytest.mark.slow
def test_prediction_and_simulation_use_every_sample(slow) -> None:
    trial = at_rate(slow, 512.0)
    fit = surae.fit(trial, "muscle", prepared=True, quality=())
    n = len(trial.channels["angle"].time)
    assert fit.result.problem.inputs[0].n == n
    assert len(fit.predict(trial).torque) == n
    assert len(surae.simulate("muscle", fit.values, trial)) == n
