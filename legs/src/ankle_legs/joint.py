"""An ankle in a servo of finite stiffness: intrinsic impedance and stretch reflexes in one loop.

The device pulls the foot with a proportional-derivative servo on its own inertia; the torque of
the ankle works back on it. Central differences, so second order in the step. SI units;
dorsiflexion is positive, and so is the torque when the calf pulls.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass

import numpy as np
from numba import njit

from ankle_legs.muscle import Array

FINE = 8000  # steps a second


@dataclass(frozen=True)
class Servo:
    """The device: it follows the command as a filter of the second order, if nothing loads it."""

    bandwidth: float = 25.0  # [Hz]
    damping: float = 0.8
    inertia: float = 5.0  # of the motor, seen at the foot: the more, the less it yields [kg m2]


@dataclass(frozen=True)
class Intrinsic:
    """What the ankle does without a nerve; the stiffness counts with all branches relaxed."""

    inertia: float  # of foot and sensor together [kg m2]
    viscosity: float  # [Nm s/rad]
    stiffness: float  # [Nm/rad]
    branch: float = 0.0  # stiffness of a spring that relaxes (Zener) [Nm/rad]
    seconds: float = 0.01  # its time constant
    branch_2: float = 0.0
    seconds_2: float = 0.05
    bend: float = 0.0  # relative rise of stiffness over the angle [1/rad]
    hold: float = 0.0  # stiffness of bridges that hold and yield (Dahl) [Nm/rad]
    reach: float = 0.005  # stretch at which they yield [rad]
    drag: float = 0.0  # of viscosity that falls with speed: share lost at 1 rad/s

    def slow_viscosity(self) -> float:
        """Return the viscosity at low frequency: damper and relaxing branches [Nm s/rad]."""
        return self.viscosity + self.branch * self.seconds + self.branch_2 * self.seconds_2


@dataclass(frozen=True)
class Reflex:
    """Rectified, late velocity, through a filter of the second order (Kearney et al. 1997)."""

    gain: float  # steady torque for a velocity [Nm s/rad]
    delay: float  # [s]
    frequency: float  # [rad/s]
    damping: float
    threshold: float = 0.0  # [rad/s]
    sign: float = 1.0  # 1: the calf, by dorsiflexion; -1: the tibialis, by plantarflexion
    power: float = 1.0  # of the velocity
    ceiling: float = 0.0  # velocity at which it saturates; 0: never [rad/s]
    slope: float = 0.0  # relative rise of the gain over the angle [1/rad]


@njit(cache=True)
def _move(
    h: float,
    command: Array,
    load: Array,
    level: Array,
    habit: Array,
    servo: Array,
    tissue: Array,
    reflexes: Array,
) -> tuple[Array, Array, Array, Array, Array]:
    n = command.size
    x, speed = np.zeros(n + 1), np.zeros(n)
    torque, elastic, neural = np.zeros(n), np.zeros(n), np.zeros((reflexes.shape[0], n))
    omega, motor = 2 * math.pi * servo[0], servo[2]
    pull, brake = motor * omega * omega, 2 * servo[1] * motor * omega
    mass, k = tissue[0], tissue[2]
    keep_1, keep_2 = math.exp(-h / tissue[4]), math.exp(-h / tissue[6])
    f_1 = f_2 = s = before = 0.0
    state = np.zeros((reflexes.shape[0], 2))
    asked = np.zeros(reflexes.shape[0])
    for i in range(n):
        here = x[i]
        dx = here - before
        f_1 = keep_1 * f_1 + tissue[3] * tissue[4] / h * (1 - keep_1) * dx
        f_2 = keep_2 * f_2 + tissue[5] * tissue[6] / h * (1 - keep_2) * dx
        s = (s + dx) / (1 + abs(dx) / tissue[9])
        elastic[i] = k * level[i] * (here + 0.5 * tissue[7] * here * here)
        rest = elastic[i] + f_1 + f_2 + tissue[8] * s + load[i]
        for j in range(reflexes.shape[0]):
            r = reflexes[j]
            then = i - r[1] / h
            late = 0.0
            if then > 0:
                at = int(then)
                share = then - at
                late = (1 - share) * speed[at] + share * speed[at + 1]
            late = max(r[5] * late - r[4], 0.0)
            if r[6] != 1.0:
                late = late ** r[6]
            if r[7] > 0:
                late = r[7] * math.tanh(late / r[7])
            late *= r[0] * habit[i] * max(1 + r[8] * here, 0.0)
            w, z = r[2], r[3]
            y, dy = state[j, 0], state[j, 1]  # the trapezoidal rule
            goal = 0.5 * (late + asked[j]) - y - 0.25 * h * dy * 2
            rate = (dy + 0.5 * h * w * (2 * w * goal - 2 * z * dy)) / (
                1 + h * z * w + (0.5 * h * w) ** 2
            )
            state[j, 0], state[j, 1] = y + 0.5 * h * (dy + rate), rate
            asked[j] = late
            neural[j, i] = r[5] * state[j, 0]
            rest += neural[j, i]
        damper = tissue[1] * math.sqrt(level[i]) / (1 + tissue[10] * abs(dx / h))
        total, drag = motor + mass, brake + damper
        x[i + 1] = (
            total * (2 * here - before) / h**2
            + drag * before / (2 * h)
            + pull * (command[i] - here)
            - rest
        ) / (total / h**2 + drag / (2 * h))
        speed[i] = (x[i + 1] - before) / (2 * h)
        torque[i] = mass * (x[i + 1] - 2 * here + before) / h**2 + damper * speed[i] + rest
        before = here
    return x[:n], speed, torque, elastic, neural


def move(
    command: Array,
    servo: Servo,
    tissue: Intrinsic,
    reflexes: tuple[Reflex, ...] = (),
    *,
    load: Array | None = None,
    level: Array | None = None,
    habit: Array | None = None,
) -> tuple[Array, Array, Array, Array, Array]:
    """Return angle, velocity, torque, its elastic part and each reflex's, at ``FINE`` steps/s.

    ``load`` [Nm] is what the person does beside, ``level`` multiplies stiffness (and, by its root,
    viscosity), ``habit`` the reflexes' gain. The ankle begins at rest at the angle 0.
    """
    none, one = np.zeros(command.size), np.ones(command.size)
    table = np.array([astuple(r) for r in reflexes], float).reshape(len(reflexes), 9)
    return tuple(  # type: ignore[return-value]
        _move(
            1 / FINE,
            np.asarray(command, float),
            none if load is None else load,
            one if level is None else level,
            one if habit is None else habit,
            np.array(astuple(servo), float),
            np.array(astuple(tissue), float),
            table,
        )
    )
