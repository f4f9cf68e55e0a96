"""Least squares of the cascade in whitened bins, and covariances that hold under what is left."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from surae.base.units import ComplexArray, FloatArray
from surae.nerve.cascade import (
    BOUNDS,
    Structure,
    channel,
    muscle,
    muscle_slopes,
    relaxing,
    relaxing_slope,
)
from surae.nerve.piece import Piece

#: Scale of the curvature's regressor [rad].
_BEND = 0.02
#: Length of the blocks whose scores are taken to be independent [s].
BLOCK = 1.0
#: The same of a number [blocks]: the second where the leg, and not only its noise, changes.
JOINED = (1, 5)


@dataclass(frozen=True, slots=True)
class Noise:
    """Power of what is left over the frequency, of bins: common to all pieces."""

    f: FloatArray  #: Frequencies [Hz], shape (n,).
    power: FloatArray  #: [Nm²/s²/Hz], shape (n,).

    def at(self, f: FloatArray) -> FloatArray:
        """The power at frequencies [Hz]."""
        return np.exp(np.interp(np.log(f), np.log(self.f), np.log(self.power)))


def noise_of(
    pieces: Sequence[Piece], residuals: Sequence[ComplexArray], share: float = 1.0
) -> Noise:
    """Smooth periodogram of residuals, over at least 15 bins and a third of an octave.

    `share` of the degrees of freedom is left by what was estimated.
    """
    f = np.concatenate([piece.f for piece in pieces])
    power = np.concatenate([np.abs(each) ** 2 for each in residuals])
    order = np.argsort(f, kind="stable")
    f = f[order]
    power = power[order]
    total = np.concatenate([[0.0], np.cumsum(power)])
    i = np.arange(len(f))
    n = len(f)
    low = np.minimum(np.searchsorted(f, f / 2 ** (1 / 6)), np.maximum(i - 8, 0))
    high = np.maximum(np.searchsorted(f, f * 2 ** (1 / 6)), np.minimum(i + 8, n))
    smooth = (total[high] - total[low]) / (high - low) / share + 1e-300
    f, first = np.unique(f, return_index=True)
    return Noise(f, smooth[first])


def stacked(bins: Sequence[ComplexArray]) -> FloatArray:
    """Bins of pieces, (…, n) each, as real numbers along the last axis."""
    joined = np.concatenate(bins, axis=-1)
    return np.concatenate([joined.real, joined.imag], axis=-1)


def regressors(piece: Piece, structure: Structure, q: Mapping[str, float]) -> ComplexArray:
    """Spectra of the torque per unit of each linear parameter, (k, half)."""
    s = piece.s
    late = _channel(piece.s, structure, q)
    angle = piece.angle * late
    rows = [angle, s * angle, s**2 * angle]
    rows += [relaxing(s, q[f"time_{i + 1}"]) * angle for i in range(structure.branches)]
    rows.append(piece.squared * late / _BEND)
    if structure.trend:
        rows.append(piece.drifting * late)
    if structure.direction:
        law = structure.direction, q.get("threshold", structure.beyond), structure.answered
        delayed = _dynamics(structure, s, q) * late * np.exp(-s * q["delay"])
        rows.append(piece.stretched(*law)[0] * delayed)
    return np.stack(rows)


def _channel(s: ComplexArray, structure: Structure, q: Mapping[str, float]) -> ComplexArray:
    """What the torque's channel does: it is late, and may filter."""
    passed, _ = channel(s, q.get("cutoff", 1.0), structure.order)
    return passed * np.exp(-s * q.get("late", 0.0))


def _dynamics(structure: Structure, s: ComplexArray, q: Mapping[str, float]) -> ComplexArray:
    """Reflex's dynamics: that of a muscle, over 1 + s/p where there is a third pole p."""
    second = muscle(s, q["omega"], q["zeta"])
    return second / (1.0 + s / q["pole"]) if structure.third else second


def slopes(
    piece: Piece, structure: Structure, q: Mapping[str, float], x: ComplexArray
) -> ComplexArray:
    """Spectra of the torque's derivatives by the nonlinear parameters; `x` of `regressors`."""
    s = piece.s
    rows = []
    whole = np.asarray([q[name] for name in structure.linear]) @ x
    for name in structure.nonlinear:
        if name == "late":
            rows.append(-s * whole)
        elif name == "cutoff":
            passed, slope = channel(s, q[name], structure.order)
            rows.append(whole * slope / passed)
        elif name.startswith("time"):
            i = name[-1]
            rows.append(q[f"branch_{i}"] * relaxing_slope(s, q[name]) * x[0])
        elif name == "pole":
            rows.append(q["gain"] * x[-1] * s / q["pole"] / (q["pole"] + s))
        elif name == "delay":
            rows.append(-s * q["gain"] * x[-1])
        elif name == "threshold":
            law = structure.direction, q["threshold"], structure.answered
            _, slope = piece.stretched(*law)
            filtered = _dynamics(structure, s, q) * np.exp(-s * q["delay"])
            filtered = filtered * _channel(s, structure, q)
            rows.append(q["gain"] * slope * filtered)
        else:
            h = muscle(s, q["omega"], q["zeta"])
            (by_omega, by_zeta) = muscle_slopes(s, q["omega"], q["zeta"])
            rows.append(q["gain"] * x[-1] * (by_omega if name == "omega" else by_zeta) / h)
    return np.stack(rows) if rows else np.empty((0, len(s)), complex)


@dataclass(frozen=True, slots=True)
class Fitted:
    """A structure's parameters that describe the torque best."""

    structure: Structure  #: What was fitted.
    values: Mapping[str, float]  #: By the names of the structure.
    loss: float  #: Sum of squares of the whitened residual.
    at_bound: tuple[str, ...]  #: Nonlinear parameters at a bound of their search.

    def prediction(self, piece: Piece) -> ComplexArray:
        """Spectrum of the torque."""
        vector = np.asarray([self.values[name] for name in self.structure.linear])
        return np.asarray(vector @ regressors(piece, self.structure, self.values))

    def residual(self, piece: Piece) -> ComplexArray:
        """Bins of what is left of the torque."""
        return piece.bins(piece.torque - self.prediction(piece))


def _few_rows(e: FloatArray, j: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Qᵀe and R of j = QR, by Cholesky of the scaled normal equations where they are regular."""
    size = np.sqrt(np.einsum("nk,nk->k", j, j)) + 1e-100
    scaled = j / size
    try:
        r = np.linalg.cholesky(scaled.T @ scaled).T
    except np.linalg.LinAlgError:
        q, r = np.linalg.qr(j)
        return q.T @ e, r
    return np.linalg.solve(r.T, scaled.T @ e), r * size


class Problem:
    """Pieces of one recording and the noise that weighs their bins."""

    def __init__(self, pieces: Sequence[Piece], noise: Noise) -> None:
        self.pieces = tuple(pieces)
        self.noise = noise
        self.weights = [noise.at(piece.f) ** -0.5 for piece in pieces]
        self.y = self.whitened([piece.torque for piece in pieces])

    def whitened(self, spectra: Sequence[ComplexArray]) -> FloatArray:
        """Whitened bins as real numbers, of one spectrum, or (k, half), of each piece."""
        return stacked(
            [p.bins(x) * w for p, x, w in zip(self.pieces, spectra, self.weights, strict=True)]
        )

    def linear(self, structure: Structure, q: Mapping[str, float]) -> tuple[FloatArray, FloatArray]:
        """Linear parameters at given others, and the whitened regressors."""
        x = self.whitened([regressors(piece, structure, q) for piece in self.pieces])
        return solved(x, self.y), x

    def jacobian(
        self, structure: Structure, q: Mapping[str, float]
    ) -> tuple[FloatArray, FloatArray]:
        """Whitened residual and its derivatives by all parameters (n, k), sign turned."""
        rows = []
        vector = np.asarray([q[name] for name in structure.linear])
        for piece in self.pieces:
            x = regressors(piece, structure, q)
            rows.append(np.concatenate([slopes(piece, structure, q, x), x]))
        j = self.whitened(rows)
        return self.y - vector @ j[len(structure.nonlinear) :], j.T

    def fit(self, structure: Structure, start: Mapping[str, float]) -> Fitted:
        """Least squares from a start of the nonlinear parameters; more names do no harm."""
        names = structure.names
        low, high = np.array([BOUNDS.get(name, (-np.inf, np.inf)) for name in names]).T
        q = {name: float(start.get(name, START.get(name, 0.0))) for name in structure.nonlinear}
        margin = {name: 1e-3 * (BOUNDS[name][1] - BOUNDS[name][0]) for name in q}
        q = {
            n: float(np.clip(v, BOUNDS[n][0] + margin[n], BOUNDS[n][1] - margin[n]))
            for n, v in q.items()
        }
        first, _ = self.linear(structure, q)
        x0 = np.concatenate([list(q.values()), first])
        kinds = len(q)
        x0[kinds:] = np.clip(x0[kinds:], low[kinds:] + 1e-3, None)
        state: dict[bytes, tuple[FloatArray, FloatArray]] = {}

        def at(x: FloatArray) -> tuple[FloatArray, FloatArray]:
            if (key := x.tobytes()) not in state:
                state.clear()
                e, j = self.jacobian(structure, dict(zip(names, x, strict=True)))
                # the same squares and steps from few rows: what j cannot reach is one number
                reached, r = _few_rows(e, j)
                rest = np.sqrt(max(float(e @ e - reached @ reached), 0.0))
                state[key] = np.append(reached, rest), np.vstack([r, np.zeros(len(x))])
            return state[key]

        solution = least_squares(
            lambda x: at(x)[0],
            x0,
            jac=lambda x: -at(x)[1],
            bounds=(low, high),
            x_scale="jac",
            ftol=3e-6,
            xtol=1e-6,
            gtol=1e-9,
            max_nfev=40,
        )
        values = dict(zip(names, map(float, solution.x), strict=True))
        ends = tuple(
            n
            for n in structure.nonlinear
            if min(values[n] - BOUNDS[n][0], BOUNDS[n][1] - values[n]) < margin[n]
        )
        return Fitted(structure, values, 2.0 * float(solution.cost), ends)

    def covariance(self, fitted: Fitted) -> tuple[FloatArray, int, list[FloatArray]]:
        """Covariance of all parameters, the degrees of freedom of the blocks behind it, their pull.

        The larger of the model's and of a sandwich over blocks of time, by parameter, with the
        model's correlations: what is left need be neither white nor the same all the time. The
        pull is by how much each block moves the parameters, (blocks, k) for each of `JOINED`.
        """
        e, j = self.jacobian(fitted.structure, fitted.values)
        (n, k) = j.shape
        size = np.sqrt(np.sum(j**2, axis=0)) + 1e-100
        inverse = np.linalg.pinv((j / size).T @ (j / size), rcond=1e-12) / np.outer(size, size)
        model = inverse * float(e @ e) / (n - k)
        of_pieces = self.blocks(e, j)
        scores = np.concatenate(of_pieces)
        m = len(scores)
        pulls = []
        for n in JOINED:
            sums = [s[: len(s) // n * n].reshape(-1, n, k).sum(axis=1) for s in of_pieces]
            pulls.append(np.concatenate(sums) @ inverse)
        sandwich = inverse @ (scores.T @ scores) @ inverse * m / max(m - k, 1)
        wider = np.sqrt(np.maximum(np.diag(sandwich) / (np.diag(model) + 1e-300), 1.0))
        return model * np.outer(wider, wider), max(m - k, 5), pulls

    def blocks(self, e: FloatArray, j: FloatArray) -> list[FloatArray]:
        """Scores Jᵀe of each block of time, (blocks, k) of each piece."""
        half = len(e) // 2
        first = 0
        summed = []
        for piece in self.pieces:
            rows = slice(first, first + len(piece.f))
            first = rows.stop
            series = [
                piece.in_time(v[..., :half][..., rows] + 1j * v[..., half:][..., rows])
                for v in (e, j.T)
            ]
            scores = series[0] * series[1]
            length = round(BLOCK * piece.rate)
            count = max(scores.shape[1] // length, 1)
            cut = scores[:, : count * length].reshape(len(scores), count, -1)
            summed.append(cut.sum(axis=2).T)
        return summed


#: Where the search of the nonlinear parameters begins, where nothing better is known.
START = {
    "late": 0.0,
    "cutoff": 60.0,
    "time_1": 0.03,
    "time_2": 0.3,
    "delay": 0.045,
    "omega": 20.0,
    "zeta": 0.8,
    "pole": 60.0,
    "threshold": 0.03,
}


def solved(x: FloatArray, y: FloatArray, ridge: float = 1e-10) -> FloatArray:
    """Least squares of y on the rows of x, however their sizes differ, drawn to 0 by `ridge`."""
    size = np.sqrt(np.sum(x**2, axis=1)) + 1e-100
    unit = x / size[:, None]
    normal = unit @ unit.T
    normal[np.diag_indices_from(normal)] += ridge
    return np.asarray(np.linalg.solve(normal, unit @ y) / size)
