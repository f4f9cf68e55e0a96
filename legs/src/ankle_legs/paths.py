"""Legs whose muscles' paths and moment arms are their own: arms of people, paths that do work.

A muscle and tendon that shorten by what the joint turns, times the arm, conserve work. What its
fascicles travel of that is the gear: 1 in a straight muscle, less where it is pennate or its heads
share the way (0.3 to 1.1). Lengths of such a leg are in the metres that its path travels in, so
that a gear stretches path, lengths and tendon alike; what turns the joint stays what people have.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ankle_legs import look
from ankle_legs.leg import Departure, Leg, drawn
from ankle_legs.muscle import Array
from ankle_legs.subject import GROUPS, Geometry, Subject, bounded, common, draw

ARM_SD = 0.095  # between adults (Wolfram et al. 2018)
NARROW_SD = 0.04
GEAR, GEAR_SD = 0.57, 0.33  # median and sd of the logarithm
GEARS = (0.3, 1.1)
SIGNS = (1.0, -1.0)  # of the path's slope: dorsiflexion lengthens the calf


@dataclass(frozen=True)
class Way:
    """How a family draws arms and gears."""

    arm_sd: float  # of an arm's logarithm
    gear: float | None = None  # of every leg; None: drawn
    bent: float = 0.0  # by how much the gear may change over a radian, of itself
    thesis: bool = False  # the thesis's paths, whatever the arms are
    departures: tuple[type[Departure], ...] = ()
    laboratory: bool = True


@dataclass(frozen=True)
class BentGeometry(Geometry):
    """Paths with a cubic part, of a gear that changes over the angle."""

    cubic: tuple[float, float] = (0.0, 0.0)  # [m/rad^3]

    def path(self, angle: Array) -> Array:
        """Return both paths at each angle [m]."""
        return np.asarray(super().path(angle) + np.outer(self.cubic, angle**3))


def own_arms(rng: np.random.Generator, sd: float) -> Array:
    """Draw moment arms about the textbook's: scales, and slopes within 2 mm/rad."""
    arms = Geometry().arms * np.exp(sd * np.clip(rng.normal(size=(2, 1)), -2.5, 2.5))
    if sd:
        arms[:, 1] += rng.uniform(-0.002, 0.002, 2)
    return np.asarray(arms)


def geared(
    subject: Subject, arms: Array, gears: Array, bends: tuple[float, float] = (0.0, 0.0)
) -> Subject:
    """Return the leg with paths that travel ``gears`` times its ``arms``.

    The gears change by ``bends`` of themselves over a radian.

    Lengths (x0, l0, the path at 0 degrees) grow as the path's slope does, k falls; the tendon's
    stretch is a gear's share of what it is in the line of pull.
    """
    old, paths, cubic = subject.geometry.paths, np.zeros((2, 3)), np.zeros(2)
    changed: dict[str, float] = {}
    for i, group in enumerate(GROUPS):
        slope = SIGNS[i] * float(gears[i]) * arms[i]
        ratio = float(slope[0] / old[i, 1])
        paths[i] = (old[i, 0] * ratio, slope[0], (slope[1] + bends[i] * slope[0]) / 2)
        cubic[i] = bends[i] * slope[1] / 3
        v = {name: subject.values[f"{name}_{group}"] for name in ("k", "x0", "l0", "dlt")}
        changed |= {
            f"k_{group}": v["k"] / ratio,
            f"x0_{group}": v["x0"] * ratio,
            f"l0_{group}": v["l0"] * ratio,
            f"dlt_{group}": v["dlt"] * float(gears[i]),
        }
    bent = BentGeometry(arms, paths, (float(cubic[0]), float(cubic[1])))
    moved = replace(subject, geometry=bent if any(bends) else Geometry(arms, paths))
    return moved.with_values(**changed)


def _subject(rng: np.random.Generator, subject: Subject, way: Way) -> Subject:
    arms = own_arms(rng, way.arm_sd)
    if way.thesis:
        return replace(subject, geometry=Geometry(arms, subject.geometry.paths.copy()))
    gears = np.full(2, way.gear if way.gear is not None else np.nan)
    if way.gear is None:
        gears = np.clip(GEAR * np.exp(GEAR_SD * rng.normal(size=2)), *GEARS)
    first, second = rng.uniform(-way.bent, way.bent, 2)
    return geared(subject, arms, gears, (float(first), float(second)))


FAMILIES: dict[str, Way] = {
    "va": Way(NARROW_SD, thesis=True),
    "vb": Way(ARM_SD, thesis=True),
    "vc": Way(0.0, gear=1.0),
    "vd": Way(ARM_SD),
    "ve": Way(ARM_SD, laboratory=False),
    "vf": Way(ARM_SD, departures=(look.Spring, look.Zero)),
    "vg": Way(ARM_SD, departures=(look.Shapes, look.Drift)),
}


def leg(family: str, seed: int, way: Way, rng: np.random.Generator) -> Leg:
    """Return a leg with arms and paths of its own."""
    population = "patient" if rng.random() < 1 / 3 else "healthy"
    for _ in range(1000):
        subject = _subject(rng, draw(rng, population), way)
        if common(subject):
            break
    subject = bounded(subject)
    return Leg(family, seed, subject, drawn(*way.departures)(rng, 0.7), way.laboratory)
