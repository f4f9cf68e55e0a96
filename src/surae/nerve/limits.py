"""A torque that was limited for moments, or limited and then filtered.

A channel at its limit repeats one value, and what lasts is left out (`samples.limited`). Peaks of
inertia are too short for that, but many of them end at one value. A filter behind a limit rounds
that off. Then it shows where the torque of the equations goes on and the recorded one does
not: what they make beyond a level, taken off, describes the torque better, by about all of it.
"""

import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.nerve.fitting import Fitted, Problem, solved, stacked
from surae.nerve.piece import SLOW, Piece
from surae.nerve.samples import runs

#: Samples in peaks at one largest value that are too short to be left out [samples, each], from so
#: many of which on it is a limit, and by how many times they are more than those of the next value.
SHORT = 4
MANY = 8
TIMES = 3.0
#: Digits of a recorder, as a part of the range, that make values equal by themselves.
DIGITS = 2e-3
#: Parts of the time that the torque may be at a limit, one after the other.
PARTS = (0.005, 0.01, 0.02, 0.04)
#: The z of what is beyond a limit from which there is one; and where the torque jumps between
#: samples: peaks at unknown times look like a limit (of two clean legs that were called so, at most
#: 7.7).
CLEAR = 5.0
CLEAR_OF_JUMPS = 9.0
#: The least part of what is beyond that is gone: all of it where the level is right.
GONE = 0.6
#: Rounds in which the torque beyond is made up by what is estimated of the leg.
ROUNDS = 4


@dataclass(frozen=True, slots=True)
class TorqueLimit:
    """A limit of the torque, as what is seen of it says."""

    sign: int  #: 1 of the largest torque, −1 of the smallest.
    level: float  #: The limit [Nm], times the sign, without the torque's mean.


def repeats_its_largest(torque: FloatArray) -> bool:
    """Whether many short peaks of a torque, shape (n,), end at one value, up or down."""
    values = np.unique(torque[np.isfinite(torque)])
    if len(values) < MANY or np.min(np.diff(values)) > DIGITS * (values[-1] - values[0]):
        return False

    def repeats(top: float, next_to_it: float) -> bool:
        lengths = [run.stop - run.start for run in runs(torque == top)]
        short = sum(length for length in lengths if length < SHORT)
        return bool(short >= MANY and short > TIMES * np.count_nonzero(torque == next_to_it))

    return repeats(values[-1], values[-2]) or repeats(values[0], values[1])


def limits_of(problem: Problem, fitted: Fitted) -> tuple[TorqueLimit, ...]:
    """Limits that the torque of a fit shows, none where it shows none."""
    residual, jacobian = problem.jacobian(fitted.structure, fitted.values)
    rows = jacobian.T
    return tuple(end for sign in (1, -1) for end in _limit(problem, fitted, sign, residual, rows))


def restored(
    problem: Problem, fitted: Fitted, ends: Sequence[TorqueLimit]
) -> tuple[Problem, Fitted]:
    """The torque with what the leg made beyond its limits, and its fit, made up by turns."""
    again = problem
    for _ in range(ROUNDS):
        pieces = []
        for piece in problem.pieces:
            more = copy.copy(piece)
            more.torque = piece.torque + sum(
                np.fft.rfft(_beyond(piece, fitted, end)) for end in ends
            )
            pieces.append(more)
        again = Problem(pieces, problem.noise)
        fitted = again.fit(fitted.structure, fitted.values)
    return again, fitted


def _limit(
    problem: Problem, fitted: Fitted, sign: int, residual: FloatArray, rows: FloatArray
) -> Iterator[TorqueLimit]:
    """The limit at one end that describes the torque best, if one does clearly."""
    torque = np.concatenate([sign * piece.signals(piece.torque) for piece in problem.pieces])
    jumps = any(np.any(piece.jumps) for piece in problem.pieces)
    best = CLEAR_OF_JUMPS if jumps else CLEAR
    likeliest = None
    for part in PARTS:
        end = TorqueLimit(sign, float(np.quantile(torque, 1.0 - part)))
        missing = -_whitened(problem, [_beyond(p, fitted, end) for p in problem.pieces])
        if not np.any(missing):
            continue
        z, size = _weighed(np.vstack([rows, missing]), residual)
        if z > best and size > GONE:
            best = z
            likeliest = end
    if likeliest is not None:
        yield likeliest


def _weighed(rows: FloatArray, residual: FloatArray) -> tuple[float, float]:
    """The last row's coefficient in least squares of a residual: its z, and itself."""
    coefficients = solved(rows, residual)
    left = residual - coefficients @ rows
    size = np.sqrt(np.sum(rows**2, axis=1)) + 1e-100
    unit = rows / size[:, None]
    variance = np.linalg.pinv(unit @ unit.T, rcond=1e-12)[-1, -1] * float(left @ left)
    sd = np.sqrt(variance / (len(residual) - len(rows))) / size[-1]
    return float(coefficients[-1] / (sd + 1e-300)), float(coefficients[-1])


def _beyond(piece: Piece, fitted: Fitted, end: TorqueLimit) -> FloatArray:
    """Torque beyond a limit as the equations make it, shape (m,) [Nm], signed.

    What is slower than `SLOW` is the recorded: it wanders by itself.
    """
    slow = np.abs(piece.s) < 2.0 * np.pi * SLOW
    whole = np.fft.irfft(np.where(slow, piece.torque, fitted.prediction(piece)), piece.m)
    beyond: FloatArray = end.sign * np.maximum(end.sign * whole - end.level, 0.0)
    return beyond


def _whitened(problem: Problem, signals: Sequence[FloatArray]) -> FloatArray:
    """Whitened bins of a signal of each piece, shape (m,)."""
    spectra = (np.fft.rfft(signal) for signal in signals)
    return stacked(
        [
            piece.bins(spectrum) * weight
            for piece, spectrum, weight in zip(
                problem.pieces, spectra, problem.weights, strict=True
            )
        ]
    )
