"""What resists a relaxed ankle beside the muscles' own exponentials: tissue of many forms.

A tissue is an elastic torque over the ankle's angle, zero or small in the middle of the range and
growing towards both ends, which relaxes with a spectrum of times (quasi-linear viscoelasticity,
Fung 1993). Its forms depart from an exponential in ways that real tissue does.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numba import njit
from scipy.signal import lfilter

from ankle_legs.leg import Departure, Run
from ankle_legs.muscle import Array
from ankle_legs.subject import Subject

#: Why parts of a leg's tissue have no truth of their own.
SHARED = {
    "k_tri": "the calf's tissue is no one exponential",
    "x0_tri": "the calf's tissue is no one exponential",
    "k_rel": "tissue and muscle relax each in their own way",
    "tau_rel": "tissue and muscle relax each in their own way",
    "passive_torque_tri": "tissue is of no one group",
    "passive_torque_tib": "tissue is of no one group",
    "passive_stiffness_tri": "tissue is of no one group",
    "passive_stiffness_tib": "tissue is of no one group",
    "k_tib": "the tibialis's tissue is no one exponential",
    "x0_tib": "the tibialis's tissue is no one exponential",
}


@njit(cache=True)
def _bonded(angle: Array, reach: float, rebuilt: float) -> Array:
    """Return how far bonds are stretched, times the share of them that is whole: -1 to 1.

    ``reach`` is the stretch at which they yield [rad], ``rebuilt`` the share of them that a step of
    stillness makes again.
    """
    held = np.zeros(angle.size)
    whole, stretch = 1.0, 0.0
    for i in range(1, angle.size):
        way = (angle[i] - angle[i - 1]) / reach
        whole = (whole + rebuilt) / (1 + rebuilt + abs(way) / 3)
        stretch = (stretch + way) / (1 + abs(way))
        held[i] = whole * stretch
    return held


@dataclass(frozen=True)
class Form:
    """An elastic torque over an angle, 1 at the end that it is scaled to.

    ``kind`` is "exponential" (grows by e over ``bend``), "toe" (nothing before ``slack``, then
    steep, with a corner of width ``bend``), "linear-quadratic" (a parabola from ``slack`` on over
    ``bend``, then its tangent), "capsule" (an exponential with ``bend`` before ``slack``, and
    from there on a stop that grows by e over ``stop``) or "sagging" (stiffness falls again beyond
    ``slack``, within ``bend``). Angles in rad.
    """

    kind: str
    end: float
    bend: float
    slack: float = 0.0
    stop: float = 0.05
    share: float = 0.5  # that the stop has of the torque at the end

    def raw(self, angle: Array) -> Array:
        """Return the torque before it is scaled."""
        away = (np.asarray(angle, float) - self.slack) / self.bend
        if self.kind == "exponential":
            return np.asarray(np.exp((angle - self.end) / self.bend))
        if self.kind == "toe":
            return np.logaddexp(0.0, away)
        if self.kind == "linear-quadratic":
            far = np.maximum(away, 0.0)
            return np.where(far < 1, 0.5 * far**2, far - 0.5)
        if self.kind == "capsule":
            soft = np.exp((angle - self.end) / self.bend)
            hard = np.expm1(np.maximum(angle - self.slack, 0.0) / self.stop)
            most = np.expm1((self.end - self.slack) / self.stop)
            return np.asarray((1 - self.share) * soft + self.share * hard / most)
        if self.kind == "sagging":
            return np.logaddexp(0.0, away) - 0.6 * np.logaddexp(0.0, away - 3.0)
        raise ValueError(f"no form {self.kind!r}")

    def __call__(self, angle: Array) -> Array:
        """Return the torque, 1 at the end."""
        return np.asarray(self.raw(angle) / self.raw(np.array([self.end]))[0])


def relaxing(elastic: Array, shares: Array, seconds: Array, step: float) -> Array:
    """Return the part of a torque that has not relaxed yet [Nm].

    Each branch is the elastic torque times a share through a high-pass of first order, settled
    before; between samples the torque is taken as a line, so that no step is too long.
    """
    total = np.zeros(elastic.size)
    for share, tau in zip(shares, seconds, strict=True):
        keep = float(np.exp(-step / tau))
        mean = -float(np.expm1(-step / tau)) * tau / step
        rises = np.diff(elastic, prepend=elastic[:1])
        total += share * lfilter([mean], [1, -keep], rises)
    return total


@dataclass(frozen=True)
class Tissue(Departure):
    """Elastic torque of both sides, its relaxation, and a drag that follows a power of speed."""

    unscored: ClassVar[dict[str, str]] = SHARED
    form: Form
    size: float  # at the dorsiflexion end [Nm]
    other: Form  # over the mirrored angle, at the plantarflexion end
    other_size: float
    shares: Array  # of the elastic torque, that relax
    seconds: Array
    muscle: float = 0.0  # share of the muscles' own exponentials that the leg has beside it
    drag: float = 0.0  # torque at 60 °/s, share of the elastic torque's sizes
    power: float = 1.0  # of the speed that the drag follows
    constant: float = 0.0  # drag at 60 °/s that does not follow the elastic torque [Nm]
    shift: float = 0.0  # of the whole curve over the angle [rad]

    def leg(self, subject: Subject) -> Subject:
        less = -float(np.log(max(self.muscle, 1e-9)))
        v = subject.values
        return subject.with_values(
            x0_tri=v["x0_tri"] + less / v["k_tri"], x0_tib=v["x0_tib"] + less / v["k_tib"]
        )

    def sides(self, angle: Array) -> tuple[Array, Array]:
        """Return the elastic torques of the calf's and of the tibialis's side, both positive."""
        at = np.asarray(angle, float) - self.shift
        return self.size * self.form(at), self.other_size * self.other(-at)

    def rest(self, angle: Array) -> Array:
        calf, front = self.sides(angle)
        return np.asarray(calf - front)

    def resist(self, angle: Array, step: float) -> Array:
        calf, front = self.sides(angle)
        elastic = calf - front
        torque = elastic + relaxing(elastic, self.shares, self.seconds, step)
        if self.drag or self.constant:
            speed = np.gradient(angle, step) / np.radians(60.0)
            slope = np.sign(speed) * np.abs(speed) ** self.power
            torque = torque + (self.drag * (calf + front) + self.constant) * slope
        return np.asarray(torque)

    def load(self, run: Run) -> None:
        run.joint = self.resist(run.ankle, run.step)  # which what lies between yields to

    def undragged(self) -> Tissue:
        """Return the tissue without the drag that follows its speed."""
        return replace(self, drag=0.0, constant=0.0)

    def conditioned(self) -> Tissue:
        """Return the tissue after it was stretched many times."""
        return self


@dataclass(frozen=True)
class Yielding(Tissue):
    """It softens as it is stretched again and again, and holds against the first movement.

    The truth is that of conditioned tissue.
    """

    unscored: ClassVar[dict[str, str]] = SHARED | dict.fromkeys(
        ("hysteresis", "dissipated_energy", "relaxed_share"),
        "it depends on how often the tissue was stretched",
    )
    softens: float = 0.3  # of the torque that conditioning takes away
    travel: float = 2.0  # over which most of it goes [rad]
    grip: float = 0.0  # of bonds that rest makes [Nm]
    reach: float = 0.02  # stretch at which they yield [rad]
    rebuild: float = 5.0  # [s]

    def resist(self, angle: Array, step: float) -> Array:
        gone = np.cumsum(np.abs(np.diff(angle, prepend=angle[:1])))
        more = self.softens / (1 - self.softens) * np.exp(-gone / self.travel)
        torque = super().resist(angle, step) * (1 + more)
        return np.asarray(torque + self._bonds(angle, step))

    def _bonds(self, angle: Array, step: float) -> Array:
        """Return the torque of bonds that movement breaks and stillness makes again [Nm]."""
        if not self.grip:
            return np.zeros(angle.size)
        return self.grip * _bonded(np.asarray(angle, float), self.reach, step / self.rebuild)

    def conditioned(self) -> Tissue:
        return replace(self, softens=0.0, grip=0.0)
