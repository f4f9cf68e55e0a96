"""Mass-spring-dampers, fitted by the least squares and the covariance that fit the muscles."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from surae.assessment import covariance
from surae.estimation import minimise
from surae.protocol import DEVICES, Protocol, chirp_rate, generate
from surae.units import FloatArray

#: Position, velocity and acceleration, shape (n,) each.
Motion = tuple[FloatArray, FloatArray, FloatArray]
#: A motion and parameters to the force and its derivatives by them.
Force = Callable[[Motion, FloatArray], tuple[FloatArray, FloatArray]]
#: Stiffness [Nm/rad], damping [Nm·s/rad], inertia [kg·m²], velocity offset [rad/s].
TRUTH: dict[str, float] = {"k": 100.0, "b": 2.0, "m": 0.1, "u": 0.5}
_START: dict[str, float] = {"k": 10.0, "b": 1.0, "m": 1.0, "u": 0.0}
#: Standard deviation of the force's noise, as a part of its mean magnitude, as in 2.5.3.
_NOISE = 0.05


@dataclass(frozen=True, slots=True)
class FittedSpring:
    """Estimates, standard errors where there are any, and their normalised covariance.

    Inseparable parameters trade off without changing the force.
    """

    names: tuple[str, ...]
    values: Mapping[str, float]
    sem: Mapping[str, float]
    correlation: FloatArray
    inseparable: tuple[tuple[str, ...], ...]

    def pairs(self) -> dict[tuple[str, str], float]:
        """Correlation of every pair."""
        return {
            (a, b): float(self.correlation[i, j])
            for i, a in enumerate(self.names)
            for j, b in enumerate(self.names)
            if i < j
        }


def protocol_motion(*, filtered: bool = True) -> Motion:
    """The thesis's richest movement about its mean, as the manipulator can follow it or not."""
    motion = generate(
        Protocol(
            profile="multi-sine-holds",
            chirp_amplitude=0.2,
            chirp_rate=chirp_rate(0.5),
            rate_hz=256.0,
            device=DEVICES["achilles"] if filtered else None,
        )
    )
    return motion.angle - motion.angle.mean(), motion.velocity, motion.acceleration


def linear_force(motion: Motion, p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Force k·x + b·x' + m·x'' (A.2), shape (n,), and its derivatives, shape (3, n)."""
    rows = np.stack(motion)
    return p @ rows, rows


def offset_force(motion: Motion, p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Force k·x + b·(x' − u) + m·x'' (A.2), shape (n,), and its derivatives, shape (4, n)."""
    x, v, a = motion
    k, b, m, u = p
    force = k * x + b * (v - u) + m * a
    return force, np.stack([x, v - u, a, np.full_like(x, -b)])


def fit_linear(motion: Motion, seed: int) -> FittedSpring:
    """The linear model fitted to its own noisy force."""
    return _fit(linear_force, motion, ("k", "b", "m"), seed)


def fit_offset(motion: Motion, seed: int) -> FittedSpring:
    """The non-linear model fitted to its own noisy force."""
    return _fit(offset_force, motion, ("k", "b", "m", "u"), seed)


def exponential() -> FittedSpring:
    """The linear model fitted along x = exp(t), which equals its derivatives (A.3)."""
    x = np.exp(np.linspace(0.0, 2.0, 512))
    return _fit(linear_force, (x, x, x), ("k", "b", "m"), 0)


def _fit(force: Force, motion: Motion, names: tuple[str, ...], seed: int) -> FittedSpring:
    truth = np.array([TRUTH[name] for name in names])
    clean = force(motion, truth)[0]
    noise = np.random.default_rng(seed).standard_normal(len(clean))
    measured = clean + _NOISE * np.abs(clean).mean() * noise

    def rows(p: FloatArray) -> FloatArray:
        modelled, derivatives = force(motion, p)
        return np.vstack([derivatives, modelled - measured])

    p = len(names)
    start = np.array([_START[name] for name in names])
    end = minimise(rows, start, np.full(p, -1e6), np.full(p, 1e6))
    cov = covariance(end.R, names, end.sse, len(measured))
    errors = dict(zip(cov.names, np.sqrt(np.diag(cov.matrix)).tolist(), strict=True))
    return FittedSpring(
        names, dict(zip(names, end.x.tolist(), strict=True)), errors, cov.correlation,
        cov.directions,
    )  # fmt: skip
