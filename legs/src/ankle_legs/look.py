"""Families that one may look at while an estimate is made: departures that real legs have.

Each family draws a leg's departures, at a strength that is below 1 in mixtures.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np

from ankle_legs.leg import Departure, Draw, Run, between, drawn
from ankle_legs.movement import FINE
from ankle_legs.muscle import Array
from ankle_legs.subject import GRAVITY, LEVER, Geometry, Subject

FORCE_PER_VOLT = dict.fromkeys(("g1", "g2", "g3", "g4"), "force per volt is no constant here")
STRONGEST = {"active_torque_max": "the largest activity does not make this torque"}


@dataclass(frozen=True)
class Curve(Departure):
    """b: force over EMG is a power, or an exponential, of it (Lloyd and Besier 2003)."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    power: float = 1.0
    exponent: float = 0.0

    def excite(self, run: Run) -> None:
        peak = run.excitation.max(axis=1, keepdims=True)
        peak[peak < 50] = 1000.0  # a trial without effort
        share = run.excitation / peak
        bent = np.expm1(self.exponent * share) / np.expm1(self.exponent) if self.exponent else share
        run.excitation = peak * bent**self.power


@dataclass(frozen=True)
class Drift(Departure):
    """c: what an electrode shows of a muscle drifts within the trial, not linearly."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    sizes: Array = between(0.14, 0.22, 4)

    def measure(self, run: Run) -> None:
        u = run.times / run.times[-1]
        for i, size in enumerate(self.sizes):
            knots = np.cumsum(run.rng.normal(size=6))
            courses = (
                -np.expm1(-u * run.rng.uniform(2, 6)),
                np.sin(np.pi * u ** run.rng.uniform(0.6, 1.6)),
                np.interp(u, np.linspace(0, 1, 6), knots),
            )
            course = courses[run.rng.integers(3)]
            run.seen[i] *= 1 + size * run.rng.choice([-1, 1]) * course / np.max(np.abs(course))


@dataclass(frozen=True)
class Shapes(Departure):
    """d: force-length and force-velocity curves have other widths and asymptotes."""

    short_width: Array = between(1.3, 2.2, 2, none=1)
    long_width: Array = between(1.3, 2.2, 2, none=1)
    vmax: Array = between(0.7, 1.4, 2, none=1)
    curvature: Array = between(0.7, 1.6, 2, none=1)
    ecc_curvature: Array = between(0.6, 1.6, 2, none=1)
    ecc_plateau: Array = between(0.87, 1.2, 2, none=1)

    def leg(self, subject: Subject) -> Subject:
        return subject.shaped(
            {
                one.name: getattr(muscle, one.name) * getattr(self, one.name)[i]
                for one in fields(self)
            }
            for i, muscle in enumerate(subject.muscles())
        )


@dataclass(frozen=True)
class ShortRange(Departure):
    """e: bridges that hold stiffen the muscle until they yield (Rack and Westbury 1974)."""

    stiffness: float = between(16, 30)  # [F/l0]
    reach: float = between(0.006, 0.014, none=None)  # [l0]

    def leg(self, subject: Subject) -> Subject:
        return subject.shaped([{"srs": self.stiffness, "srs_range": self.reach}] * 2)


@dataclass(frozen=True)
class Reflex(Departure):
    """e: stretch above a speed makes the triceps pull, and electrodes show a part of it."""

    gain: float = between(2e3, 8e3)  # [N s/m]
    threshold: float = between(0, 0.004, none=None)  # [m/s]
    latency: float = between(0.03, 0.05, none=None)  # [s]
    shown: float = between(0, 0.6, none=None)  # share that reaches the electrodes

    def excite(self, run: Run) -> None:
        speed = np.gradient(run.path[0], run.step)
        force = run.delayed(self.gain * np.maximum(speed - self.threshold, 0), self.latency)
        values = run.subject.values
        for i, share in ((1, 0.2), (2, 0.55), (3, 0.25)):
            run.excitation[i] = run.excitation[i] + share * force
            run.emg[i] += self.shown * share * force / values[f"g{i + 1}"]


@dataclass(frozen=True)
class Arms(Departure):
    """f: moment arms of another scale, slope and curvature; the paths' slopes go with them."""

    scale: Array = between(0.05, 0.08, 2, signed=True)
    slope: Array = between(-0.008, 0.008, 2)  # [m/rad]
    curvature: Array = between(-0.006, 0.006, 2)  # [m/rad2]

    def leg(self, subject: Subject) -> Subject:
        old = subject.geometry
        arms = old.arms * (1 + self.scale[:, None])
        arms[:, 1:] += np.column_stack([self.slope, self.curvature])
        paths = old.paths.copy()
        paths[:, 1:] = -np.array([[1.67], [1.56]]) * arms[:, 1:]  # lengths at neutral stay
        return replace(subject, geometry=Geometry(arms, paths))


@dataclass(frozen=True)
class Plate(Departure):
    """g: the foot gives way on its plate: the ankle's angle is not the robot's."""

    loops: ClassVar[bool] = True
    degrees: float = between(2, 4)  # at the torque that efforts commonly reach

    def turn(self, run: Run) -> None:
        bend = np.radians(self.degrees) / (0.7 * run.subject.torque[0])
        run.ankle = run.ankle - run.lagged(bend * run.torque, 0.02)  # flesh is damped


@dataclass(frozen=True)
class Untared(Departure):
    """h: the sensor carries the plate's inertia and its weight at an angle of its own."""

    unscored: ClassVar[dict[str, str]] = {"m": "the plate adds to what moves and weighs"}
    inertia: float = between(0.02, 0.05)  # [kg m2]
    weight: float = between(3, 7)  # [Nm]
    angle: float = between(0.5, 1.3, signed=True, none=None)  # where it is horizontal [rad]

    def measure(self, run: Run) -> None:
        acceleration = np.gradient(np.gradient(run.plate, run.step), run.step)
        run.torque += self.inertia * acceleration + self.weight * np.cos(run.plate - self.angle)


@dataclass(frozen=True)
class Fluctuation(Departure):
    """j: each envelope fluctuates, as few motor units make it do, and the force does not."""

    size: float = between(0.15, 0.15)  # sd of the logarithm

    def measure(self, run: Run) -> None:
        n = run.times.size // FINE
        keep = np.exp(-run.step * FINE * 2 * np.pi * 1.5)
        for i in range(4):
            y, course = run.rng.normal(), np.empty(n)
            for j, kick in enumerate(run.rng.normal(size=n) * np.sqrt(1 - keep**2)):
                y = keep * y + kick
                course[j] = y
            factor = np.exp(self.size * course - self.size**2 / 2)
            run.seen[i] *= np.interp(run.times, run.times[::FINE], factor)


@dataclass(frozen=True)
class Release(Departure):
    """k: muscles let go more slowly than they take hold (Zajac 1989)."""

    hold: float = between(0.01, 0.02)  # [s]
    let_go: float = between(0.04, 0.08)  # [s]

    def excite(self, run: Run) -> None:
        taken = [-np.expm1(-run.step / max(t, 1e-6)) for t in (self.hold, self.let_go)]
        state = run.excitation[:, 0].copy()
        for i, goal in enumerate(run.excitation.T.copy()):
            state = state + (goal - state) * np.where(goal > state, *taken)
            run.excitation[:, i] = state


@dataclass(frozen=True)
class Spring(Departure):
    """m: capsule, ligaments, skin and hinge are a spring with a neutral angle of its own."""

    stiffness: float = between(1.0, 3.5)  # [Nm/rad]; 4 to 8 of the whole ankle are assumed
    neutral: float = between(-0.45, 0.0, none=None)  # [rad]

    def rest(self, angle: Array) -> Array:
        return self.stiffness * (angle - self.neutral)


@dataclass(frozen=True)
class Damper(Departure):
    """n: the joint, or the device's hinge, is damped."""

    damping: float = between(0.1, 0.35)  # [Nm s/rad]

    def resist(self, angle: Array, step: float) -> Array:
        return self.damping * np.gradient(angle, step)


@dataclass(frozen=True)
class Zero(Departure):
    """o: foot plate, malleolus and shoe were set at another zero of the angle."""

    degrees: float = between(3, 5, signed=True)

    def zero(self) -> float:
        return float(np.radians(self.degrees))

    def turn(self, run: Run) -> None:
        run.ankle = run.ankle - self.zero()


@dataclass(frozen=True)
class Softening(Departure):
    """r: tissue softens in its first stretches; the truth is that of conditioned tissue."""

    loops: ClassVar[bool] = True
    unscored: ClassVar[dict[str, str]] = dict.fromkeys(
        ("dissipated_energy",), "it depends on how often the tissue was stretched"
    )
    size: float = between(0.2, 0.35)  # of the force that the first stretches take away
    travel: float = between(0.02, 0.06, none=None)  # of the muscle, in which most of it goes [m]

    def load(self, run: Run) -> None:
        if not run.length.any():
            return
        for i, muscle in enumerate(run.subject.muscles()):
            elastic = np.exp(muscle.k * (run.length[i] - muscle.x0)) / (1 + muscle.k_rel)
            gone = np.cumsum(np.abs(np.diff(run.length[i], prepend=run.length[i, 0])))
            run.extra[i] += self.size / (1 - self.size) * elastic * np.exp(-gone / self.travel)


@dataclass(frozen=True)
class Lag(Departure):
    """t: torque sensor, or EMG, comes through a filter or a cable of its own."""

    torque: float = between(-0.03, 0.03)  # below 0: the EMG is late [s]
    filtered: float = between(0, 1, none=None)

    def measure(self, run: Run) -> None:
        seconds, filtered = abs(self.torque), self.filtered > 0.5
        late = run.lagged if filtered else run.delayed
        if seconds < run.step:
            return
        if self.torque > 0:
            run.torque = late(run.torque, seconds)
        else:
            run.seen = late(run.seen, seconds)


@dataclass(frozen=True)
class Poor(Departure):
    """u: one electrode shows nothing, or two are clipped."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    level: float = between(0.35, 0.7, none=1)  # of the largest EMG, where it is clipped
    idle: float = between(0, 1, none=None)

    def measure(self, run: Run) -> None:
        order = run.rng.permutation(4)
        if self.idle < 0.4:
            run.seen[order[0]] = 2e-6
        else:
            for i in order[:2]:
                run.seen[i] = np.minimum(run.seen[i], self.level * run.seen[i].max())


@dataclass(frozen=True)
class Pennate(Departure):
    """v: the calf is pennate; lengths of the truth are those in its line of pull."""

    unscored: ClassVar[dict[str, str]] = {"k_tri": "no one exponential of the length in line"}
    degrees: float = between(15, 27)  # at the optimal length

    def leg(self, subject: Subject) -> Subject:
        v, turn = subject.values, np.radians(self.degrees)
        width = float(v["l0_tri"] * np.tan(turn))
        l0, x0 = v["l0_tri"] / np.cos(turn), np.hypot(v["x0_tri"], width)
        k = v["k_tri"] * (v["l0_tri"] - v["x0_tri"]) / (l0 - x0)  # the same force at l0
        return subject.shaped(({"width": width, "l0": l0, "x0": x0, "k": k}, {}))


@dataclass(frozen=True)
class Reclined(Departure):
    """w: the seat is reclined, so that gravity pulls at another angle."""

    unscored: ClassVar[dict[str, str]] = {"m": "the foot is not level at 0°"}
    degrees: float = between(25, 55, signed=True)

    def measure(self, run: Run) -> None:
        turned = np.cos(run.ankle + np.radians(self.degrees)) - np.cos(run.ankle)
        run.torque += run.subject.values["m"] * GRAVITY * LEVER * turned


def curve(rng: np.random.Generator, strength: float) -> tuple[Departure, ...]:
    """Draw b."""
    if rng.random() < 0.5:
        return (Curve(power=1 - strength * rng.uniform(0.2, 0.4)),)
    return (Curve(exponent=-2.0 * strength),)


def mixture(rng: np.random.Generator, _: float) -> tuple[Departure, ...]:
    """Draw i: all of b to h at half their strength."""
    return tuple(departure for name in "bcdefgh" for departure in FAMILIES[name](rng, 0.5))


FAMILIES: dict[str, Draw] = {
    "a": drawn(),
    "b": curve,
    "c": drawn(Drift),
    "d": drawn(Shapes),
    "e": drawn(ShortRange, Reflex),
    "f": drawn(Arms),
    "g": drawn(Plate),
    "h": drawn(Untared),
    "i": mixture,
    "j": drawn(Fluctuation),
    "k": drawn(Release),
    "m": drawn(Spring),
    "n": drawn(Damper),
    "o": drawn(Zero),
    "p": drawn(),
    "r": drawn(Softening),
    "t": drawn(Lag),
    "u": drawn(Poor),
    "v": drawn(Pennate),
    "w": drawn(Reclined),
}
