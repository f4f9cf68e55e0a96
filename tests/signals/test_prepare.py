from typing import Any

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from surae.base.errors import InputError
from surae.base.units import SI, FloatArray, kind
from surae.recording import Channel, Recording, SourceFile
from surae.signals import Preparation, check_estimable, prepare
from surae.signals.prepare import sharpened

W = 2 * np.pi * 0.7


def recording(
    signals: dict[str, tuple[FloatArray, FloatArray]], unit: str = "V", **kwargs: Any
) -> Recording:
    channels = {
        role: Channel(role, time, values, unit if kind(role) == "emg" else SI[kind(role)], "test")
        for role, (time, values) in signals.items()
    }
    return Recording("trial", channels, **kwargs)


def raw_emg(time: FloatArray, seed: int = 1) -> FloatArray:
    """Band-limited noise whose amplitude swells and fades, on an offset."""
    rate = 1.0 / (time[1] - time[0])
    noise = np.random.default_rng(seed).normal(size=len(time))
    band = sosfiltfilt(butter(2, [50.0, 300.0], "bandpass", fs=rate, output="sos"), noise)
    return 1e-3 + 1e-4 * (1.2 + np.sin(2 * np.pi * 0.3 * time)) * band / band.std() - 1e-3 * 0.9


def measured(rate: float = 2048.0, seconds: float = 10.0) -> dict[str, tuple[Any, Any]]:
    time = np.arange(int(rate * seconds)) / rate
    emg = {f"emg_{m}": (time, raw_emg(time, i)) for i, m in enumerate(("ta", "gl", "sol", "gm"))}
    return {
        "angle": (time, 0.4 * np.sin(W * time)),
        "torque": (time, 20.0 + 10.0 * np.cos(W * time)),
        **emg,
    }


def envelopes(rate: float = 256.0, seconds: float = 10.0) -> dict[str, tuple[Any, Any]]:
    time = np.arange(int(rate * seconds)) / rate
    envelope = (time, 1e-4 * (1.0 + np.sin(W * time) ** 2))
    return {
        "angle": (time, 0.4 * np.sin(W * time)),
        "torque": (time, 20.0 + 10.0 * np.cos(W * time)),
        **{f"emg_{muscle}": envelope for muscle in ("ta", "gl", "sol", "gm")},
    }


def test_raw_recording_at_2048_hz() -> None:
    inputs = prepare(recording(measured()))
    time = inputs.time
    assert inputs.rate_hz == 256.0
    np.testing.assert_array_equal(time, np.arange(2560) / 256.0)
    assert inputs.emg.shape == (2560, 4)
    assert inputs.torque is not None
    # The Bessel filter alone loses 0.04 % at 0.7 Hz; ends are reflected, so they are a bit worse.
    inside = slice(64, -64)
    np.testing.assert_allclose(inputs.angle[inside], 0.4 * np.sin(W * time)[inside], atol=3e-4)
    np.testing.assert_allclose(inputs.velocity[inside], 0.4 * W * np.cos(W * time)[inside], 0, 2e-3)
    np.testing.assert_allclose(
        inputs.acceleration[inside], -0.4 * W**2 * np.sin(W * time)[inside], atol=1e-2
    )
    np.testing.assert_allclose(inputs.torque[inside], 20 + 10 * np.cos(W * time)[inside], atol=1e-2)
    for array in (time, inputs.angle, inputs.velocity, inputs.acceleration, inputs.emg):
        assert not array.flags.writeable
    assert (inputs.emg_unit, inputs.missing_emg) == ("V", ())


def test_emg_chain_recovers_the_envelope_of_modulated_noise() -> None:
    inputs = prepare(recording(measured(seconds=60.0)), Preparation(emg_lowpass_hz=2.0))
    truth = 1.2 + np.sin(2 * np.pi * 0.3 * inputs.time)
    for muscle in range(4):
        assert np.corrcoef(inputs.emg[:, muscle], truth)[0, 1] > 0.98
    # Mean of a rectified normal variable: √(2/π)·σ; the high-pass removes little of 50–300 Hz.
    expected = np.sqrt(2 / np.pi) * 1e-4 * truth.mean()
    np.testing.assert_allclose(inputs.emg.mean(axis=0), expected, rtol=0.03)


def test_channels_of_different_rates_and_starts_share_one_axis() -> None:
    signals = measured()
    slow = 0.0123 + np.arange(900) / 100.0
    signals["angle"] = (slow, 0.4 * np.sin(W * slow))
    inputs = prepare(recording(signals))
    assert inputs.rate_hz == 100.0
    np.testing.assert_allclose(inputs.time, slow)
    assert inputs.torque is not None
    np.testing.assert_allclose(inputs.torque[20:-20], 20 + 10 * np.cos(W * slow)[20:-20], atol=1e-2)
    told = " ".join(inputs.steps)
    assert "slowest channel, angle, not 256 Hz" in told
    assert "uncertainty" in told


def test_envelopes_on_the_models_axis_pass_through() -> None:
    signals = envelopes()
    inputs = prepare(recording(signals, emg="envelope"), Preparation(bessel_hz=None))
    np.testing.assert_array_equal(inputs.angle, signals["angle"][1])
    np.testing.assert_array_equal(inputs.torque, signals["torque"][1])
    np.testing.assert_array_equal(inputs.emg[:, 3], signals["emg_gm"][1])
    assert "keep their time axis" in " ".join(inputs.steps)


def test_prepared_is_the_identity() -> None:
    signals = envelopes()
    inputs = prepare(recording(signals, unit="1"), prepared=True)
    assert inputs.emg_unit == "1"
    np.testing.assert_array_equal(inputs.time, signals["angle"][0])
    np.testing.assert_array_equal(inputs.angle, signals["angle"][1])
    np.testing.assert_array_equal(inputs.torque, signals["torque"][1])
    for column, role in enumerate(("emg_ta", "emg_gl", "emg_sol", "emg_gm")):
        np.testing.assert_array_equal(inputs.emg[:, column], signals[role][1])
    np.testing.assert_allclose(inputs.velocity, 0.4 * W * np.cos(W * inputs.time), atol=1e-7)


@pytest.mark.parametrize("prepared", [True, False])
def test_derivatives_are_used_as_they_are_when_given(prepared: bool) -> None:
    signals = envelopes()
    time = signals["angle"][0]
    given = recording(signals | {"angular_velocity": (time, 3.0 + time)}, emg="envelope")
    inputs = prepare(given, prepared=prepared)
    np.testing.assert_array_equal(inputs.velocity, 3.0 + time)
    np.testing.assert_allclose(
        inputs.acceleration[64:-64], -0.4 * W**2 * np.sin(W * time)[64:-64], atol=1e-2
    )
    assert "angular velocity is that given. Angular acceleration from" in " ".join(inputs.steps)

    both = recording(
        signals | {"angular_velocity": (time, time), "angular_acceleration": (time, 2 * time)},
        emg="envelope",
    )
    np.testing.assert_array_equal(prepare(both, prepared=prepared).acceleration, 2 * time)


def test_without_torque_and_with_missing_muscles() -> None:
    signals = {role: s for role, s in measured().items() if role in ("angle", "emg_ta")}
    inputs = prepare(recording(signals))
    assert inputs.torque is None
    assert inputs.missing_emg == ("gl", "sol", "gm")
    assert not inputs.emg[:, 1:].any()
    assert inputs.emg[:, 0].any()
    assert inputs.emg_unit == "V"


def test_name_fixed_parameters_and_files_are_carried_over() -> None:
    files = (SourceFile("trial.csv", "0" * 64),)
    inputs = prepare(recording(measured(), fixed={"m": 0.0}, files=files))
    assert (inputs.name, dict(inputs.fixed), inputs.files) == ("trial", {"m": 0.0}, files)


def test_recording_overrides_the_settings() -> None:
    inputs = prepare(
        recording(measured(), prepare={"rate_hz": 128, "bessel_hz": 10}), Preparation(rate_hz=64.0)
    )
    assert inputs.rate_hz == 128.0
    assert any("-3 dB at 10 Hz" in step for step in inputs.steps)
    with pytest.raises(InputError, match="'rate' is not known"):
        prepare(recording(measured(), prepare={"rate": 128}))


def test_steps_name_every_number() -> None:
    told = " ".join(prepare(recording(measured()), Preparation(emg_lowpass_hz=3.0)).steps)
    for part in ("2048 Hz", "order 3", "41 Hz", "rectified", "order 2", "3 Hz", "order 4", "20 Hz"):
        assert part in told
    for part in ("-3 dB at 102.4 Hz", "-60 dB from 153.6 Hz", "2560 instants", "15 samples"):
        assert part in told


def test_time_stamps_that_jitter_are_told() -> None:
    signals = measured()
    jitter = np.random.default_rng(2).uniform(-5e-5, 5e-5, len(signals["angle"][0]))
    signals["angle"] = (signals["angle"][0] + jitter, signals["angle"][1])
    assert any("angle: time stamps jitter" in step for step in prepare(recording(signals)).steps)
    rounded = {role: (np.round(t, 3), v) for role, (t, v) in envelopes().items()}
    inputs = prepare(recording(rounded, emg="envelope"))
    assert any("stamps are rounded" in step for step in inputs.steps)
    assert inputs.rate_hz == 256.0


def test_small_negatives_of_an_envelope_are_set_to_zero() -> None:
    signals = envelopes()
    time, values = signals["emg_ta"]
    values = values.copy()
    values[100] = -2e-6
    inputs = prepare(recording(signals | {"emg_ta": (time, values)}, emg="envelope"))
    assert inputs.emg[100, 0] == 0.0
    assert any("at most 1 % of the muscle's maximum" in step for step in inputs.steps)
    as_is = prepare(recording(signals | {"emg_ta": (time, values)}), prepared=True)
    assert as_is.emg[100, 0] == -2e-6


def test_flat_raw_emg_gives_an_empty_column() -> None:
    signals = measured()
    signals["emg_gl"] = (signals["emg_gl"][0], np.zeros(len(signals["emg_gl"][0])))
    assert not prepare(recording(signals)).emg[:, 1].any()


def refused(pattern: str, made: Recording, **kwargs: Any) -> None:
    with pytest.raises(InputError, match=pattern) as error:
        prepare(made, **kwargs)
    assert "\n" not in str(error.value)
    assert str(error.value).startswith("trial: ")


def test_no_angle() -> None:
    signals = measured()
    del signals["angle"]
    refused("there is no angle", recording(signals))


def test_raw_emg_that_is_an_envelope() -> None:
    refused(
        r"emg_ta is declared raw but (looks like an envelope|was rectified) \(.*"
        'emg = "envelope".*# emg: envelope.*--prepared',
        recording(envelopes(2048.0)),
    )


def test_envelope_that_is_raw_emg() -> None:
    pattern = r'emg_ta is declared an envelope but looks raw \(.*: write emg = "raw"'
    refused(pattern, recording(measured(), emg="envelope"))
    pattern = "emg_ta: an EMG envelope cannot be negative, but it is -.* at .* s"
    refused(pattern, recording(measured()), prepared=True)


def test_raw_emg_too_slow_for_the_high_pass() -> None:
    signals = measured(1000.0)
    time = np.arange(1481) / 148.1
    signals["emg_ta"] = (time, np.random.default_rng(4).normal(size=1481))
    refused("emg_ta: raw EMG at 148.1 Hz is too slow .* needs 164 Hz", recording(signals))


def test_gap_names_channel_and_time() -> None:
    signals = measured()
    time, values = signals["torque"]
    cut = np.r_[0:2048, 2148 : len(time)]
    signals["torque"] = (time[cut], values[cut])
    refused(r"torque: no samples from 0.999512 to 1.04883 s", recording(signals))


def test_files_of_different_trials() -> None:
    signals = measured()
    signals["torque"] = (signals["torque"][0] + 60.0, signals["torque"][1])
    refused("share no span of time", recording(signals))


def test_prepared_signals_need_one_uniform_axis() -> None:
    signals = envelopes()
    time, values = signals["torque"]
    for other in ((time + 1e-3, values), (time[:-1], values[:-1])):
        refused(
            "do not share one time axis .angle and torque differ.; .*leave out --prepared",
            recording(signals | {"torque": other}),
            prepared=True,
        )
    jittered = time + np.random.default_rng(6).uniform(-4e-4, 4e-4, len(time))
    refused(
        "not sampled uniformly .*leave out --prepared",
        recording({role: (jittered, v) for role, (_, v) in signals.items()}),
        prepared=True,
    )


def test_prepared_trial_too_short() -> None:
    short = {role: (t[:10], v[:10]) for role, (t, v) in envelopes().items()}
    refused("10 samples are too few", recording(short), prepared=True)


def test_moving_trial_is_estimable() -> None:
    check_estimable(prepare(recording(measured())))


@pytest.mark.parametrize("filtered", [True, False])
def test_angle_or_torque_that_never_changes(filtered: bool) -> None:
    time = np.arange(1024) / 256.0
    settings = Preparation() if filtered else Preparation(bessel_hz=None)
    still, moving = (time, np.full(1024, 0.3)), (time, np.sin(time))
    zero = (time, np.zeros(1024))
    for angle, torque, pattern in (
        (still, moving, "the angle never changes .0.3 rad.: nothing can be estimated"),
        (moving, zero, "the torque never changes .0 Nm.: nothing can be estimated"),
    ):
        inputs = prepare(recording({"angle": angle, "torque": torque}), settings)
        with pytest.raises(InputError, match=pattern):
            check_estimable(inputs)


def test_trial_without_torque_is_not_estimable() -> None:
    time = np.arange(256) / 256.0
    inputs = prepare(recording({"angle": (time, np.sin(time))}), prepared=True)
    with pytest.raises(InputError, match="there is no torque, so nothing can be estimated"):
        check_estimable(inputs)


def test_what_the_low_pass_took_from_a_fast_movement_is_given_back() -> None:
    time = np.arange(0.0, 10.0, 1.0 / 256.0)
    angle, torque = 0.3 * np.sin(2 * np.pi * 5.0 * time), 20.0 * np.cos(2 * np.pi * 5.0 * time)
    emg = {f"emg_{m}": (time, 1e-4 * (1.0 + np.sin(time))) for m in ("ta", "gl", "sol", "gm")}
    trial = recording({"angle": (time, angle), "torque": (time, torque), **emg}, emg="envelope")
    filtered = prepare(trial)
    assert filtered.lowpass == (20.0, 4)
    back, inside = sharpened(filtered), slice(256, -256)
    assert filtered.torque is not None
    assert back.torque is not None
    lost = 1.0 - filtered.torque[inside].std() / torque[inside].std()
    assert lost > 0.015
    # what is lost twice is left: 1 − (1 − H)²
    left = 1.0 - back.torque[inside].std() / torque[inside].std()
    assert left == pytest.approx(lost**2, rel=0.1)
    assert np.abs(back.angle - angle)[inside].max() < 0.01 * 0.3
    fast = 2 * np.pi * 5.0 * 0.3 * np.cos(2 * np.pi * 5.0 * time)
    assert np.abs(back.velocity - fast)[inside].max() < 0.01 * np.abs(fast).max()
    assert np.array_equal(back.emg, filtered.emg)


def test_noise_is_not_made_greater_by_giving_back() -> None:
    time = np.arange(0.0, 20.0, 1.0 / 256.0)
    noise = np.random.default_rng(3).normal(size=len(time))
    signals = {"angle": (time, np.sin(time)), "torque": (time, noise)}
    back = sharpened(prepare(recording(signals)))
    assert back.torque is not None
    assert back.torque.std() < noise.std()


def test_what_went_through_no_filter_is_not_sharpened() -> None:
    time = np.arange(0.0, 10.0, 1.0 / 128.0)
    trial = recording({"angle": (time, np.sin(W * time)), "torque": (time, np.cos(W * time))})
    for inputs in (prepare(trial, prepared=True), prepare(trial, Preparation(bessel_hz=None))):
        assert inputs.lowpass is None
        assert sharpened(inputs) is inputs


def test_a_measured_derivative_is_not_given_back_what_no_filter_took() -> None:
    signals = envelopes()
    time, fast = signals["angle"][0], 0.1 * np.sin(2 * np.pi * 12.0 * signals["angle"][0])
    signals["angle"] = (time, fast)
    given = (time, 0.1 * 2 * np.pi * 12.0 * np.cos(2 * np.pi * 12.0 * time))
    inputs = prepare(recording({**signals, "angular_velocity": given}, emg="envelope"))
    assert inputs.measured == ("velocity",)
    again, inside = sharpened(inputs), slice(100, -100)
    assert again.velocity == pytest.approx(inputs.velocity, abs=0.0)
    truth = np.sin(2 * np.pi * 12.0 * inputs.time)[inside]
    assert np.abs(again.acceleration[inside]).max() > np.abs(inputs.acceleration[inside]).max()
    # and the angle itself comes nearer to what it was before the filter
    filtered, sharp = (0.1 * truth - one.angle[inside] for one in (inputs, again))
    assert np.std(sharp) < 0.5 * np.std(filtered)
