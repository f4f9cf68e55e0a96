"""Blocks of a residual, drawn again and again: noise as correlated as the residual is."""

import math

import numpy as np

from surae.assessment.residual.whiteness import autocovariance
from surae.units import FloatArray


def block_length(residual: FloatArray) -> int:
    """Length of the blocks that gives a mean its most precise standard error.

    Politis and White (2004) with the correction of Patton, Politis and White (2009), for circular
    blocks: (2G²/D)^⅓·n^⅓ from the autocovariance R under a flat-top window, G = Σ|k|R(k) and
    D = 4/3·(ΣR)².

    At least 1, at most 3√n.
    """
    n = len(residual)
    centred = residual - residual.mean()
    sums, _ = autocovariance(centred, np.ones(n, dtype=bool), n - 1)
    if not sums[0] > 0:
        return 1
    rho = sums / sums[0]
    limit = 2.0 * math.sqrt(math.log10(max(n, 10)) / n)
    small = np.abs(rho[1:]) < limit
    run = max(5, math.ceil(math.sqrt(math.log10(max(n, 10)))))
    # The first of `run` lags in a row that are all small.
    together = np.convolve(small, np.ones(run), "valid") >= run
    first = int(np.argmax(together)) if together.any() else n // 2
    reach = min(2 * max(first, 1), n - 1)
    lags = np.arange(-reach, reach + 1)
    window = np.clip(2.0 * (1.0 - np.abs(lags) / reach), 0.0, 1.0)
    R = sums[np.abs(lags)] / n
    G, g0 = float(np.sum(window * np.abs(lags) * R)), float(np.sum(window * R))
    most = max(1, math.ceil(3 * math.sqrt(n)))
    if g0 <= 0:
        return most
    length = (2.0 * G * G / (4.0 / 3.0 * g0 * g0)) ** (1 / 3) * n ** (1 / 3)
    return int(min(max(round(length), 1), most))


def draw_blocks(residual: FloatArray, length: int, rng: np.random.Generator) -> FloatArray:
    """Draw as many samples as there are, from blocks that begin anywhere and go on past the end."""
    n = len(residual)
    starts = rng.integers(n, size=math.ceil(n / length))
    index = (starts[:, None] + np.arange(length)) % n
    return np.asarray(residual[index.ravel()[:n]])
