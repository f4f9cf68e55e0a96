"""How a relaxed leg is placed and measured: zeros, drift, rubbing, and what yields between.

What lies between the device's plate and the ankle makes two angles of one: the device's and the
ankle's own. What is *not stated* (a tilted seat, a plate's weight, tone, a reflex) stands here
too, for an estimate has to doubt it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numba import njit
from scipy.signal import lfilter

from ankle_legs.leg import Departure, Run, between
from ankle_legs.muscle import Array
from ankle_legs.subject import GRAVITY, LEVER


@njit(cache=True)
def rubbed(x: Array, reach: float) -> Array:
    """Return Dahl's friction of a course, between -1 and 1; it builds up over ``reach``."""
    state = np.zeros(x.size)
    for i in range(1, x.size):
        d = (x[i] - x[i - 1]) / reach
        state[i] = (state[i - 1] + d) / (1 + abs(d))
    return state


@njit(cache=True)
def played(x: Array, play: float) -> Array:
    """Return how much less than x something moves that is driven with play, from its middle."""
    away = np.zeros(x.size)
    for i in range(1, x.size):
        free = away[i - 1] + x[i] - x[i - 1]
        away[i] = min(max(free, -0.5 * play), 0.5 * play)
    return away


@dataclass(frozen=True)
class Setup(Departure):
    """How the leg was placed for a visit; every relaxed leg has it."""

    turned: float  # how much more than the ankle's own angle the device shows [rad]
    tilt: float  # of the shank [rad], which turns the foot's weight
    foot: float  # by how much more the foot weighs than its mass says, by where it lies: a share
    drift: float  # of the torque [Nm/min]
    wander: float  # of the torque, slow noise [Nm]
    friction: float  # of the device [Nm]
    reach: float  # over which it builds up [rad]

    def zero(self) -> float:
        return self.turned

    def turn(self, run: Run) -> None:
        run.ankle = run.ankle - self.turned

    def measure(self, run: Run) -> None:
        weight = run.subject.values["m"] * GRAVITY * LEVER
        heavy = (1 + self.foot) * np.cos(run.ankle + self.tilt) - np.cos(run.ankle)
        keep = float(np.exp(-run.step / 0.4))
        kicks = run.rng.normal(size=run.times.size) * np.sqrt(1 - keep**2)
        noise = lfilter([1.0], [1.0, -keep], kicks)
        run.torque += weight * heavy + self.drift * run.times / 60 + self.wander * noise
        run.torque += self.friction * rubbed(run.plate, self.reach)


@dataclass(frozen=True)
class MovedZero(Departure):
    """The zero of the torque, or of the angle, steps within the trial; the torque drifts."""

    torque: float = between(1.0, 4.0, signed=True)  # [Nm]
    angle: float = between(1.0, 3.0, signed=True)  # [deg]
    which: float = between(0, 1, none=None)  # below 0.65 the torque's, above 0.45 the angle's
    drift: float = between(-2.0, 2.0)  # [Nm/min]

    def measure(self, run: Run) -> None:
        at = run.rng.uniform(0.2, 0.8) * run.times[-1]
        step = np.clip((run.times - at) / 0.1, 0, 1)
        run.torque += self.drift * run.times / 60
        if self.which < 0.65:
            run.torque += self.torque * step
        if self.which > 0.45:
            run.plate = run.plate + np.radians(self.angle) * step


class Between(Departure):
    """What lies between the plate and the ankle, which turns less than the plate."""

    loops: ClassVar[bool] = True

    def gives(self, plate: Array, torque: Array, step: float) -> Array:
        """Return how much less the ankle turns than the plate [rad]."""
        raise NotImplementedError

    def gives_still(self, torque: Array) -> Array:
        """Return the same of what is held still, by the torque of muscles and tissue alone."""
        return self.gives(np.zeros(torque.size), torque, 1.0)

    def turn(self, run: Run) -> None:
        given = self.gives(run.plate, run.torque + run.joint, run.step)
        name = type(self).__name__
        sunk = 0.5 * (run.sunk.get(name, 0.0) + given)  # halfway: steep tissue settles too
        run.sunk[name] = sunk
        run.ankle = run.ankle - sunk


@dataclass(frozen=True)
class HeelLift(Between):
    """The heel leaves the plate where the calf pulls hard: the foot turns less than the plate."""

    degrees: float = between(1.5, 4.5)  # at 10 Nm above where it begins
    begins: float = between(3.0, 9.0, none=None)  # [Nm]
    soft: float = between(0.5, 2.0, none=None)  # over which it begins [Nm]

    def gives(self, plate: Array, torque: Array, step: float) -> Array:
        del plate, step
        above = self.soft * np.logaddexp(0.0, (torque - self.begins) / self.soft)
        return np.asarray(np.radians(self.degrees) * 1.5 * np.tanh(above / 15.0))


@dataclass(frozen=True)
class SoftPlate(Between):
    """The plate, straps and flesh yield to the torque, both ways."""

    degrees: float = between(1.0, 4.0)  # at 20 Nm
    late: float = between(0.01, 0.06, none=None)  # [s]

    def gives(self, plate: Array, torque: Array, step: float) -> Array:
        del plate
        keep = float(np.exp(-step / self.late))
        felt = lfilter([1 - keep], [1, -keep], torque, zi=keep * torque[:1])[0]
        return self.gives_still(felt)

    def gives_still(self, torque: Array) -> Array:
        return np.asarray(np.radians(self.degrees) * np.tanh(torque / 30.0) / np.tanh(20 / 30.0))


@dataclass(frozen=True)
class Play(Between):
    """The device's gears have play: the foot leans on the flank that its torque presses.

    Where the torque is less than what rubs beyond the gears, the movement decides which flank that
    is; so the play never gives back more work than was put in.
    """

    degrees: float = between(0.6, 2.5)  # between the flanks
    friction: float = between(0.2, 1.5)  # beyond the gears [Nm]
    weight: float = between(0.0, 2.0, none=None)  # of foot and plate [Nm]
    soft: ClassVar[float] = 0.5  # torque over which the foot goes over to the other flank [Nm]

    def _moved(self, plate: Array) -> Array:
        """Return which flank the movement leads to, -1 to 1."""
        width = float(np.radians(max(self.degrees, 1e-6)))
        return np.asarray(played(plate, width) / (0.5 * width))

    def gives(self, plate: Array, torque: Array, step: float) -> Array:
        del step
        pressed = torque + self.weight + self.friction * self._moved(plate)
        return np.asarray(np.radians(0.5 * self.degrees) * np.tanh(pressed / self.soft))

    def gives_still(self, torque: Array) -> Array:
        pressed = (torque + self.weight) / self.soft
        return np.asarray(np.radians(0.5 * self.degrees) * np.tanh(pressed))

    def measure(self, run: Run) -> None:
        run.torque += self.friction * self._moved(run.plate)


def pull_calf(run: Run, torque: Array, shown: float) -> None:
    """Let the calf pull by a torque [Nm] that its electrodes show a share of."""
    force = torque / float(run.subject.geometry.arm(np.zeros(1))[0, 0])
    for i, share in ((1, 0.2), (2, 0.55), (3, 0.25)):
        run.excitation[i] = run.excitation[i] + share * force
        run.emg[i] = run.emg[i] + shown * share * force / run.subject.values[f"g{i + 1}"]


@dataclass(frozen=True)
class StretchReflex(Departure):
    """A calf that is stretched faster than a threshold pulls back, late; no one says so."""

    size: float = between(1.0, 5.0)  # at 100 °/s, steadily [Nm]
    threshold: float = between(12.0, 40.0, none=None)  # [deg/s]
    latency: float = between(0.03, 0.05, none=None)  # [s]
    shown: float = between(-0.5, 0.6, none=None)  # share that electrodes show; none below 0

    def excite(self, run: Run) -> None:
        speed = np.degrees(np.gradient(run.plate, run.step))
        fast = np.maximum(speed - self.threshold, 0.0) / (100.0 - self.threshold)
        pull_calf(run, run.delayed(self.size * fast, self.latency), max(self.shown, 0.0))


@dataclass(frozen=True)
class Tone(Departure):
    """The calf does not let go: it pulls all the time, now a little more and now less."""

    size: float = between(0.5, 3.0)  # in the mean [Nm]
    unsteady: float = between(0.05, 0.3)
    shown: float = between(0.3, 1.0, none=None)  # share that electrodes show

    def excite(self, run: Run) -> None:
        knots = np.arange(0, run.times[-1] + 8, 4.0)
        course = np.interp(run.times, knots, run.rng.normal(size=knots.size))
        pull_calf(run, self.size * np.maximum(1 + self.unsteady * course, 0.0), self.shown)


@dataclass(frozen=True)
class Tilted(Departure):
    """The seat is tilted, so that the foot's weight acts at another angle."""

    unscored: ClassVar[dict[str, str]] = {"m": "the foot is not level at 0°"}
    degrees: float = between(10, 25, signed=True)

    def measure(self, run: Run) -> None:
        turned = np.cos(run.ankle + np.radians(self.degrees)) - np.cos(run.ankle)
        run.torque += run.subject.values["m"] * GRAVITY * LEVER * turned
