"""Whether there is a reflex, and to which stretch: by what it predicts of torque not fitted."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.base.units import FloatArray
from surae.nerve.cascade import Structure, muscle
from surae.nerve.fitting import Fitted, Problem
from surae.nerve.piece import Piece
from surae.nerve.response import faster

#: Shapes of a reflex from which a search begins: delay [s], frequency [rad/s], damping.
DELAYS = np.arange(0.024, 0.0961, 0.008)
OMEGAS = (8.0, 14.0, 24.0, 40.0)
ZETAS = (0.6, 1.0)
#: What a physiological one of a person looks like: its share is bounded over these.
_LIKELY_DELAY = (0.03, 0.07)
_LIKELY_OMEGA = (12.0, 32.0)
#: z of the gain in held-out blocks over no reflex, and over the other direction, and the gain in
#: log likelihood [nats], from which a reflex is taken for present.
OVER_NONE = 2.5
OVER_OTHER = 2.0
NATS = 3.0
#: Share of the torque's variance [%] below which none is claimed, and the bound below which none is
#: seen.
LEAST_SHARE = 0.5
NONE_SEEN = 2.0


@dataclass(frozen=True, slots=True)
class Shape:
    """A reflex of fixed dynamics beside an intrinsic part: its gain alone is estimated."""

    q: Mapping[str, float]  #: Delay, frequency and damping.
    gain: float  #: [Nm·s/rad]
    sd: float  #: Its standard deviation.
    better: float  #: How much less is left, in sums of whitened squares.
    power: float  #: Variance of its torque for a gain of 1, as a share of the torque's.


def shapes(problem: Problem, intrinsic: Fitted, direction: int) -> list[Shape]:
    """Every shape of the grid, fitted with all linear parameters of an intrinsic part."""
    _, x = problem.linear(intrinsic.structure, intrinsic.values)
    basis, _ = np.linalg.qr(x.T)
    left = problem.y - basis @ (basis.T @ problem.y)
    total = sum(p.variance * (p.length + 1) for p in problem.pieces)
    late = intrinsic.values.get("late", 0.0)
    made = []
    spectra = [[p.stretched(direction, 0.0)[0] * np.exp(-p.s * late), p.s] for p in problem.pieces]
    for omega in OMEGAS:
        for zeta in ZETAS:
            filtered = [v * muscle(s, omega, zeta) for v, s in spectra]
            power = (
                sum(
                    float(np.sum(faster(p, v) ** 2))
                    for p, v in zip(problem.pieces, filtered, strict=True)
                )
                / total
            )
            delayed = [
                v * np.exp(-np.outer(DELAYS, s))
                for v, (_, s) in zip(filtered, spectra, strict=True)
            ]
            rows = problem.whitened(delayed)
            rows = rows - (rows @ basis) @ basis.T
            size = np.sum(rows**2, axis=1)
            for delay, gain, one in zip(DELAYS, rows @ left / size, size, strict=True):
                q = {"delay": float(delay), "omega": omega, "zeta": zeta}
                made.append(
                    Shape(q, float(gain), float(one**-0.5), float(gain * abs(gain) * one), power)
                )
    return made


def first_shape(of: Sequence[Shape]) -> Mapping[str, float]:
    """Where the search of a reflex begins."""
    best = max(of, key=lambda shape: shape.better)
    return best.q if best.better > 0.0 else {}


def bound(of: Sequence[Shape]) -> tuple[float, float]:
    """Greatest share [%] and gain that a physiological reflex may have unseen (two-sided 95 %)."""
    share = gain = 0.0
    for shape in of:
        delay = shape.q["delay"]
        omega = shape.q["omega"]
        likely = _LIKELY_DELAY[0] <= delay <= _LIKELY_DELAY[1]
        if likely and _LIKELY_OMEGA[0] <= omega <= _LIKELY_OMEGA[1]:
            most = max(shape.gain + 2.0 * shape.sd, 0.0)
            share = max(share, 100.0 * most**2 * shape.power)
            gain = max(gain, most)
    return share, gain


@dataclass(frozen=True, slots=True)
class Weighed:
    """A direction against none and against the other, on torque that was not fitted."""

    over_none: float  #: z of the gain over blocks of 1 s.
    over_other: float  #: The same, over the other direction.
    nats: float  #: Gain in log likelihood over no reflex.


def weigh(
    halves: Sequence[Sequence[Piece]],
    problem: Problem,
    structure: Structure,
    starts: Mapping[int, Mapping[str, float]],
) -> tuple[dict[int, Weighed], list[dict[int, Fitted]]]:
    """Both directions, each half predicting the other; and the fits of the halves."""
    errors: dict[int, list[FloatArray]] = {0: [], 1: [], -1: []}
    fits: list[dict[int, Fitted]] = []
    for half, other in (halves, halves[::-1]):
        mine = Problem(half, problem.noise)
        its = Problem(other, problem.noise)
        fits.append(
            {
                d: mine.fit(replace(structure, direction=d, threshold=False), starts[d])
                for d in errors
            }
        )
        for direction, fitted in fits[-1].items():
            for piece, w in zip(its.pieces, its.weights, strict=True):
                left = piece.in_time(fitted.residual(piece) * w)
                length = round(piece.rate)
                count = max(len(left) // length, 1)
                errors[direction].append(
                    np.sum(left[: count * length].reshape(count, -1) ** 2, axis=1)
                )
    loss = {d: np.concatenate(of) for d, of in errors.items()}
    gain = {d: loss[0] - loss[d] for d in (1, -1)}
    return {
        d: Weighed(_z(gain[d]), _z(gain[d] - gain[-d]), 0.5 * float(np.sum(gain[d]))) for d in gain
    }, fits


def _z(gains: FloatArray) -> float:
    return float(gains.mean() / (gains.std(ddof=1) / np.sqrt(len(gains)) + 1e-12))
