"""Times of samples that follow each other at one rate."""

import numpy as np

from surae.recording.recording import freeze
from surae.units import FloatArray


def instants(start_s: float, rate_hz: float, n: int) -> FloatArray:
    """Read-only times [s] of `n` samples at `rate_hz`, the first at `start_s`."""
    return freeze(start_s + np.arange(n, dtype=np.float64) / rate_hz)
