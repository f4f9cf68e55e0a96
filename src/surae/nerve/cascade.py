"""Equations of the parallel cascade: torque of the tissue and torque of the reflex, by frequency.

Torque that resists the movement of the ankle is that of two paths side by side (Kearney, Stein and
Parameswaran 1997): the intrinsic one, which acts on the position at once, and the reflex, which
acts on the velocity in one direction, later. s = 2πif throughout, f in Hz, shape (n,).
"""

from dataclasses import dataclass

import numpy as np

from surae.base.units import ComplexArray, FloatArray


def relaxing(s: ComplexArray, time: float) -> ComplexArray:
    """Spring in line with a damper (Maxwell) per Nm/rad: sτ/(1 + sτ), τ its `time` [s].

    Beside a spring and a damper it makes the standard linear solid (Zener): tissue that is stiff
    at once, and softer as it relaxes.
    """
    return s * time / (1.0 + s * time)


def relaxing_slope(s: ComplexArray, time: float) -> ComplexArray:
    """Derivative of `relaxing` with respect to its time [1/s]: s/(1 + sτ)²."""
    return s / (1.0 + s * time) ** 2


def muscle(s: ComplexArray, omega: float, zeta: float) -> ComplexArray:
    """Reflex's dynamics, 1 at rest: ω²/(s² + 2ζωs + ω²), natural frequency `omega` [rad/s]."""
    return omega**2 / (s**2 + 2.0 * zeta * omega * s + omega**2)


def muscle_slopes(s: ComplexArray, omega: float, zeta: float) -> tuple[ComplexArray, ComplexArray]:
    """Derivatives of `muscle` with respect to `omega` [s/rad] and `zeta` [1]."""
    below = s**2 + 2.0 * zeta * omega * s + omega**2
    return (
        2.0 * omega * s**2 + 2.0 * zeta * omega**2 * s
    ) / below**2, -2.0 * omega**3 * s / below**2


def channel(s: ComplexArray, cutoff: float, order: int) -> tuple[ComplexArray, ComplexArray]:
    """Low-pass of the torque's channel, 1 at rest, and its derivative by `cutoff` [Hz].

    1/(1 + s/ω) of the first order, Butterworth's ω²/(s² + √2ωs + ω²) of the second, ω = 2π·cutoff.
    """
    if order == 0:
        return np.ones_like(s), np.zeros_like(s)
    omega = 2.0 * np.pi * cutoff
    if order == 1:
        below = omega + s
        return omega / below, 2.0 * np.pi * s / below**2
    damped = np.sqrt(0.5)
    return muscle(s, omega, damped), 2.0 * np.pi * muscle_slopes(s, omega, damped)[0]


def stretched(velocity: FloatArray, direction: int, threshold: float) -> FloatArray:
    """Velocity in one direction beyond a threshold [rad/s], signed: d·max(d·v − v₀, 0)."""
    beyond: FloatArray = direction * np.maximum(direction * velocity - threshold, 0.0)
    return beyond


def stretched_slope(velocity: FloatArray, direction: int, threshold: float) -> FloatArray:
    """Derivative of `stretched` with respect to the threshold [1]: −d where it is passed."""
    slope: FloatArray = -direction * (direction * velocity > threshold).astype(np.float64)
    return slope


@dataclass(frozen=True, slots=True)
class Structure:
    """What the model takes in: branches that relax, lateness, reflex and its threshold."""

    name: str  #: As texts call the intrinsic part.
    branches: int = 0  #: Maxwell branches beside inertia, viscosity and stiffness.
    late: bool = True  #: Whether the torque's channel may be late by a time that is estimated.
    direction: int = 0  #: Of the stretch that the reflex answers: 1 dorsiflexion, −1, 0 no reflex.
    threshold: bool = False  #: Whether the reflex answers only beyond a velocity.
    trend: bool = False  #: Whether the stiffness may change in proportion to time.
    #: What the reflex answers beside velocity: length by so much [1/s], and by so much [s] the
    #: acceleration, with which the force of a spring and a damper changes.
    length: float = 0.0
    lead: float = 0.0
    beyond: float = 0.0  #: That velocity where it is no parameter [rad/s].
    third: bool = False  #: Whether the reflex's dynamics has a pole more (Mirbagheri 2000).
    order: int = 0  #: Of a filter of the torque's channel, whose cut-off is estimated; 0: none.

    @property
    def answered(self) -> tuple[float, float]:
        """What the reflex answers beside velocity."""
        return self.length, self.lead

    @property
    def nonlinear(self) -> tuple[str, ...]:
        """Parameters to which the torque is not proportional."""
        reflex = ("delay", "omega", "zeta") if self.direction else ()
        times = tuple(f"time_{i + 1}" for i in range(self.branches))
        beyond = ("threshold",) if self.direction and self.threshold else ()
        pole = ("pole",) if self.direction and self.third else ()
        cutoff = ("cutoff",) if self.order else ()
        return (*(("late",) if self.late else ()), *cutoff, *times, *reflex, *pole, *beyond)

    @property
    def linear(self) -> tuple[str, ...]:
        """Parameters to which it is: stiffness, viscosity, inertia, branches, curvature, gain."""
        always = ("stiffness", "viscosity", "inertia")
        branches = tuple(f"branch_{i + 1}" for i in range(self.branches))
        trend = ("trend",) if self.trend else ()
        return (*always, *branches, "curvature", *trend, *(("gain",) if self.direction else ()))

    @property
    def names(self) -> tuple[str, ...]:
        """All parameters, in the order of vectors and matrices."""
        return (*self.nonlinear, *self.linear)


#: Bounds of the nonlinear parameters. A reflex of the ankle answers 20 to 100 ms later: without the
#: bound a fit finds a negative gain at 6 ms, which is tissue (Kearney 1997: 40 ms, soleus).
BOUNDS = {
    "late": (-0.008, 0.008),
    "cutoff": (6.0, 300.0),
    "time_1": (0.003, 0.6),
    "time_2": (0.05, 0.6),
    "delay": (0.020, 0.100),
    "omega": (5.0, 70.0),
    "zeta": (0.3, 2.5),
    "pole": (15.0, 500.0),
    "threshold": (0.0, 2.0),
    "gain": (0.0, np.inf),
    "branch_1": (0.0, np.inf),
    "branch_2": (0.0, np.inf),
}
