"""The figure of a protocol: all its panels, readable without colours."""

import numpy as np
import pytest

from surae.protocol import Protocol, generate, named_device
from surae.protocol.coverage import L0_TRI, triceps_path
from surae.report.figures.protocol import protocol_figure


@pytest.fixture(scope="module")
def trajectory():
    return generate(
        Protocol(
            profile="multiple-holds",
            chirp_amplitude=0.1,
            rate_hz=64.0,
            device=named_device("achilles"),
        )
    )


def test_panels_with_units(trajectory) -> None:
    effort, angle, velocity, *strips, whole, close = protocol_figure(trajectory).axes
    assert angle.get_ylabel() == "Angle [rad]"
    assert velocity.get_ylabel() == "Velocity\n[rad/s]"
    assert [t.get_text() for a in (*strips, effort) for t in a.texts] == ["TA", "GL", "SOL", "GM"]
    assert effort.get_xlabel() == "Time [s]"
    for axes in (whole, close):
        assert axes.get_ylabel() == "Velocity [l0/s]"
        assert axes.get_xlabel() == "Muscle length [L/l0]"
    for axes in (angle, velocity, *strips):
        assert axes.get_shared_x_axes().joined(axes, effort)
    limits = [line for line in velocity.get_lines() if line.get_label() == "limit of achilles"]
    assert limits[0].get_ydata() == [1.5, 1.5]


def test_the_plane_has_the_axes_of_the_thesis_or_wider_ones(trajectory) -> None:
    whole = protocol_figure(trajectory).axes[-2]
    assert whole.get_xlim() == pytest.approx((0.3, 1.2))
    assert whole.get_ylim() == pytest.approx((-5.0, 5.0))
    fast = generate(Protocol(profile="sine", chirp_amplitude=0.2, chirp_rate=0.5))
    low, high = protocol_figure(fast).axes[-2].get_ylim()
    assert low < triceps_path(fast).velocity.min() < -5.0
    assert high > triceps_path(fast).velocity.max() > 5.0


def test_relaxed_and_active_differ_without_colour(trajectory) -> None:
    close = protocol_figure(trajectory).axes[-1]
    texts = [text.get_text() for text in close.get_legend().get_texts()]
    assert texts == ["triceps relaxed", "active"]
    points = [line for line in close.get_lines() if len(line.get_xdata()) > 2]
    assert points[0].get_markersize() >= 2 * points[1].get_markersize()
    assert sum(len(line.get_xdata()) for line in points) == len(trajectory.time)
    passive = generate(Protocol(profile="sine", task="passive", rate_hz=64.0))
    legend = protocol_figure(passive).axes[-1].get_legend()
    assert [text.get_text() for text in legend.get_texts()] == ["triceps relaxed"]


def test_the_path_of_the_triceps_is_that_of_equation_9(trajectory) -> None:
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
