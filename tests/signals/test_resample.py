import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.recording import Channel
from surae.signals.resample import resample, uniform
from surae.signals.timebase import Axis, common_axis, timing


def channel(time: FloatArray, values: FloatArray | None = None) -> Channel:
    return Channel("angle", time, np.sin(time) if values is None else values, "rad", "test")


def stamps(rate: float, n: int = 1000, start: float = 0.0) -> FloatArray:
    return start + np.arange(n) / rate


def tone(time: FloatArray, frequency: float) -> FloatArray:
    return np.cos(2 * np.pi * frequency * time + 0.3)


@settings(max_examples=50)
@given(
    rate=st.sampled_from([100.0, 125.0, 148.148, 256.0, 300.0, 1000.0, 1259.259, 2048.0]),
    start=st.floats(-5.0, 100.0),
)
def test_uniform_stamps_are_found_uniform(rate: float, start: float) -> None:
    timed = timing(channel(stamps(rate, start=start)), "trial")
    assert timed.uniform
    assert (timed.axis.start, timed.axis.n) == (start, 1000)
    np.testing.assert_allclose(timed.axis.time * rate, stamps(rate, start=start) * rate, atol=2e-3)


@settings(max_examples=50)
@given(rate=st.floats(20.0, 500.0), start=st.floats(0.0, 10.0))
def test_stamps_rounded_to_milliseconds_stand_for_uniform_samples(
    rate: float, start: float
) -> None:
    exact = stamps(rate, start=start)
    signal = uniform(channel(np.round(exact, 3), tone(exact, 2.0)), "trial")
    np.testing.assert_array_equal(signal.values, tone(exact, 2.0))
    np.testing.assert_allclose(signal.axis.time, exact, atol=7e-4)


@pytest.mark.parametrize("rate", [256.0, 300.0, 441.0])
def test_rounded_stamps_keep_a_whole_rate(rate: float) -> None:
    assert timing(channel(np.round(stamps(rate), 3)), "trial").axis.rate_hz == rate


def test_jittered_samples_are_interpolated_where_they_were_taken() -> None:
    rng = np.random.default_rng(3)
    time = stamps(1000.0, 4000) + rng.uniform(-1e-4, 1e-4, 4000)
    signal = uniform(channel(time, tone(time, 5.0)), "trial")
    assert not signal.timing.uniform
    assert 0.9e-4 < signal.timing.jitter_s < 2e-4
    expected = tone(signal.axis.time, 5.0)
    np.testing.assert_allclose(signal.values, expected, atol=1e-7)
    assert np.abs(channel(time, tone(time, 5.0)).values - expected).max() > 1e-3


@pytest.mark.parametrize(("rate", "decimals"), [(100.0, 2), (256.0, 3), (256.0, 9), (2048.0, 9)])
def test_gap_is_refused_with_its_time(rate: float, decimals: int) -> None:
    for missing in (1, 2, 500, 997, 998):
        time = np.delete(np.round(stamps(rate), decimals), missing)
        with pytest.raises(InputError, match=r"trial: angle: no samples from ") as error:
            timing(channel(time), "trial")
        assert f"from {time[missing - 1]:.6g} to {time[missing]:.6g} s" in str(error.value)


def test_channel_that_is_not_a_signal() -> None:
    with pytest.raises(InputError, match="trial: angle, sample 2: nan is not a finite number"):
        timing(channel(np.array([0.0, 0.1, 0.2]), np.array([1.0, np.nan, 3.0])), "trial")


def test_instants_that_coincide_with_samples_take_them_unchanged() -> None:
    values = np.random.default_rng(5).normal(size=1000)
    signal = uniform(channel(stamps(100.0, start=0.37), values), "trial")
    np.testing.assert_array_equal(resample(signal, signal.axis), values)
    np.testing.assert_array_equal(resample(signal, Axis(0.57, 100.0, 900)), values[20:920])


@settings(max_examples=25)
@given(
    rate=st.sampled_from([512.0, 1000.0, 1259.0, 2000.0, 2048.0]),
    start=st.floats(0.0, 0.05),
    frequency=st.floats(0.5, 51.2),
)
def test_band_is_kept_from_faster_sources(rate: float, start: float, frequency: float) -> None:
    time = stamps(rate, int(4 * rate), start)
    target = Axis(0.1, 256.0, 900)
    resampled = resample(uniform(channel(time, tone(time, frequency)), "trial"), target)
    inside = slice(50, -50)
    np.testing.assert_allclose(resampled[inside], tone(target.time, frequency)[inside], atol=5e-6)


def test_same_rate_half_a_step_apart() -> None:
    time = stamps(100.0)
    target = Axis(0.005, 100.0, 990)
    for frequency, error in ((5.0, 1e-7), (10.0, 1e-5), (20.0, 6e-4)):
        resampled = resample(uniform(channel(time, tone(time, frequency)), "trial"), target)
        np.testing.assert_allclose(
            resampled[20:-20], tone(target.time, frequency)[20:-20], atol=error
        )


@pytest.mark.parametrize("frequency", [160.0, 250.0, 500.0, 900.0])
def test_tone_that_would_fold_into_the_band_is_60_db_down(frequency: float) -> None:
    time = stamps(2048.0, 16384)
    signal = uniform(channel(time, tone(time, frequency)), "trial")
    resampled = resample(signal, Axis(0.0, 256.0, 2048))
    assert np.abs(resampled[100:-100]).max() < 1e-3


def test_common_axis_is_the_slowest_channels_own() -> None:
    fast, slow = Axis(0.0, 2048.0, 20480), Axis(0.123, 100.0, 950)
    assert common_axis([fast, slow], 256.0, "trial", 15) == slow


def test_common_axis_at_the_rate_asked_for_from_the_common_start() -> None:
    axis = common_axis([Axis(0.25, 2048.0, 8192), Axis(0.0, 1000.0, 4001)], 256.0, "trial", 15)
    assert (axis.start, axis.rate_hz) == (0.25, 256.0)
    assert axis.end <= 4.0 < axis.end + 1 / 256.0


@settings(max_examples=100)
@given(
    rates=st.lists(st.floats(50.0, 3000.0), min_size=1, max_size=4),
    starts=st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4),
    wanted=st.floats(50.0, 500.0),
)
def test_common_axis_never_extrapolates_nor_adds_samples(
    rates: list[float], starts: list[float], wanted: float
) -> None:
    axes = [Axis(s, r, int(10 * r)) for r, s in zip(rates, starts, strict=False)]
    axis = common_axis(axes, wanted, "trial", 15)
    assert axis.rate_hz <= min(*rates, wanted) * (1 + 1e-6)
    for source in axes:
        assert axis.start >= source.start - 1e-6 / axis.rate_hz
        assert axis.end <= source.end + 2e-6 / axis.rate_hz


def test_no_common_span() -> None:
    with pytest.raises(InputError, match="trial: the channels share no span of time"):
        common_axis([Axis(0.0, 100.0, 100), Axis(1.0, 100.0, 100)], 256.0, "trial", 15)


def test_common_span_too_short() -> None:
    with pytest.raises(InputError, match=r"share only 10 samples at 100 Hz .* at least 15"):
        common_axis([Axis(0.0, 100.0, 100), Axis(0.9, 100.0, 100)], 256.0, "trial", 15)
