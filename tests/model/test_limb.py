"""Inertia (6) and gravity (7)."""

import numpy as np
import pytest

from surae.model.movement import gravity_torque, inertia_torque


def test_inertia_by_hand() -> None:
    assert inertia_torque(acceleration=np.array([0.0, 2.0, -4.0])) == pytest.approx(
        [0.0, 0.045, -0.09]
    )


def test_gravity_by_hand() -> None:
    # 9.81·0.15 = 1.4715 Nm/kg with the foot level; none with it upright
    torque = gravity_torque(angle=np.array([0.0, np.pi / 3, np.pi / 2]), theta_foot=0.0)[0]
    assert torque == pytest.approx([1.4715, 0.73575, 0.0], abs=1e-12)


def test_gravity_is_greatest_with_the_foot_level() -> None:
    angles = np.linspace(-0.9, 0.6, 301)
    torque = gravity_torque(angle=angles, theta_foot=0.3)[0]
    assert angles[np.argmax(torque)] == pytest.approx(0.3, abs=0.005)
    off = np.array([0.1, 0.4])
    above, below = (gravity_torque(angle=0.3 + s * off, theta_foot=0.3)[0] for s in (1, -1))
    assert above == pytest.approx(below)
    turned = gravity_torque(angle=off + 0.7, theta_foot=0.9)[0]
    assert turned == pytest.approx(gravity_torque(angle=off, theta_foot=0.2)[0])


def test_slope_of_gravity() -> None:
    angles = np.linspace(-0.9, 0.6, 301)
    above, below = (gravity_torque(angle=angles + s * 1e-6, theta_foot=0.3)[0] for s in (1, -1))
    slope = gravity_torque(angle=angles, theta_foot=0.3)[1]
    assert slope == pytest.approx((above - below) / 2e-6, abs=1e-8)
