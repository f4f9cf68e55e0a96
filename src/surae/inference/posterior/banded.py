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
            column = columns[j, shift:]
            other = columns[j + d]
            total = 0.0
            for t in range(len(column)):
                total += column[t] * other[t]
            band[d, j] += total


@jit
def _fill(columns: FloatArray, first: IntArray, blocks: FloatArray) -> None:
    """Short columns in blocks, (blocks, 16, …), each from the first sample of its first column."""
    for j in range(len(first)):
        block = j // _BLOCK
        shift = first[j] - first[block * _BLOCK]
        for t in range(columns.shape[1]):
            blocks[block, j % _BLOCK, shift + t] = columns[j, t]


def border_products(columns: FloatArray, first: IntArray, rows: FloatArray) -> FloatArray:
    """Products of short columns, (k, l), with long ones, (n, p), shape (k, p)."""
    out = np.empty((len(first), rows.shape[1]))
    starts = first[::_BLOCK]
    wide = int((np.append(starts[1:], first[-1]) - starts).max()) + columns.shape[1]
    blocks = np.zeros((len(starts), _BLOCK, wide))
    _fill(columns, first, blocks)
    for i, (block, start) in enumerate(zip(blocks, starts.tolist(), strict=True)):
        products = out[i * _BLOCK : (i + 1) * _BLOCK]
        there = rows[start : start + wide]
        np.matmul(block[: len(products), : len(there)], there, out=products)
    return out


@jit
def lifted(columns: FloatArray, first: IntArray, heights: FloatArray, out: FloatArray) -> None:
    """Sums of short columns, (k, l), times heights, (k, d), into (n, d)."""
    for j in range(len(first)):
        for t in range(min(columns.shape[1], len(out) - first[j])):
            for c in range(out.shape[1]):
                out[first[j] + t, c] += columns[j, t] * heights[j, c]


def solve_band_transposed(band: FloatArray, right: FloatArray) -> FloatArray:
    """X of Lᵀ·X = right, L a lower band by columns (k, b + 1), right (k, d)."""
    if right.shape[1] == 1:
        return np.asarray(dtbtrs(band.T, right, uplo="L", trans="T")[0])
    turned = np.zeros_like(band)
    k = len(band)
    for d in range(min(band.shape[1], k)):  # from its end on it is a lower band again
        turned[: k - d, d] = band[: k - d, d][::-1]
    return solve_band(turned, right[::-1].copy())[::-1].copy()


@jit
def _invert(band: FloatArray, blocks: FloatArray) -> None:
    """What the rows of each block are of those before and of their own right sides."""
    k, wide = band.shape
    for begin in range(0, k, _BLOCK):
        end = min(begin + _BLOCK, k)
        start = max(begin - wide + 1, 0)
        block = blocks[begin // _BLOCK]
        for i in range(begin, end):
            row = block[i - begin]
            row[i - start] = 1.0
            for j in range(max(i - wide + 1, 0), min(begin, i)):
                row[j - start] = -band[j, i - j]
            for j in range(max(i - wide + 1, begin), i):
                before = block[j - begin]
                for t in range(j - start + 1):
                    row[t] -= band[j, i - j] * before[t]
            for t in range(end - start):
                row[t] /= band[i, 0]


def solve_band(band: FloatArray, right: FloatArray) -> FloatArray:
    """X of L·X = right; LAPACK takes one column after the other, and thrice as long."""
    (k, wide) = band.shape
    x = right.copy()
    blocks = np.zeros((-(-k // _BLOCK), _BLOCK, _BLOCK + wide - 1))
    _invert(band, blocks)
    for begin, block in zip(range(0, k, _BLOCK), blocks, strict=True):
        end = min(begin + _BLOCK, k)
        start = max(begin - wide + 1, 0)
        x[begin:end] = block[: end - begin, : end - start] @ x[start:end]
    return x
