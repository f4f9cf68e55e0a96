"""Signals that no model made."""

import numpy as np


def signals(n: int = 3000, rate_hz: float = 500.0) -> tuple[np.ndarray, np.ndarray]:
    """An angle and envelopes that no model made."""
    rng = np.random.default_rng(5)
    t = np.arange(n) / rate_hz
    angle = 0.25 * np.sin(2 * np.pi * 0.6 * t) + 0.1 * np.sin(2 * np.pi * 1.7 * t) - 0.1
    effort = 1.0 + np.sin(2 * np.pi * 0.4 * t[:, None] + np.arange(4))
    return angle, np.abs(rng.normal(size=(n, 4))) * 2e-4 * effort
