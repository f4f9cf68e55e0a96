"""Who the leg belongs to: parameters of healthy adults or of patients, and their measures.

Ranges follow van de Poll (2015, section 2.5.4) and, for the passive torque at 10 degrees of
dorsiflexion, Chung et al. (2004): 6.2 (sd 3.6) Nm healthy, 9.5 (4.8) Nm spastic. The
tendons' stretch spans what ultrasound of the Achilles and the tibialis anterior tendon found
(Maganaris and Paul 1999, 2002; Magnusson et al. 2001).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from ankle_legs.muscle import Array, Muscle, relaxed_force

GRAVITY = 9.81
LEVER = 0.15  # from the ankle to the centre of the foot and plate [m]
GROUPS = ("tri", "tib")
ELECTRODES = ("ta", "gl", "sol", "gm")
PARAMETERS = (
    *("m", "k_tri", "k_tib", "x0_tri", "x0_tib", "tau_rel", "k_rel", "g1", "g2", "g3", "g4"),
    *("l0_tri", "l0_tib", "f0", "beta", "dlt_tri", "dlt_tib"),
)


@dataclass(frozen=True)
class Geometry:
    """Moment arms, and the length of muscle and tendon less the tendon's slack length."""

    #: per group (triceps, tibialis): coefficients of 1, angle, angle squared [m]
    arms: Array = field(
        default_factory=lambda: np.array([[0.0480, -0.0104, 0], [0.0393, 0.0171, 0]])
    )
    #: the same of the path
    paths: Array = field(
        default_factory=lambda: np.array(
            [[0.118 - 1.67 * 0.0480, 1.67 * 0.0104, 0], [0.136 - 1.56 * 0.0393, -1.56 * 0.0171, 0]]
        )
    )

    def arm(self, angle: Array) -> Array:
        """Return both moment arms at each angle [m]."""
        return np.asarray(self.arms @ np.array([np.ones_like(angle), angle, angle**2]))

    def path(self, angle: Array) -> Array:
        """Return both paths at each angle [m]."""
        return np.asarray(self.paths @ np.array([np.ones_like(angle), angle, angle**2]))


@dataclass(frozen=True)
class Subject:
    """What stays with a leg, under the thesis's names (SI units)."""

    values: dict[str, float]
    population: str
    range: tuple[float, float]  # that the leg may be moved in [rad]
    torque: tuple[float, float]  # that effort reaches, triceps and tibialis [Nm]
    geometry: Geometry = field(default_factory=Geometry)
    shapes: tuple[dict[str, float], dict[str, float]] = (
        {},
        {},
    )  # departures from Muscle's defaults

    def muscles(self) -> tuple[Muscle, Muscle]:
        """Return triceps and tibialis."""
        v = self.values
        triceps, tibialis = (
            Muscle(
                k=v["k_" + group],
                x0=v["x0_" + group],
                tau_rel=v["tau_rel"],
                k_rel=v["k_rel"],
                l0=v["l0_" + group],
                f0=v["f0"],
                beta=v["beta"],
                dlt=v["dlt_" + group],
                f_max=f_max,
            )
            for group, f_max in zip(GROUPS, (8000.0, 1400.0), strict=True)
        )
        return replace(triceps, **self.shapes[0]), replace(tibialis, **self.shapes[1])

    def shaped(self, shapes: Iterable[dict[str, float]]) -> Subject:
        """Return the same leg with other constants of triceps and tibialis."""
        first, second = ({**old, **new} for old, new in zip(self.shapes, shapes, strict=True))
        return replace(self, shapes=(first, second))

    def with_values(self, **changed: float) -> Subject:
        """Return the same leg with other parameters."""
        return replace(self, values={**self.values, **changed})

    def passive_torque(self, angle: Array) -> Array:
        """Return the fully relaxed elastic torque, triceps less tibialis [Nm]."""
        path, arm = self.geometry.path(angle), self.geometry.arm(angle)
        triceps, tibialis = (
            relaxed_force(muscle, path[i]) * arm[i] for i, muscle in enumerate(self.muscles())
        )
        return np.asarray(triceps - tibialis)


def draw(rng: np.random.Generator, population: str, *, tendons: bool = True) -> Subject:
    """Draw a leg of the population ("healthy" or "patient")."""
    patient = population == "patient"

    def near(middle: float, spread: float, low: float, high: float) -> float:
        return float(np.clip(rng.normal(middle, spread), low, high))

    def around(middle: float, spread: float) -> float:
        return float(middle * np.exp(spread * np.clip(rng.normal(), -2.2, 2.2)))

    for _ in range(1000):
        values = {
            "m": near(1.7 if patient else 2.0, 0.3, 1.2, 3.0),
            "k_tri": around(220 if patient else 200, 0.17),
            "k_tib": around(120 if patient else 110, 0.17),
            "x0_tri": near(0.0148 if patient else 0.0163, 0.0014, 0.011, 0.0195),
            "x0_tib": near(0.062 if patient else 0.065, 0.003, 0.055, 0.073),
            "tau_rel": float(np.clip(around(2.5, 0.5), 1, 8)),
            "k_rel": float(np.clip(around(0.33, 0.35), 0.12, 0.6)),
            "g1": around(1.0e6, 0.35),
            "g2": around(1.0e6, 0.35),
            "g3": around(1.5e6, 0.35),
            "g4": around(1.2e6, 0.35),
            "l0_tri": near(0.043 if patient else 0.0455, 0.002, 0.038, 0.051),
            "l0_tib": near(0.075 if patient else 0.079, 0.004, 0.068, 0.09),
            "f0": around(1.8 if patient else 2.0, 0.2),
            "beta": around(1.0, 0.12),
            "dlt_tri": float(rng.uniform(0.012, 0.030)) if tendons else 0.0,
            "dlt_tib": float(rng.uniform(0.005, 0.012)) if tendons else 0.0,
        }
        low, high = near(-0.75, 0.07, -0.9, -0.55), near(0.5, 0.06, 0.35, 0.6)
        reach = (
            (rng.uniform(25, 60), rng.uniform(10, 25))
            if patient
            else (rng.uniform(50, 95), rng.uniform(15, 35))
        )
        subject = Subject(values, population, (low, high), (float(reach[0]), float(reach[1])))
        if common(subject):
            break
    return bounded(subject)


def common(subject: Subject) -> bool:
    """Return whether its passive torque at 10 degrees is one that the population has."""
    patient = subject.population == "patient"
    at_10 = float(subject.passive_torque(np.radians([10.0]))[0])
    return (2.0 if patient else 1.5) < at_10 < (19.0 if patient else 13.4)


def bounded(subject: Subject) -> Subject:
    """Return the leg with a range that ends where a robot turns back, for its torque's sake."""
    low, high = subject.range
    angles = np.linspace(low, high, 60)
    far = subject.passive_torque(angles) > 25
    if far.any():
        high = float(angles[np.argmax(far)])
    return replace(subject, range=(low, high))
