"""Kernels of short columns: many derivatives, each of few samples, as a band and its border."""

from functools import partial

import numpy as np

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.jit import jit


@partial(jit, fastmath={"reassoc"})  # sums in any order are vectorised
def band_products(columns: FloatArray, first: IntArray, band: FloatArray) -> None:
    """Products of columns, (k, l) each from its first sample on, into a lower band (b + 1, k)."""
    k, size = columns.shape
    for j in range(k):
        for d in range(min(band.shape[0], k - j)):
            shift = min(first[j + d] - first[j], size)
            own, other = columns[j, shift:], columns[j + d]
            total = 0.0
            for t in range(len(own)):
                total += own[t] * other[t]
            band[d, j] += total


@jit
def border_products(columns: FloatArray, first: IntArray, rows: FloatArray) -> FloatArray:
    """Products of short columns, (k, l), with long ones, (n, p), shape (k, p)."""
    out = np.empty((len(first), rows.shape[1]))
    for j in range(len(first)):
        own = rows[first[j] : first[j] + columns.shape[1]]
        out[j] = columns[j, : len(own)] @ own
    return out


@jit
def lifted(columns: FloatArray, first: IntArray, heights: FloatArray, out: FloatArray) -> None:
    """Sums of short columns, (k, l), times heights, (k, d), into (n, d)."""
    n, d = out.shape
    for j in range(len(first)):
        for t in range(columns.shape[1]):
            i = first[j] + t
            if i >= n:
                break
            for a in range(d):
                out[i, a] += columns[j, t] * heights[j, a]


@jit
def solve_band_transposed(band: FloatArray, right: FloatArray) -> FloatArray:
    """X of Lᵀ·X = right, L a lower band by columns (k, b + 1), right (k, d)."""
    k, x = len(right), right.copy()
    for j in range(k - 1, -1, -1):
        after = x[j + 1 : j + band.shape[1]]
        x[j] = (x[j] - band[j, 1 : len(after) + 1] @ after) / band[j, 0]
    return x


@jit
def solve_band(band: FloatArray, right: FloatArray) -> FloatArray:
    """X of L·X = right; LAPACK takes one column after the other, and twice as long."""
    x, row = right.copy(), np.empty(band.shape[1] - 1)
    for j in range(len(right)):
        m = min(len(row), j)
        for t in range(m):
            row[t] = band[j - m + t, m - t]
        x[j] = (x[j] - row[:m] @ x[j - m : j]) / band[j, 0]
    return x
