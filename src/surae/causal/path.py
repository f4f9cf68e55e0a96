"""Arm, length and speed of a muscle group at a sample: `surae.model.movement`, alone."""

import math

from surae.base.units import FloatArray
from surae.causal.signals import Record
from surae.model.jit import inner

#: Angle of the joint [rad], and its two derivatives by the device's angle.
JointTurn = tuple[float, float, float]


@inner
def joint_turn(n: Record, angle: float) -> JointTurn:
    """The joint's angle by the device's, as `surae.model.geometry.JointAxis` has it."""
    turned = angle + n.angle_zero
    if not n.has_axis:
        return turned, 1.0, 0.0
    strap, forward, up = n.strap, n.forward, n.up
    cos, sin = math.cos(turned), math.sin(turned)
    x = strap * cos - forward
    y = strap * sin - up
    square = x * x + y * y
    along = forward * cos + up * sin
    across = up * cos - forward * sin
    inside = strap * strap - forward * forward - up * up
    return (
        math.atan2(y, x) - math.atan2(-up, strap - forward),
        strap * (strap - along) / square,
        strap * across * inside / (square * square),
    )


@inner
def _interval(path: FloatArray, angle: float) -> int:
    """The interval of a path's table in which an angle lies."""
    low = 0
    high = len(path)
    while high - low > 1:
        middle = (low + high) // 2
        if path[middle, 0] <= angle:
            low = middle
        else:
            high = middle
    return low


@inner
def muscle_path(
    n: Record, path: FloatArray, group: int, joint: JointTurn, velocity: float
) -> tuple[float, float, float]:
    """Signed arm as the device feels it [m], length [m] and lengthening speed [m/s]."""
    angle, factor, _ = joint
    moving = factor * velocity
    inside = min(max(angle, n.range[0]), n.range[1])
    row = path[_interval(path, inside)]
    d = inside - row[0]
    k = 1 + 8 * group
    length = ((row[k] * d + row[k + 1]) * d + row[k + 2]) * d + row[k + 3]
    slope = (3.0 * row[k] * d + 2.0 * row[k + 1]) * d + row[k + 2]
    arm = ((row[k + 4] * d + row[k + 5]) * d + row[k + 6]) * d + row[k + 7]
    length += slope * (angle - inside)
    speed = slope * moving
    if n.has_own_path[group]:
        of_group = n.own_path[group]
        arm *= math.exp(of_group[0]) * (1.0 + of_group[1] * angle + of_group[2] * angle * angle)
        stretch = math.exp(of_group[3])
        rest = n.at_rest[group]
        length = rest + of_group[5] + stretch * (length - rest) + of_group[4] * angle * angle
        speed = stretch * speed + 2.0 * of_group[4] * angle * moving
    return factor * arm, length, speed
