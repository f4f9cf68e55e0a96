"""Numbers of a fit of both paths, with their intervals."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from surae.base.units import FloatArray
from surae.nerve.cascade import relaxing, relaxing_slope
from surae.nerve.fitting import Fitted, Problem, regressors, slopes
from surae.nerve.piece import Piece
from surae.nerve.response import faster

#: Blocks from which their scatter is told.
LEAST_BLOCKS = 5


@dataclass(frozen=True, slots=True)
class Number:
    """An estimate and its 95 % interval."""

    value: float
    low: float
    high: float

    def allowing(self, part: float) -> "Number":
        """The same, with an error of so great a part of it in its interval."""
        low = np.hypot(self.value - self.low, part * self.value)
        high = np.hypot(self.high - self.value, part * self.value)
        return replace(self, low=float(self.value - low), high=float(self.value + high))

    def with_(self, low: float, high: float) -> "Number":
        """The same value, with what another says in its interval."""
        return replace(self, low=min(self.low, low), high=max(self.high, high))


#: What is computed of the parameters of a fit: value, and its derivative by each parameter.
Of = Callable[[Fitted], tuple[float, Mapping[str, float]]]


def _viscosity(fitted: Fitted) -> tuple[float, Mapping[str, float]]:
    """Slope of the torque over the velocity when slow [Nm·s/rad]: B + Σ Kᵢτᵢ."""
    v = fitted.values
    value = fitted.values["viscosity"]
    by = {"viscosity": 1.0}
    for i in range(1, fitted.structure.branches + 1):
        value += v[f"branch_{i}"] * v[f"time_{i}"]
        by |= {f"branch_{i}": v[f"time_{i}"], f"time_{i}": v[f"branch_{i}"]}
    return value, by


def parameter(name: str, factor: float = 1.0) -> Of:
    """What a parameter is by itself, times a factor."""
    return lambda fitted: (factor * fitted.values[name], {name: factor})


INTRINSIC: dict[str, Of] = {
    "intrinsic_stiffness": parameter("stiffness"),
    "intrinsic_viscosity": _viscosity,
    "inertia": parameter("inertia"),
}
REFLEX: dict[str, Of] = {
    "reflex_gain": parameter("gain"),
    "reflex_delay": parameter("delay", 1e3),
    "reflex_frequency": parameter("omega", 0.5 / np.pi),
    "reflex_damping": parameter("zeta"),
    "reflex_threshold": parameter("threshold", 180.0 / np.pi),
}
#: Of which the logarithm is estimated as if it were normal.
_RATIOS = ("reflex_gain", "reflex_frequency", "reflex_damping", "reflex_share")


def share(pieces: Sequence[Piece], fitted: Fitted) -> tuple[float, Mapping[str, float]]:
    """Variance of the reflex's torque in that of the torque [%], and its derivatives."""
    structure = fitted.structure
    v = fitted.values
    reflex = {"delay", "omega", "zeta", "threshold"} & set(structure.nonlinear)
    total = 0.0
    squares = 0.0
    by = dict.fromkeys(reflex, 0.0)
    for piece in pieces:
        x = regressors(piece, structure, v)
        answered = faster(piece, v["gain"] * x[-1])
        total += piece.variance * len(answered)
        squares += float(np.sum(answered**2))
        for name, row in zip(structure.nonlinear, slopes(piece, structure, v, x), strict=True):
            if name in by:
                by[name] += 2.0 * float(answered @ faster(piece, row))
    by["gain"] = 2.0 * squares / max(v["gain"], 1e-12)
    return 100.0 * squares / total, {name: 100.0 * each / total for name, each in by.items()}


class Judged:
    """A fit with its covariance: numbers with intervals."""

    def __init__(self, problem: Problem, fitted: Fitted, floor: float = 0.0) -> None:
        self.fitted = fitted
        self.covariance, self.freedom, self.pulls = problem.covariance(fitted)
        self.quantile = float(stdtrit(self.freedom, 0.975))
        self.biases = _biases(problem, fitted, floor) if floor else None

    def number(self, name: str, of: Of) -> Number:
        """The number that `of` computes, with its interval."""
        value, by = of(self.fitted)
        gradient = np.array([by.get(each, 0.0) for each in self.fitted.structure.names])
        half = self.quantile * float(np.sqrt(gradient @ self.covariance @ gradient))
        for pull in self.pulls:
            if (m := len(pull)) > LEAST_BLOCKS:
                scatter = float(np.sum((pull @ gradient) ** 2)) * m / (m - 1)
                half = max(half, float(stdtrit(m - 1, 0.975) * np.sqrt(scatter)))
        if self.biases is not None:
            noise, jumps = np.abs(self.biases @ gradient)
            half = float(np.hypot(half, noise) + jumps)
        if name in _RATIOS and value > 0.0:
            factor = float(np.exp(min(half / value, 20.0)))
            return Number(value, value / factor, value * factor)
        return Number(value, value - half, value + half)


def _biases(problem: Problem, fitted: Fitted, floor: float) -> FloatArray:
    """How far noise of the position and unknown times of jumps may move each parameter, (2, k).

    The noise has the power floor/f² [rad²/Hz]. Jumps of the torque may all be seen half a sample
    late, or early: movement and sampling often have one clock.
    """
    _, j = problem.jacobian(fitted.structure, fitted.values)
    names = fitted.structure.names
    pull = np.zeros((2, j.shape[1]))
    v = fitted.values
    for piece, w in zip(problem.pieces, problem.weights, strict=True):
        s = 2j * np.pi * np.asarray(piece.f, np.complex128)
        power = floor / np.maximum(piece.f, 0.3) ** 2 * np.abs(s) ** 2 * w**2 * 0.5
        by = {"stiffness": 1.0 + 0.0 * s, "viscosity": s, "inertia": s**2}
        for i in range(1, fitted.structure.branches + 1):
            by[f"branch_{i}"] = relaxing(s, v[f"time_{i}"])
        whole = sum(v[name] * row for name, row in by.items())
        for i in range(1, fitted.structure.branches + 1):
            by[f"time_{i}"] = v[f"branch_{i}"] * relaxing_slope(s, v[f"time_{i}"])
        for name, row in by.items():
            pull[0, names.index(name)] += float(np.sum(np.real(np.conj(row) * whole) * power))
    pull[1] = problem.whitened([piece.jumps for piece in problem.pieces]) @ j
    size = np.sqrt(np.sum(j**2, axis=0)) + 1e-100
    inverse = np.linalg.pinv((j / size).T @ (j / size), rcond=1e-12) / np.outer(size, size)
    return np.asarray(pull @ inverse)
