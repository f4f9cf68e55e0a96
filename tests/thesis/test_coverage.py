"""Coverage of the length–velocity plane."""

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.protocol import Protocol, generate
from surae_thesis.coverage import L0_TRI, coverage, triceps_path


def test_a_muscle_at_rest_visits_one_cell():
    covered = coverage(np.full(100, 0.72), np.full(100, 0.15))
    assert covered.share == pytest.approx(1 / (18 * 100))
    assert covered.time_share.shape == (100, 18)
    assert covered.time_share[51, 8] == 1.0
    assert covered.outside == 0.0


def test_every_cell_visited():
    length, velocity = np.meshgrid(np.linspace(0.31, 1.19, 60), np.linspace(-4.99, 4.99, 400))
    length[1::2] = length[1::2, ::-1]
    covered = coverage(length.ravel(), velocity.ravel())
    assert covered.share == 1.0
    assert covered.time_share.sum() == pytest.approx(1.0)


def test_hardly_depends_on_the_sampling_rate():
    shares = []
    for rate in (125.0, 1000.0):
        t = np.arange(0.0, 30.0, 1 / rate)
        phase = 2 * np.pi * (0.1 * t + 0.05 * t**2)
        speed = 2 * np.pi * (0.1 + 0.1 * t)
        shares.append(coverage(0.75 + 0.2 * np.sin(phase), 0.2 * speed * np.cos(phase)).share)
    assert shares[0] == pytest.approx(shares[1], rel=0.02)


def test_time_outside_the_grid_is_told():
    covered = coverage(np.linspace(0.75, 1.65, 1001), np.zeros(1001))
    assert covered.outside == pytest.approx(0.5, abs=0.01)


def test_richer_motion_covers_more():
    t = np.linspace(0.0, 30.0, 4000)
    slow = coverage(0.75 + 0.3 * np.sin(t), 0.3 * np.cos(t))
    rich_length = 0.75 + 0.2 * np.sin(t) + 0.05 * np.sin(3 * t**1.5)
    rich = coverage(rich_length, np.gradient(rich_length, t))
    assert rich.share > 2 * slow.share


def test_wrong_arrays_are_refused():
    with pytest.raises(InputError, match="equally long"):
        coverage(np.zeros(3), np.zeros(4))
    with pytest.raises(InputError, match="must be finite"):
        coverage(np.array([1.0, np.nan]), np.zeros(2))


def test_the_path_of_the_triceps_is_that_of_equation_9() -> None:
    trajectory = generate(Protocol(profile="multiple-holds", rate_hz=64.0))
    path = triceps_path(trajectory, l0=0.05)
    arm = 0.0480 - 0.0104 * trajectory.angle
    np.testing.assert_allclose(path.length, (0.118 - 1.67 * arm) / 0.05, rtol=1e-12)
    expected = 1.67 * 0.0104 * trajectory.velocity / 0.05
    np.testing.assert_allclose(path.velocity, expected, atol=1e-12)
    assert not path.length.flags.writeable
    assert 0.0 < path.coverage.share < 1.0


def test_the_ramp_and_hold_reaches_the_speed_of_figure_3() -> None:
    path = triceps_path(generate(Protocol(profile="ramp-and-hold")))
    assert path.l0 == L0_TRI
    assert np.abs(path.velocity).max() == pytest.approx(0.35, abs=0.005)
