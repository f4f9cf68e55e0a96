"""Appendix A: what a covariance matrix shows of linear and non-linear models, Figures 42 and 43.

Mass-spring-dampers, fitted by the least squares and the covariance that fit the muscles.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.inference import Covariance, covariance, minimise
from surae.protocol import generate
from surae.report.figures.research import correlation_figure
from surae_thesis.claims import Ruling, judge_all
from surae_thesis.legs import NOISE, protocol
from surae_thesis.section import Context, Drawing, Result

#: Position, velocity and acceleration, shape (3, n).
Motion = FloatArray
#: A motion and parameters to the force and its derivatives by them.
Force = Callable[[Motion, FloatArray], tuple[FloatArray, FloatArray]]
#: Stiffness [Nm/rad], damping [Nm·s/rad], inertia [kg·m²], velocity offset [rad/s]; starts.
TRUTH = {"k": 100.0, "b": 2.0, "m": 0.1, "u": 0.5}
_START = {"k": 10.0, "b": 1.0, "m": 1.0, "u": 0.0}


@dataclass(frozen=True, slots=True)
class FittedSpring:
    """Estimates by name, and their covariance."""

    values: dict[str, float]
    known: Covariance

    def sem(self, name: str) -> float:
        """Standard error of a parameter."""
        at = self.known.names.index(name)
        return float(np.sqrt(self.known.matrix[at, at]))

    def pairs(self) -> dict[tuple[str, str], float]:
        """Correlation of every pair."""
        names = self.known.names
        matrix = self.known.correlation
        return {
            (a, b): float(matrix[i, j])
            for i, a in enumerate(names)
            for j, b in enumerate(names)
            if i < j
        }


def protocol_motion(*, filtered: bool = True) -> Motion:
    """The thesis's richest movement about its mean, as the manipulator can follow it or not."""
    device = "achilles" if filtered else ""
    motion = generate(protocol("multi-sine-holds", rate_hz=256.0, device=device))
    return np.stack([motion.angle - motion.angle.mean(), motion.velocity, motion.acceleration])


def linear_force(motion: Motion, p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Force k·x + b·x' + m·x'' (A.2), shape (n,), and its derivatives, shape (3, n)."""
    return p @ motion, motion


def offset_force(motion: Motion, p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Force k·x + b·(x' − u) + m·x'' (A.2), shape (n,), and its derivatives, shape (4, n)."""
    x, v, a = motion
    k, b, m, u = p
    return k * x + b * (v - u) + m * a, np.stack([x, v - u, a, np.full_like(x, -b)])


def fit_spring(force: Force, motion: Motion, seed: int) -> FittedSpring:
    """A model fitted to its own noisy force."""
    names = tuple(TRUTH) if force is offset_force else tuple(TRUTH)[:3]
    clean = force(motion, np.array([TRUTH[name] for name in names]))[0]
    noise = np.random.default_rng(seed).standard_normal(len(clean))
    measured = clean + NOISE * np.abs(clean).mean() * noise

    def rows(p: FloatArray) -> FloatArray:
        modelled, derivatives = force(motion, p)
        return np.vstack([derivatives, modelled - measured])

    start = np.array([_START[name] for name in names])
    end = minimise(rows, start, np.full(len(names), -1e6), np.full(len(names), 1e6))
    known = covariance(end.R, names, end.sse, len(measured))
    return FittedSpring(dict(zip(names, end.x.tolist(), strict=True)), known)


@dataclass(frozen=True, slots=True)
class Numbers:
    """The fits that the claims look at; along x = exp(t) a motion equals its derivatives (A.3)."""

    linear: FittedSpring
    offset: FittedSpring
    unfiltered: FittedSpring
    alike: FittedSpring


def fitted(seed: int) -> Numbers:
    """Fit all of them."""
    motion = protocol_motion()
    alike = np.exp(np.linspace(0.0, 2.0, 512))
    return Numbers(
        fit_spring(linear_force, motion, seed),
        fit_spring(offset_force, motion, seed),
        fit_spring(linear_force, protocol_motion(filtered=False), seed),
        fit_spring(linear_force, np.stack([alike] * 3), 0),
    )


def run(context: Context) -> Result:
    """Fit both models to one noisy force and look at their covariance matrices."""
    context.progress("appendix", 0, 1)
    numbers = fitted(context.seed)
    return Result(
        findings=judge_all("appendix", {"": numbers}, __name__),
        figures=tuple(
            Drawing(
                name,
                f"Figure {name[-2:]}: {kind} mass-spring-damper",
                "Normalised covariance matrix of the estimates.",
                f"Heat map of the correlations of {', '.join(fit.values)}.",
                correlation_figure(fit.known.names, fit.known.correlation),
            )
            for name, kind, fit in (
                ("figure-42", "linear", numbers.linear),
                ("figure-43", "non-linear", numbers.offset),
            )
        ),
        notes=(
            "F = k·x + b·x' + m·x'' and F = k·x + b·(x' − u) + m·x''. The thesis gives neither "
            "values nor the motion: x is its multi-sine with holds and chirp, as the manipulator "
            f"follows it, about its mean; {', '.join(f'{n} = {v:g}' for n, v in TRUTH.items())}, "
            "and the force has noise of 5 % of its mean magnitude. The sign in the bracket is lost "
            "in print; a product b·(x'·u) would leave b and u inseparable, while the thesis "
            "estimates both.",
        ),
    )


def linear(n: Numbers, small: float) -> Ruling:
    """The linear model's largest correlation."""
    (first, second), worst = max(n.linear.pairs().items(), key=lambda item: abs(item[1]))
    other = n.unfiltered.pairs()["k", "m"]
    text = f"largest {worst:+.2f} ({first}, {second}); unfiltered k and m {other:+.2f}"
    return Ruling(abs(worst) <= small, text)


def non_linear(n: Numbers, small: float, high: float) -> Ruling:
    """The correlation of b and u, and the largest of the others."""
    pairs = n.offset.pairs()
    diagonal = pairs.pop(("b", "u"))
    worst = max(map(abs, pairs.values()))
    text = f"b–u {diagonal:+.2f}, others at most {worst:.2f}"
    return Ruling(abs(diagonal) >= high and worst <= small, text)


def accurate(n: Numbers) -> Ruling:
    """Errors of b and u."""
    fit = n.offset
    off = {name: (fit.values[name] - TRUTH[name]) / fit.sem(name) for name in ("b", "u")}
    part = {name: 100 * fit.sem(name) / abs(TRUTH[name]) for name in ("b", "u")}
    return Ruling(
        max(map(abs, off.values())) <= 3 and max(part.values()) < 5,
        ", ".join(f"{name} {off[name]:+.1f} SEM off, SEM {part[name]:.2g} %" for name in off),
    )


def alike(n: Numbers) -> Ruling:
    """What the covariance cannot tell apart along x = exp(t)."""
    directions = n.alike.known.directions
    groups = "; ".join(" ".join(group) for group in directions) or "none"
    return Ruling(directions == (("k", "b", "m"),), f"inseparable: {groups}")
