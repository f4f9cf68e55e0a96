"""The cascade without equations: impulse responses of both paths, what they predict, coherence."""

from collections.abc import Sequence

import numpy as np

from surae.base.units import ComplexArray, FloatArray
from surae.nerve.fitting import Noise, noise_of, solved, stacked
from surae.nerve.piece import SLOW, Piece

#: Half width of the intrinsic response [s] (Kearney 1997: two-sided, ± 40 ms).
WIDTH = 0.04
#: What keeps responses from what the movement does not excite, a part of each lag's power.
_RIDGE = 1e-5
#: First and last lag of the reflex's response [s]: a soleus's twitch has ended by then.
FIRST = 0.04
LAST = 0.6


def lags(rate: float, reflex: bool) -> FloatArray:
    """Lags of a response [s] at a rate [Hz]."""
    if reflex:
        return np.arange(np.ceil(FIRST * rate), np.floor(LAST * rate) + 1) / rate
    most = np.floor(WIDTH * rate)
    return np.arange(-most, most + 1) / rate


def lagged(piece: Piece, direction: int, rate: float, threshold: float = 0.0) -> ComplexArray:
    """Spectra of the angle, and of velocity in one direction beyond a threshold, at every lag.

    Shape (k, half). Pieces of one recording have a common `rate` [Hz] of lags.
    """
    rows = [piece.angle * np.exp(-np.outer(lags(rate, False), piece.s))]
    if direction:
        velocity, _ = piece.stretched(direction, threshold)
        rows.append(velocity * np.exp(-np.outer(lags(rate, True), piece.s)))
    return np.concatenate(rows)


def free_noise(pieces: Sequence[Piece]) -> Noise:
    """Noise of the torque that no linear response to the movement explains, either direction."""
    noise = noise_of(pieces, [piece.bins(piece.torque) for piece in pieces])
    rate = pieces[0].rate
    bins = {
        d: [p.bins(np.concatenate([lagged(p, d, rate), p.squared[None]])) for p in pieces]
        for d in (1, -1)
    }
    bins_of_torque = [piece.bins(piece.torque) for piece in pieces]
    for _ in range(2):
        left = {}
        for direction, of in bins.items():
            w = [noise.at(p.f) ** -0.5 for p in pieces]
            x = stacked([b * k for b, k in zip(of, w, strict=True)])
            y = stacked([b * k for b, k in zip(bins_of_torque, w, strict=True)])
            c = solved(x, y)
            e = y - c @ x
            left[direction] = float(e @ e), c, 1.0 - len(c) / len(y)
        best = min(left, key=lambda d: left[d][0])
        _, c, share = left[best]
        noise = noise_of(
            pieces, [b - c @ x for b, x in zip(bins_of_torque, bins[best], strict=True)], share
        )
    return noise


def responses(
    pieces: Sequence[Piece], direction: int, threshold: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Least squares of the torque itself, as others give it: responses of both paths.

    Intrinsic [Nm/rad per lag], shape (k,); reflex [Nm·s/rad per lag], empty without a direction.
    """
    x = np.concatenate(
        [_centred(p.signals(lagged(p, direction, pieces[0].rate, threshold))) for p in pieces],
        axis=1,
    )
    y = np.concatenate([_centred(p.signals(p.torque)) for p in pieces])
    c = solved(x, y, _RIDGE)
    k = len(lags(pieces[0].rate, False))
    return c[:k], c[k:]


def predicted(pieces: Sequence[Piece], fitted: Sequence[Piece], direction: int) -> float:
    """VAF [%] of the torque of pieces by responses of others, or of the same."""
    c = np.concatenate(responses(fitted, direction))
    left = total = 0.0
    for p in pieces:
        y = _centred(p.signals(p.torque))
        e = y - c @ _centred(p.signals(lagged(p, direction, fitted[0].rate)))
        left = left + float(np.var(e)) * len(e)
        total = total + float(np.var(y)) * len(y)
    return 100.0 * (1.0 - left / total)


def _centred(signals: FloatArray) -> FloatArray:
    centred: FloatArray = signals - signals.mean(axis=-1, keepdims=True)
    return centred


def faster(piece: Piece, spectra: ComplexArray) -> FloatArray:
    """Signals in time without what is slower than `SLOW`."""
    return piece.signals(spectra * (np.abs(piece.s) >= 2.0 * np.pi * SLOW))


def falls_short(pieces: Sequence[Piece], predicted: Sequence[ComplexArray]) -> float:
    """By how much torque stays behind where what is told of it is at an end, in its deviations.

    The mean over the last 2 % at either end, the larger: a channel at its limit gives no more.
    What is slower than `SLOW` wanders by itself.
    """
    y = np.concatenate([faster(p, p.torque) for p in pieces])
    x = np.concatenate([faster(p, each) for p, each in zip(pieces, predicted, strict=True)])
    ends = [(s, s * x > np.quantile(s * x, 0.98)) for s in (1.0, -1.0)]
    return float(max(np.mean(s * (x - y)[end]) for s, end in ends) / (np.std(y) + 1e-12))
