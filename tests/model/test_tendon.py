"""Tendon force against elongation: the printed equations, its joint, its derivatives."""

import numpy as np
import pytest

from surae.model.tendon import tendon_curve, tendon_force, tendon_partials, tendon_shape

CURVES = {
    "triceps": (0.04, 0.3, 4.0, 8000.0),
    "tibialis": (0.04, 0.3, 4.0, 1400.0),
    "stiff, long toe": (0.005, 0.8, 8.0, 5000.0),
    "slack, blunt toe": (0.2, 0.08, 1.2, 2000.0),
}
every_curve = pytest.mark.parametrize("name", CURVES)


def printed(e: np.ndarray, eps0: float, toe: float, k: float, f_max: float) -> np.ndarray:
    """Equations (18) to (21) as the thesis prints them."""
    f_toe = toe * f_max
    e_toe = eps0 * toe * k * np.exp(k) / (np.exp(k) * (1 - toe + toe * k) + toe - 1)
    k_lin = f_max / eps0 * (1 - toe + toe * k * np.exp(k) / (np.exp(k) - 1))
    bent = f_toe / (np.exp(k) - 1) * (np.exp(k * np.minimum(e, e_toe) / e_toe) - 1)
    return np.where(e <= 0, 0.0, np.where(e <= e_toe, bent, k_lin * (e - e_toe) + f_toe))


def force(e: float, parameters: tuple[float, ...]) -> float:
    return tendon_force(e, tendon_curve(*parameters))[0]


@every_curve
def test_force_is_the_printed_one(name) -> None:
    q = CURVES[name]
    e = np.linspace(-0.5, 1.5, 401) * q[0]
    ours = [force(state, q) for state in e]
    assert ours == pytest.approx(printed(e, *q), rel=1e-12, abs=1e-10)


@every_curve
def test_points_of_the_curve(name) -> None:
    eps0, toe, _, f_max = q = CURVES[name]
    e_toe = tendon_curve(*q)[0]
    assert 0 < e_toe < eps0
    assert force(-1e-9, q) == force(0.0, q) == 0.0
    assert force(e_toe, q) == pytest.approx(toe * f_max, rel=1e-13)
    assert force(eps0, q) == pytest.approx(f_max, rel=1e-13)


@every_curve
def test_toe_and_line_join_with_one_slope(name) -> None:
    curve = tendon_curve(*CURVES[name])
    below = tendon_force(curve[0], curve)
    above = tendon_force(np.nextafter(curve[0], 1.0), curve)
    assert above == pytest.approx(below, rel=1e-12)
    e = np.linspace(0, 1.5 * CURVES[name][0], 200)
    slopes = [tendon_force(state, curve)[1] for state in e]
    assert np.all(np.diff(slopes) >= -1e-9 * slopes[-1])  # it only ever stiffens
    assert slopes[0] > 0  # taut from the first elongation on


@every_curve
@pytest.mark.parametrize("part", [0.1, 0.99, 1.01, 3.0])
def test_derivatives_against_richardson(name, part) -> None:
    q = CURVES[name]
    curve = tendon_curve(*q)
    e = part * curve[0]
    value, slope = tendon_force(e, curve)
    exact = [slope, *tendon_partials(e, value, slope, curve, tendon_shape(*q))]
    point = (e, *q)
    for j, derivative in enumerate(exact):

        def central(h: float, j: int = j) -> float:
            up, down = list(point), list(point)
            up[j] += h
            down[j] -= h
            return (force(up[0], tuple(up[1:])) - force(down[0], tuple(down[1:]))) / (2 * h)

        h = 1e-3 * point[j]
        numeric = (4 * central(h) - central(2 * h)) / 3
        assert derivative == pytest.approx(numeric, rel=1e-8, abs=1e-9 * value / point[j]), j


def test_a_slack_tendon_has_no_force_and_no_derivative() -> None:
    q = CURVES["triceps"]
    curve = tendon_curve(*q)
    assert tendon_force(-0.001, curve) == (0.0, 0.0)
    assert tendon_partials(-0.001, 0.0, 0.0, curve, tendon_shape(*q)) == (0.0, 0.0, 0.0, 0.0)
