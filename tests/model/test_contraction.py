"""Force-length (16) and force-velocity (17)."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surae.model import contraction
from surae.model.contraction import length_velocity_factor

optimal = st.floats(0.015, 0.25)


def force_length(*of: float) -> float:
    return contraction.force_length(*of)[0]


def force_velocity(*of: float) -> float:
    return contraction.force_velocity(*of)[0]


def test_force_length_by_hand() -> None:
    # (0.05 − 0.04)²/(0.1·0.04²) = 0.625
    assert force_length(0.05, 0.04) == pytest.approx(math.exp(-0.625), rel=1e-12)


@given(l0=optimal, off=st.floats(1e-4, 0.1))
def test_force_length_is_greatest_at_and_symmetric_about_the_optimum(l0, off) -> None:
    assert force_length(l0, l0) == 1.0
    assert force_length(l0 + off, l0) < 1.0
    assert force_length(l0 + off, l0) == pytest.approx(force_length(l0 - off, l0), rel=1e-9)


@given(l0=optimal, ratio=st.floats(0.2, 2.0))
def test_force_length_partials(l0, ratio) -> None:
    x = ratio * l0
    _, by_x, by_l0, _ = contraction.force_length(x, l0)
    h = 1e-6 * l0
    numeric_x = (force_length(x + h, l0) - force_length(x - h, l0)) / (2 * h)
    numeric_l0 = (force_length(x, l0 + h) - force_length(x, l0 - h)) / (2 * h)
    assert by_x == pytest.approx(numeric_x, rel=1e-7, abs=1e-8 / l0)
    assert by_l0 == pytest.approx(numeric_l0, rel=1e-7, abs=1e-8 / l0)


@pytest.mark.parametrize("vmax", [0.1, 0.36, 2.0])
def test_force_velocity_at_its_marks(vmax) -> None:
    assert force_velocity(-vmax, vmax) == 0.0
    assert force_velocity(0.0, vmax) == 1.0
    assert force_velocity(vmax, vmax) == pytest.approx(1.5, rel=1e-14)
    # by hand at half the maximum: ½/(1 + 2) and 1 + 1.125·0.5·0.5/0.625
    assert force_velocity(-vmax / 2, vmax) == pytest.approx(1 / 6, rel=1e-14)
    assert force_velocity(vmax / 2, vmax) == pytest.approx(1.45, rel=1e-14)


@pytest.mark.parametrize("vmax", [0.1, 0.36, 2.0])
def test_force_velocity_is_continuous_with_its_two_slopes_at_rest(vmax) -> None:
    h = 1e-7 * vmax
    assert force_velocity(-1e-300, vmax) == 1.0
    shortening = (1.0 - force_velocity(-h, vmax)) / h
    lengthening = (force_velocity(h, vmax) - 1.0) / h
    assert shortening == pytest.approx(5.0 / vmax, rel=1e-5)
    assert lengthening == pytest.approx(4.5 / vmax, rel=1e-5)
    assert contraction.force_velocity(-1e-300, vmax)[1] == pytest.approx(5.0 / vmax, rel=1e-14)
    assert contraction.force_velocity(0.0, vmax)[1] == pytest.approx(4.5 / vmax, rel=1e-14)


@given(vmax=st.floats(0.1, 2.0), ratio=st.floats(-1.5, 3.0).filter(lambda r: abs(r) > 1e-4))
def test_force_velocity_partials(vmax, ratio) -> None:
    speed = ratio * vmax
    by_speed = contraction.force_velocity(speed, vmax)[1]
    by_vmax = -speed / vmax * by_speed
    h = 1e-5 * vmax
    numeric_speed = (force_velocity(speed + h, vmax) - force_velocity(speed - h, vmax)) / (2 * h)
    numeric_vmax = (force_velocity(speed, vmax + h) - force_velocity(speed, vmax - h)) / (2 * h)
    assert by_speed == pytest.approx(numeric_speed, rel=1e-6, abs=1e-9 / vmax)
    assert by_vmax == pytest.approx(numeric_vmax, rel=1e-6, abs=1e-9 / vmax)


def test_contraction_is_the_product_of_both_factors_with_its_slopes() -> None:
    l0, factor, h = 0.04, 8.0, 1e-7
    x, v = np.array([0.03, 0.04, 0.05]), np.array([-0.1, 0.05, 0.2])
    both, by_x, by_v = length_velocity_factor(x, v, l0, factor)
    expected = [
        force_length(a, l0) * force_velocity(b, factor * l0) for a, b in zip(x, v, strict=True)
    ]
    np.testing.assert_allclose(both, expected, rtol=1e-14)
    longer, shorter = (
        length_velocity_factor(x + h, v, l0, factor)[0],
        length_velocity_factor(x - h, v, l0, factor)[0],
    )
    np.testing.assert_allclose(by_x, (longer - shorter) / (2 * h), rtol=1e-6, atol=1e-6)
    faster = length_velocity_factor(x, v + h, l0, factor)[0]
    slower = length_velocity_factor(x, v - h, l0, factor)[0]
    np.testing.assert_allclose(by_v, (faster - slower) / (2 * h), rtol=1e-6)
