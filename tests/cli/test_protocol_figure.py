"""The figure of a protocol: all its panels, readable without colours."""

import numpy as np
import pytest

from surae.protocol import Protocol, generate, named_device
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
    effort, angle, velocity, *strips = protocol_figure(trajectory).axes
    assert angle.get_ylabel() == "Angle [°]"
    assert velocity.get_ylabel() == "Velocity\n[°/s]"
    assert [t.get_text() for a in (*strips, effort) for t in a.texts] == ["TA", "GL", "SOL", "GM"]
    assert effort.get_xlabel() == "Time [s]"
    for axes in (angle, velocity, *strips):
        assert axes.get_shared_x_axes().joined(axes, effort)
    limits = [line for line in velocity.get_lines() if line.get_label() == "limit of achilles"]
    assert limits[0].get_ydata() == pytest.approx(np.degrees([1.5, 1.5]))
