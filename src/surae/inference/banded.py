"""Kernels of short columns: many derivatives, each of few samples, as a band and its border."""

from functools import partial

import numpy as np
from scipy.linalg.lapack import dtbtrs

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.jit import inner, jit

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


@inner
def _together(columns: FloatArray, first: IntArray, begin: int, n: int) -> FloatArray:
    """Short columns, in order, from one on, all from its first sample on, shape (16, …)."""
    end, start, size = min(begin + _BLOCK, len(first)), first[begin], columns.shape[1]
    block = np.zeros((end - begin, min(first[end - 1] + size, n) - start))
    for j in range(begin, end):
        own = block[j - begin, first[j] - start :]
        own[:size] = columns[j, : len(own)]
    return block


@jit
def border_products(columns: FloatArray, first: IntArray, rows: FloatArray) -> FloatArray:
    """Products of short columns, (k, l), with long ones, (n, p), shape (k, p)."""
    out = np.empty((len(first), rows.shape[1]))
    for j in range(0, len(first), _BLOCK):
        block = _together(columns, first, j, len(rows))
        out[j : j + len(block)] = block @ rows[first[j] : first[j] + block.shape[1]]
    return out


@jit
def lifted(columns: FloatArray, first: IntArray, heights: FloatArray, out: FloatArray) -> None:
    """Sums of short columns, (k, l), times heights, (k, d), into (n, d)."""
    for j in range(0, len(first), _BLOCK):
        block = _together(columns, first, j, len(out))
        out[first[j] : first[j] + block.shape[1]] += block.T @ heights[j : j + len(block)]


def solve_band_transposed(band: FloatArray, right: FloatArray) -> FloatArray:
    """X of Lᵀ·X = right, L a lower band by columns (k, b + 1), right (k, d)."""
    if right.shape[1] == 1:
        return np.asarray(dtbtrs(band.T, right, uplo="L", trans="T")[0])
    turned, k = np.zeros_like(band), len(band)
    for d in range(min(band.shape[1], k)):  # from its end on it is a lower band again
        turned[: k - d, d] = band[: k - d, d][::-1]
    return solve_band(turned, right[::-1].copy())[::-1].copy()


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
