"""Families that one may look at while an estimate is made: departures that real legs have.

Sizes and sources stand in the README's table. Each family is a function that draws a leg's
departures; ``strength`` scales their size for mixtures.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from ankle_legs.leg import Departure, Run
from ankle_legs.movement import FINE
from ankle_legs.muscle import Array
from ankle_legs.subject import Geometry, Subject

Draw = Callable[[np.random.Generator, float], tuple[Departure, ...]]
FORCE_PER_VOLT = dict.fromkeys(("g1", "g2", "g3", "g4"), "force per volt is no constant here")


@dataclass(frozen=True)
class Curve(Departure):
    """b: force over EMG is a power, or an exponential, of it (Lloyd and Besier 2003)."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    power: float = 1.0
    exponent: float = 0.0

    def excite(self, run: Run) -> None:
        """Bend each muscle's excitation, its peak kept."""
        peak = run.excitation.max(axis=1, keepdims=True)
        peak[peak < 50] = 1000.0  # a trial without effort
        share = run.excitation / peak
        bent = np.expm1(self.exponent * share) / np.expm1(self.exponent) if self.exponent else share
        run.excitation = peak * bent**self.power


@dataclass(frozen=True)
class Drift(Departure):
    """c: what an electrode shows of a muscle drifts within the trial, not linearly."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    sizes: Array

    def measure(self, run: Run) -> None:
        """Scale each channel by a course of its own: saturating, an arch or a slow walk."""
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

    factors: tuple[dict[str, float], dict[str, float]]

    def leg(self, subject: Subject) -> Subject:
        """Scale the muscles' constants."""
        shapes = tuple(
            {**old, **{name: getattr(muscle, name) * f for name, f in factors.items()}}
            for old, factors, muscle in zip(
                subject.shapes, self.factors, subject.muscles(), strict=True
            )
        )
        return replace(subject, shapes=(shapes[0], shapes[1]))


@dataclass(frozen=True)
class ShortRange(Departure):
    """e: bridges that hold stiffen the muscle until they yield (Rack and Westbury 1974)."""

    stiffness: float  # [F/l0]
    reach: float  # [l0]

    def leg(self, subject: Subject) -> Subject:
        """Give both muscles short-range stiffness."""
        own = {"srs": self.stiffness, "srs_range": self.reach}
        return replace(subject, shapes=({**subject.shapes[0], **own}, {**subject.shapes[1], **own}))


@dataclass(frozen=True)
class Reflex(Departure):
    """e: stretch above a speed makes the triceps pull, and electrodes show a part of it."""

    gain: float  # [N s/m]
    threshold: float  # [m/s]
    latency: float  # [s]
    shown: float  # share that reaches the electrodes

    def excite(self, run: Run) -> None:
        """Add the reflex to the triceps's excitation."""
        speed = np.gradient(run.path[0], run.step)
        force = run.delayed(self.gain * np.maximum(speed - self.threshold, 0), self.latency)
        values = run.subject.values
        for i, share in ((1, 0.2), (2, 0.55), (3, 0.25)):
            run.excitation[i] = run.excitation[i] + share * force
            run.emg[i] += self.shown * share * force / values[f"g{i + 1}"]


@dataclass(frozen=True)
class Arms(Departure):
    """f: moment arms of another scale, slope and curvature; the paths' slopes go with them."""

    change: Array  # per group: scale, slope [m/rad], curvature [m/rad2]

    def leg(self, subject: Subject) -> Subject:
        """Change the arms; lengths at the neutral angle stay."""
        old = subject.geometry
        arms = old.arms * (1 + self.change[:, :1])
        arms[:, 1:] += self.change[:, 1:]
        paths = old.paths.copy()
        paths[:, 1] = -np.array([1.67, 1.56]) * arms[:, 1]
        paths[:, 2] = -np.array([1.67, 1.56]) * arms[:, 2]
        return replace(subject, geometry=Geometry(arms, paths))


@dataclass(frozen=True)
class Plate(Departure):
    """g: the foot gives way on its plate: the ankle's angle is not the robot's."""

    loops: ClassVar[bool] = True
    degrees: float  # at the torque that efforts commonly reach

    def turn(self, run: Run) -> None:
        """Turn the ankle by what the torque bends."""
        bend = np.radians(self.degrees) / (0.7 * run.subject.torque[0])
        run.ankle = run.ankle - run.lagged(bend * run.torque, 0.02)  # flesh is damped


@dataclass(frozen=True)
class Untared(Departure):
    """h: the sensor carries the plate's inertia and its weight at an angle of its own."""

    unscored: ClassVar[dict[str, str]] = {"m": "the plate adds to what moves and weighs"}
    inertia: float  # [kg m2]
    weight: float  # [Nm]
    angle: float  # at which it is horizontal [rad]

    def measure(self, run: Run) -> None:
        """Add the plate's torque."""
        acceleration = np.gradient(np.gradient(run.plate, run.step), run.step)
        run.torque += self.inertia * acceleration + self.weight * np.cos(run.plate - self.angle)


@dataclass(frozen=True)
class Fluctuation(Departure):
    """j: each envelope fluctuates, as few motor units make it do, and the force does not."""

    size: float  # sd of the logarithm
    seconds: float = 0.106  # correlation time of 1.5 Hz

    def measure(self, run: Run) -> None:
        """Multiply each envelope by an Ornstein-Uhlenbeck course with a mean of one."""
        n = run.times.size // FINE
        keep = np.exp(-run.step * FINE / self.seconds)
        for i in range(4):
            y, course = run.rng.normal(), np.empty(n)
            for j, kick in enumerate(run.rng.normal(size=n) * np.sqrt(1 - keep**2)):
                y = keep * y + kick
                course[j] = y
            factor = np.exp(self.size * course - self.size**2 / 2)
            run.seen[i] *= np.interp(run.times, run.times[::FINE], factor)


def curve(rng: np.random.Generator, strength: float = 1.0) -> tuple[Departure, ...]:
    """Draw b."""
    if rng.random() < 0.5:
        return (Curve(power=1 - strength * rng.uniform(0.2, 0.4)),)
    return (Curve(exponent=-2.0 * strength),)


def drift(rng: np.random.Generator, strength: float = 1.0) -> tuple[Departure, ...]:
    """Draw c."""
    return (Drift(sizes=strength * rng.uniform(0.14, 0.22, 4)),)


def shapes(rng: np.random.Generator, strength: float = 1.0) -> tuple[Departure, ...]:
    """Draw d: widths +30 to +120 %, speeds and asymptotes both ways."""
    between = {
        "short_width": (1.3, 2.2), "long_width": (1.3, 2.2), "vmax": (0.7, 1.4),
        "curvature": (0.7, 1.6), "ecc_curvature": (0.6, 1.6), "ecc_plateau": (0.87, 1.2),
    }  # fmt: skip
    first, second = (
        {name: float(rng.uniform(*ends) ** strength) for name, ends in between.items()}
        for _ in range(2)
    )
    return (Shapes((first, second)),)


def short_range(rng: np.random.Generator, strength: float = 1.0) -> tuple[Departure, ...]:
    """Draw e."""
    stiff = ShortRange(23.4 * strength * rng.uniform(0.7, 1.3), 0.01 * rng.uniform(0.6, 1.4))
    return (
        stiff,
        Reflex(
            gain=strength * rng.uniform(2e3, 8e3),
            threshold=rng.uniform(0.0, 0.004),
            latency=rng.uniform(0.03, 0.05),
            shown=rng.uniform(0.0, 0.6),
        ),
    )


def arms(rng: np.random.Generator, strength: float = 1.0) -> tuple[Departure, ...]:
    """Draw f."""
    scale = rng.choice([-1, 1], 2) * rng.uniform(0.05, 0.08, 2)
    slope, curvature = rng.normal(0, 0.005, 2), rng.normal(0, 0.004, 2)
    return (Arms(strength * np.column_stack([scale, slope, curvature])),)


def plate(rng: np.random.Generator, strength: float = 1.0) -> tuple[Departure, ...]:
    """Draw g."""
    return (Plate(strength * rng.uniform(2, 4)),)


def untared(rng: np.random.Generator, strength: float = 1.0) -> tuple[Departure, ...]:
    """Draw h."""
    return (
        Untared(
            inertia=strength * rng.uniform(0.02, 0.05),
            weight=strength * rng.uniform(3, 7),
            angle=rng.choice([-1, 1]) * rng.uniform(0.5, 1.3),
        ),
    )


def fluctuation(_: np.random.Generator, strength: float = 1.0) -> tuple[Departure, ...]:
    """Draw j."""
    return (Fluctuation(0.15 * strength),)


def mixture(rng: np.random.Generator, strength: float = 0.5) -> tuple[Departure, ...]:
    """Draw i: all of b to h at half their strength."""
    kinds = (curve, drift, shapes, short_range, arms, plate, untared)
    return tuple(departure for kind in kinds for departure in kind(rng, strength))


def none(_: np.random.Generator, __: float = 1.0) -> tuple[Departure, ...]:
    """Draw a and p: the laboratory's imperfections alone."""
    return ()


FAMILIES: dict[str, Draw] = {
    "a": none, "b": curve, "c": drift, "d": shapes, "e": short_range, "f": arms,
    "g": plate, "h": untared, "i": lambda rng, _: mixture(rng), "j": fluctuation, "p": none,
}  # fmt: skip
