"""How a systematic error moves all estimates together.

Rows of shifts, one for each way in which it may go, whose outer products add up to its covariance:
a wrong stiffness comes with the slack length that makes up for it, and what both make stays known.
"""

import numpy as np

from surae.units import FloatArray


def sized(shifts: FloatArray, deviations: FloatArray) -> FloatArray:
    """Shifts in these directions, shape (r, q), of these standard deviations, shape (q,)."""
    own = np.sqrt(np.sum(shifts**2, axis=0))
    return np.asarray(shifts * np.where(own > 0.0, deviations / np.where(own > 0.0, own, 1.0), 0.0))


def along(deviations: FloatArray, covariance: FloatArray) -> FloatArray:
    """Shifts of these standard deviations along the valleys of a covariance, shape (q, q)."""
    return sized(root(covariance), deviations)


def root(covariance: FloatArray) -> FloatArray:
    """Shifts whose outer products add up to a covariance, shape (q, q)."""
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
    return np.asarray((vectors * np.sqrt(np.maximum(values, 0.0))).T)
