"""Kernels of short columns: many derivatives, each of few samples, as a band and its border."""

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.jit import jit


@jit
def band_products(columns: FloatArray, first: IntArray, band: FloatArray) -> None:
    """Products of columns, (k, l) each from its first sample on, into a lower band (b + 1, k)."""
    k, size = columns.shape
    for j in range(k):
        for d in range(band.shape[0]):
            if j + d >= k:
                break
            shift = first[j + d] - first[j]
            total = 0.0
            for t in range(size - shift):
                total += columns[j, t + shift] * columns[j + d, t]
            band[d, j] += total


@jit
def border_products(
    columns: FloatArray, first: IntArray, rows: FloatArray, out: FloatArray
) -> None:
    """Products of short columns, (k, l), with long ones, (n, p), are added to (k, p)."""
    n, p = rows.shape
    for j in range(len(first)):
        for t in range(columns.shape[1]):
            i = first[j] + t
            if i >= n:
                break
            value = columns[j, t]
            for a in range(p):
                out[j, a] += value * rows[i, a]


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
    k, d = right.shape
    x = right.copy()
    for j in range(k - 1, -1, -1):
        for s in range(1, min(band.shape[1], k - j)):
            for a in range(d):
                x[j, a] -= band[j, s] * x[j + s, a]
        for a in range(d):
            x[j, a] /= band[j, 0]
    return x


@jit
def solve_band(band: FloatArray, right: FloatArray) -> FloatArray:
    """X of L·X = right; LAPACK takes one column after the other, and twice as long."""
    k, d = right.shape
    x = right.copy()
    for j in range(k):
        for a in range(d):
            x[j, a] /= band[j, 0]
        for s in range(1, min(band.shape[1], k - j)):
            for a in range(d):
                x[j + s, a] -= band[j, s] * x[j, a]
    return x
