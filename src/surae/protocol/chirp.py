"""The added chirp, and how a profile makes room for it inside the range of motion.

The thesis's chirp is A·sin(s·t²), s its "frequency scale factor" (2.5.1): its frequency is s·t/π
and rises by s/π Hz/s. The thesis adds it to the basic profile (Figures 7 and 8) and doesn't say
what happens at the ends of the range. A leg must never be moved beyond its range of motion, so the
basic profile is mapped on a narrower range, chosen so that profile + chirp just reaches both ends.
"""

import numpy as np

from surae.units import FloatArray

#: Rise of the frequency [Hz/s] where none is given: that of the thesis's factor 0.5, rounded.
DEFAULT_RATE = 0.159


def chirp_rate(factor: float) -> float:
    """Rise of the frequency [Hz/s] of a chirp A·sin(factor·t²), factor in rad/s²."""
    return factor / np.pi


def chirp(
    t: FloatArray, *, amplitude: float, rate: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Chirp A·sin(π·r·t²), of instantaneous frequency r·t, and its derivatives.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Times since the start [s].
    amplitude : float
        A [rad].
    rate : float
        r, the rise of the frequency [Hz/s]; `chirp_rate` gives it for a factor of the thesis.

    Returns
    -------
    angle, velocity, acceleration : ndarray, shape (n,)
        [rad, rad/s, rad/s²].
    """
    phase = np.pi * rate * t**2
    phase_speed = 2 * np.pi * rate * t
    angle = amplitude * np.sin(phase)
    velocity = amplitude * phase_speed * np.cos(phase)
    acceleration = amplitude * (2 * np.pi * rate * np.cos(phase) - phase_speed**2 * np.sin(phase))
    return angle, velocity, acceleration


def base_range(
    fraction: FloatArray, added: FloatArray, range_of_motion: tuple[float, float]
) -> tuple[float, float]:
    """Range on which the profile is mapped so that profile + chirp spans the range of motion.

    `fraction` is the profile, 0…1, `added` the chirp [rad], smaller than half the range. Low and
    high are angles [rad] such that low + (high − low)·fraction + added has the extremes
    `range_of_motion`, to 1e-12 rad.
    """
    plantarflexed, dorsiflexed = range_of_motion
    amplitude = float(np.abs(added).max())
    # From the range that is safe whatever the phases, each end is moved out by the room that is
    # left. That room shrinks at every step: the sum follows `high` where the profile is near 1.
    low, high = plantarflexed + amplitude, dorsiflexed - amplitude
    for _ in range(200):
        total = low + (high - low) * fraction + added
        above, below = dorsiflexed - float(total.max()), float(total.min()) - plantarflexed
        high, low = high + above, low - below
        if max(abs(above), abs(below)) < 1e-13:
            break
    return low, high
