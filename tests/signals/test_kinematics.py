import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surae.base.errors import InputError
from surae.signals.resample import derivatives


def errors(rate: float, frequency: float) -> tuple[np.ndarray, np.ndarray]:
    """Relative error of velocity and acceleration at each sample of a complex exponential."""
    w = 2 * np.pi * frequency
    time = np.arange(200) / rate
    velocity_re, acceleration_re = derivatives(np.cos(w * time), rate)
    velocity_im, acceleration_im = derivatives(np.sin(w * time), rate)
    turn = np.exp(1j * w * time)
    return (
        abs((velocity_re + 1j * velocity_im) / (1j * w * turn) - 1),
        abs((acceleration_re + 1j * acceleration_im) / (-(w**2) * turn) - 1),
    )


@pytest.mark.parametrize(
    ("rate", "frequency", "velocity", "acceleration"),
    [
        (256, 5, 1e-11, 1e-11),
        (256, 10, 1e-11, 1e-11),
        (256, 20, 8.2e-10, 1.1e-10),
        (128, 5, 1e-11, 1e-11),
        (128, 10, 8.2e-10, 1.1e-10),
        (128, 20, 9.2e-6, 1.3e-6),
        (100, 5, 1e-11, 1e-11),
        (100, 10, 2.4e-8, 3.1e-9),
        (100, 20, 2.2e-4, 2.9e-5),
    ],
)
def test_error_inside_the_record_is_as_documented(
    rate: float, frequency: float, velocity: float, acceleration: float
) -> None:
    of_velocity, of_acceleration = errors(rate, frequency)
    assert of_velocity[7:-7].max() < velocity
    assert of_acceleration[7:-7].max() < acceleration


@pytest.mark.parametrize(
    ("rate", "frequency", "velocity", "acceleration"),
    [
        (256, 5, 5e-7, 2e-5),
        (256, 10, 3.1e-5, 6.2e-4),
        (256, 20, 2e-3, 2e-2),
        (100, 5, 1.4e-4, 2.1e-3),
    ],
)
def test_error_at_the_ends_is_as_documented(
    rate: float, frequency: float, velocity: float, acceleration: float
) -> None:
    of_velocity, of_acceleration = errors(rate, frequency)
    ends = np.r_[0:7, -7:0]
    assert of_velocity[ends].max() < velocity
    assert of_acceleration[ends].max() < acceleration


@settings(max_examples=50)
@given(coefficients=st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=7), n=st.integers(15, 60))
def test_polynomials_of_degree_6_are_exact_everywhere(coefficients: list[float], n: int) -> None:
    polynomial = np.polynomial.Polynomial(coefficients, domain=[0.0, (n - 1) / 100.0])
    time = np.arange(n) / 100.0
    velocity, acceleration = derivatives(polynomial(time), 100.0)
    np.testing.assert_allclose(velocity, polynomial.deriv(1)(time), atol=1e-9)
    np.testing.assert_allclose(acceleration, polynomial.deriv(2)(time), atol=1e-6)


def test_rounding_of_the_angle_to_8_decimals_stays_small() -> None:
    w = 2 * np.pi * 1.3
    time = np.arange(8192) / 256.0
    rounded = np.round(0.5 * np.sin(w * time), 8)
    velocity, acceleration = derivatives(rounded, 256.0)
    np.testing.assert_allclose(velocity, 0.5 * w * np.cos(w * time), atol=2e-5)
    noise = acceleration + 0.5 * w**2 * np.sin(w * time)
    assert noise[7:-7].std() == pytest.approx(7.5e-4, rel=0.1)
    assert abs(noise).max() < 0.05


def test_constant_offset_costs_no_digits() -> None:
    wiggle = 1e-6 * np.sin(np.arange(400) / 20.0)
    for offset, of_plain in zip(
        derivatives(wiggle + 1000.0, 256.0), derivatives(wiggle, 256.0), strict=True
    ):
        np.testing.assert_allclose(offset[7:-7], of_plain[7:-7], atol=1e-7)
    for derivative in derivatives(np.full(100, 0.7), 256.0):
        assert not derivative.any()


def test_too_few_samples() -> None:
    with pytest.raises(InputError, match=r"trial: 14 samples are too few .* at least 15"):
        derivatives(np.zeros(14), 256.0, where="trial")
