from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.signals.filters import antialias, zero_phase

Filter = Callable[[FloatArray], FloatArray]


def gain_db(apply: Filter, rate: float, frequency: float, seconds: float = 16.0) -> float:
    """Gain of a filter at one frequency: Fourier transform of its response to an impulse."""
    n = int(rate * seconds) | 1
    impulse = np.zeros(n)
    impulse[n // 2] = 1.0
    turn = np.exp(-2j * np.pi * frequency / rate * (np.arange(n) - n // 2))
    return float(20 * np.log10(abs(np.sum(apply(impulse) * turn))))


HALF_POWER_DB = 10 * np.log10(0.5)


@settings(max_examples=30)
@given(
    rate=st.sampled_from([100.0, 148.148, 1000.0, 2048.0]),
    fraction=st.floats(0.005, 0.4),
    order=st.integers(1, 6),
    kind=st.sampled_from(["lowpass", "highpass", "bessel"]),
)
def test_both_passes_together_lose_3_db_at_the_cutoff(
    rate: float, fraction: float, order: int, kind: str
) -> None:
    cutoff = fraction * rate

    def apply(x: FloatArray) -> FloatArray:
        return zero_phase(kind, x, rate, cutoff, order)  # type: ignore[arg-type]

    assert gain_db(apply, rate, cutoff, seconds=40.0 / cutoff) == pytest.approx(
        HALF_POWER_DB, abs=0.01
    )


def test_slope_is_that_of_twice_the_order() -> None:
    def highpass(x: FloatArray) -> FloatArray:
        return zero_phase("highpass", x, 2048.0, 41.0, 3)

    # 6 poles: 36 dB per octave far below the cut-off.
    slope = gain_db(highpass, 2048.0, 4.0) - gain_db(highpass, 2048.0, 2.0)
    assert slope == pytest.approx(36.1, abs=0.1)
    assert gain_db(highpass, 2048.0, 400.0) == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("rate", [100.0, 256.0, 2048.0])
def test_a_sine_is_not_delayed(rate: float) -> None:
    time = np.arange(int(8 * rate)) / rate
    sine = np.sin(2 * np.pi * 5.0 * time)
    filtered = zero_phase("bessel", sine, rate, 20.0, 4)
    inside = slice(int(rate), -int(rate))
    quadrature = filtered[inside] @ np.cos(2 * np.pi * 5.0 * time)[inside]
    in_phase = filtered[inside] @ sine[inside]
    assert abs(np.arctan2(quadrature, in_phase)) < 1e-6
    assert 0.95 < in_phase / (sine[inside] @ sine[inside]) < 1.0


def test_bessel_does_not_overshoot_a_step() -> None:
    step = np.repeat([0.0, 1.0], 2048)
    filtered = zero_phase("bessel", step, 2048.0, 20.0, 4)
    assert filtered.max() < 1.005
    assert filtered.min() > -0.005


def test_straight_line_passes_unchanged_to_its_ends() -> None:
    line = np.linspace(-0.4, 0.3, 4096)
    np.testing.assert_allclose(zero_phase("bessel", line, 2048.0, 20.0, 4), line, atol=1e-5)
    np.testing.assert_allclose(antialias(line, 2048.0, 256.0), line, atol=1e-5)


@pytest.mark.parametrize(("rate", "target"), [(2048.0, 256.0), (1000.0, 256.0), (1259.0, 148.0)])
def test_antialiasing(rate: float, target: float) -> None:
    def apply(x: FloatArray) -> FloatArray:
        return antialias(x, rate, target)

    assert abs(gain_db(apply, rate, 0.2 * target)) < 1e-5
    assert gain_db(apply, rate, 0.4 * target) == pytest.approx(HALF_POWER_DB, abs=0.01)
    for fraction in (0.6, 0.8, 1.0, 1.5):
        assert gain_db(apply, rate, fraction * target) < -60.0


def test_cutoff_too_high_for_the_rate() -> None:
    with pytest.raises(InputError, match=r"trial: angle: a filter at 20 Hz needs .* above 44"):
        zero_phase("bessel", np.zeros(1000), 40.0, 20.0, 4, where="trial: angle")


def test_signal_shorter_than_the_filter_remembers() -> None:
    with pytest.raises(InputError, match=r"trial: torque: 40 samples .* record at least 0\.\d+ s"):
        zero_phase("bessel", np.zeros(40), 2048.0, 20.0, 4, where="trial: torque")
