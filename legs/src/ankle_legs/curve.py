"""The relaxed curve's true measures, by doing with the leg what their definitions say.

*Relaxed* is held still for ever at each angle. *Slow* is a stretch at 5 °/s that begins relaxed at
-30°. Each is read at the ankle's own angle, and at the angle that the device shows: its zero, its
play and what yields between are in that one. The foot's weight, inertia, the torque's zero and the
device's friction are in neither; tissue that softens is conditioned.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from ankle_legs.handling import Between
from ankle_legs.measures import LAST, MEASURED_AT
from ankle_legs.muscle import Array, integrate
from ankle_legs.subject import Subject
from ankle_legs.tissue import Tissue

START = -30.0  # of slow stretches [deg]
SPEED = 5.0  # [deg/s]
TORQUES = (5, 10, 15)  # at which ranges and stiffnesses are read [Nm]
STEP = 1 / 500  # of simulated protocols [s]
NEAR = 0.05  # half of the way over which a slope is taken [deg]
PASSES = 200  # until what yields between plate and ankle has settled
Turns = Callable[[Array], Array]
Found = dict[str, float | None]


@dataclass(frozen=True)
class Ankle:
    """Relaxed muscles and tissue, and what lies between them and the device."""

    subject: Subject  # with all that departs in it for good
    tissues: tuple[Tissue, ...]
    between: tuple[Between, ...] = ()
    turned: float = 0.0  # how much more than the ankle's own angle the device shows [rad]

    @cached_property
    def _muscles(self) -> CubicSpline:
        """The relaxed torque of the muscles alone over their range [rad]."""
        angle = np.radians(np.linspace(-80, 60, 561))
        return CubicSpline(angle, self.subject.passive_torque(angle))

    def still(self, angle: Array) -> Array:
        """Return the torque of the ankle that is held still at its own angles [rad], relaxed."""
        of_tissues = sum((d.rest(angle) for d in self.tissues), np.zeros(angle.shape))
        return np.asarray(self._muscles(angle) + of_tissues)

    def glide(self, angle: Array, step: float = STEP) -> Array:
        """Return the torque over a movement of the ankle that begins relaxed, step by step."""
        zero, one = np.zeros(angle.size), np.ones(angle.size)
        paths, arms = self.subject.geometry.path(angle), self.subject.geometry.arm(angle)
        torque = sum((d.resist(angle, step) for d in self.tissues), zero)
        for i, muscle in enumerate(self.subject.muscles()):
            force = integrate(step, paths[i], zero, one, zero, muscle.constants())[1]
            torque = torque + (1, -1)[i] * arms[i] * force
        return np.asarray(torque)

    @cached_property
    def _shown(self) -> tuple[Array, Array]:
        """The device's angles [rad] and the relaxed torque at each."""
        angle = np.radians(np.linspace(-80, 60, 14001))
        torque = self.still(angle)
        given = sum((d.gives_still(torque) for d in self.between), np.zeros(angle.size))
        return angle + self.turned + given, torque

    def still_shown(self, shown: Array) -> Array:
        """Return the relaxed torque at angles that the device shows."""
        return np.interp(shown, *self._shown)

    def glide_shown(self, shown: Array, step: float = STEP) -> Array:
        """Return the torque over a movement of the plate."""
        given, torque = np.zeros(shown.size), np.zeros(shown.size)
        for _ in range(PASSES if self.between else 1):
            before, torque = torque, self.glide(shown - self.turned - given, step)
            if not self.between or np.max(np.abs(torque - before)) < 1e-6:
                return torque
            now = sum((d.gives(shown, torque, step) for d in self.between), np.zeros(shown.size))
            given = 0.5 * (given + now)
        raise ArithmeticError("what lies between plate and ankle does not settle")


def own_measures(ankle: Ankle, moved: tuple[float, float]) -> Found:
    """Return the measures at the ankle's own angles; ``moved`` is its range [rad]."""
    measures = _curve(ankle.still, ankle.glide, *np.degrees(moved))
    measures["relaxed_share@10s"] = _share(ankle)
    return measures


def shown_measures(ankle: Ankle, moved: tuple[float, float]) -> Found:
    """Return the measures at the device's angles; ``moved`` is the range that it shows [rad]."""
    return _curve(ankle.still_shown, ankle.glide_shown, *np.degrees(moved))


def _curve(still: Turns, glide: Turns, low: float, high: float) -> Found:
    """Return what is read of a relaxed and of a slow curve, over a range [deg]."""

    def relaxed(degrees: float) -> float:
        return float(still(np.radians([degrees]))[0])

    top = max(high, *MEASURED_AT) + 1.0
    angle, torque = _stretched(glide, top)

    def slow(degrees: float) -> float:
        return float(np.interp(degrees, angle, torque))

    from_ = max(low, high - LAST)
    measures: Found = {
        "end_torque": relaxed(high),
        "end_stiffness": (relaxed(high) - relaxed(from_)) / (high - from_),
        "torque_rise": relaxed(high) - relaxed(low),
        "hysteresis": _hysteresis(glide, high),
    }
    degrees = np.arange(low, high + 0.01, 0.05)
    curves = {"": still(np.radians(degrees)), "slow_": np.interp(degrees, angle, torque)}
    for at in MEASURED_AT:
        for name, read in (("passive", relaxed), ("slow", slow)):
            measures[f"{name}_torque@{at}deg"] = read(at)
            rise = read(at + NEAR) - read(at - NEAR)
            measures[f"{name}_stiffness@{at}deg"] = rise / (2 * NEAR)
    for newtons in TORQUES:
        for name, curve in curves.items():
            there = _reached(degrees, curve, newtons)
            read = slow if name else relaxed
            measures[f"{name}range_at_torque@{newtons}Nm"] = there
            measures[f"{name}stiffness_at_torque@{newtons}Nm"] = (
                None if there is None else (read(there + NEAR) - read(there - NEAR)) / (2 * NEAR)
            )
    return measures


def _stretched(glide: Turns, top: float) -> tuple[Array, Array]:
    """Return angles [deg] and torques of a slow stretch from -30° to the top."""
    steps = np.arange(round((top - START) / (SPEED * STEP)) + 1)
    degrees = np.asarray(START + SPEED * STEP * steps, float)
    return degrees, glide(np.radians(degrees))


def _reached(degrees: Array, torque: Array, newtons: float) -> float | None:
    """Return the first angle at which a curve comes up to a torque; None: not within it."""
    over = torque >= newtons
    if not over.any() or over[0]:
        return None
    i = int(np.argmax(over))
    return float(np.interp(newtons, torque[i - 1 : i + 1], degrees[i - 1 : i + 1]))


def _hysteresis(glide: Turns, high: float) -> float | None:
    """Return what a slow stretch from -30° to the end and back loses, % of its work upwards."""
    steps = round((high - START) / (SPEED * STEP))
    there = START + SPEED * STEP * np.arange(steps + 1)
    angle = np.radians(np.concatenate([there, there[-2::-1]]))
    torque = glide(angle)
    work = 0.5 * (torque[1:] + torque[:-1]) * np.diff(angle)
    up = float(work[:steps].sum())
    return 100 * float(work.sum()) / up if up > 0.05 else None


def _share(ankle: Ankle) -> float:
    """Return what relaxes in 10 s after a sudden stretch from -30° to 10°, % of its rise."""
    step = 1e-3
    angle = np.radians(np.full(round(10 / step) + 2, 10.0))
    angle[0] = np.radians(START)
    undragged = tuple(d.undragged() for d in ankle.tissues)
    torque = Ankle(ankle.subject, undragged).glide(angle, step)
    return 100 * float((torque[1] - torque[-1]) / (torque[1] - torque[0]))
