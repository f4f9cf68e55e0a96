"""Kernels of short columns: many derivatives, each of few samples, as a band and its border."""

from functools import partial

import numpy as np
from scipy.linalg.lapack import dtbtrs

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.jit import jit

#: Columns or rows that are taken together.
_BLOCK = 16


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
    """Products of short columns, (k, l), in order, with long ones, (n, p), shape (k, p)."""
    (k, size), n = columns.shape, len(rows)
    out = np.empty((k, rows.shape[1]))
    for begin in range(0, k, _BLOCK):
        end, start = min(begin + _BLOCK, k), first[begin]
        block = np.zeros((end - begin, min(first[end - 1] + size, n) - start))
        for j in range(begin, end):
            own = block[j - begin, first[j] - start :]
            own[:size] = columns[j, : len(own)]
        out[begin:end] = block @ rows[start : start + block.shape[1]]
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


def solve_band_transposed(band: FloatArray, right: FloatArray) -> FloatArray:
    """X of Lᵀ·X = right, L a lower band by columns (k, b + 1), right (k, d)."""
    return np.asarray(dtbtrs(band.T, right, uplo="L", trans="T")[0])


@jit
def solve_band(band: FloatArray, right: FloatArray) -> FloatArray:
    """X of L·X = right; LAPACK takes one column after the other, and thrice as long."""
    (k, wide), x = band.shape, right.copy()
    for begin in range(0, k, _BLOCK):
        end, start = min(begin + _BLOCK, k), max(begin - wide + 1, 0)
        # what these rows are of those before and of their own right sides
        block = np.zeros((end - begin, end - start))
        for i in range(begin, end):
            own = block[i - begin]
            own[i - start] = 1.0
            for j in range(max(i - wide + 1, 0), min(begin, i)):
                own[j - start] = -band[j, i - j]
            for j in range(max(i - wide + 1, begin), i):
                before = block[j - begin]
                for t in range(j - start + 1):
                    own[t] -= band[j, i - j] * before[t]
            own /= band[i, 0]
        x[begin:end] = block @ x[start:end]
    return x
