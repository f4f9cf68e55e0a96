"""Correlated noise: an autoregression of the first order with white noise on it, ARMA(1,1)."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.signal import lfilter

from surae.base.units import FloatArray

#: Correlations from block to block that are tried, and for each the part of the noise that is
#: white, by its moving average: 0 is an autoregression alone. Chosen by the evidence.
AUTOREGRESSIONS = (0.1, 0.4, 0.6, 0.8, 0.9, 0.97)
MOVING = (0.9, 0.7, 0.4, 0.0)


def whitened(columns: FloatArray, cuts: Sequence[int], ar: float, ma: float) -> FloatArray:
    """Columns (n, k) as noise that is nₜ = ar·nₜ₋₁ + eₜ + ma·eₜ₋₁ becomes white.

    Each piece between `cuts` begins anew, its first sample in its stationary size.

    Box, Jenkins, Reinsel and Ljung, Time Series Analysis (2015), chapter 7.
    """
    white = np.empty_like(columns)
    start = np.sqrt(variance(ar, ma))
    for first, last in pairwise(cuts):
        piece = lfilter([1.0, -ar], [1.0, ma], columns[first:last], axis=0)
        piece[0] = columns[first] / start
        white[first:last] = piece
    return white


def variance(ar: float, ma: float) -> float:
    """Variance of the noise over that of its innovations."""
    return (1.0 + 2.0 * ar * ma + ma * ma) / (1.0 - ar * ar)
