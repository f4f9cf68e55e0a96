"""Steps of a position's sensor, also where it was smoothed since."""

import numpy as np

from surae.base.units import FloatArray
from surae.base.words import N_, Message

#: Step of an encoder as a part of the position's standard deviation, from which it is named.
COARSE = 0.1
#: Time in which a position that stands is looked at [s], and the part of its range by which it
#: changes then; and the part by which one between steps changes, in a part of these times at
#: least: noise of sensors that are not coarse is larger.
STANDS = 0.02
STILL = 1e-3
EXACT = 1e-5
OF_THEM = 0.05
#: Part of the range by which levels differ at least, and how many make a lattice: a device that is
#: told three positions has three levels.
APART = 0.02
LEVELS = 5
#: Part of the time in which a position stands, from which it is said: few levels do not show the
#: size of its steps.
MOSTLY = 0.3
#: Steps of a position as it was recorded are at least such a part of its range.
SEEN = 1e-4
#: How far from a lattice its levels may lie, in parts of its step.
OFF = 0.04


def steps_of(angle: FloatArray, rate_hz: float) -> tuple[float, Message | None]:
    """The step of a position that is coarse [rad], and what to know of it.

    It is 0 where none is seen, NaN where there is one whose size does not show. As recorded, most
    samples repeat the one before. Smoothed, the position stands between movements without noise,
    and all levels at which it does lie on one lattice.
    """
    changes = np.abs(np.diff(angle))
    moving = changes[changes > 1e-9]
    step = float(np.quantile(moving, 0.05)) if len(moving) else 0.0
    least = COARSE * float(np.std(angle))
    if len(moving) < 0.9 * len(changes) and step > least:
        text = N_(
            "The position comes in steps of {step:.2g}°, coarse beside its "
            "movement: use a finer encoder or larger perturbations."
        )
        return step, Message(text, step=np.rad2deg(step))
    extent, ranges, means = _windows(angle, rate_hz)
    still = ranges < STILL * extent
    exact = ranges < EXACT * extent
    levels = _levels(means[still], extent)
    was = lattice(levels)
    if was > least and exact.sum() > OF_THEM * still.sum():
        text = N_(
            "The position came in steps of {step:.2g}°, coarse beside its movement, before it "
            "was smoothed: use a finer encoder or larger perturbations."
        )
        return was, Message(text, step=np.rad2deg(was))
    if np.mean(exact) > MOSTLY and step < SEEN * extent and len(levels) < LEVELS:
        text = N_(
            "The position stands exactly still between movements: it came in steps and was "
            "smoothed, or is not a measured one. The steps’ size does not show, so that numbers "
            "are less sure: give the position as it was recorded."
        )
        return np.nan, Message(text)
    return 0.0, None


def _windows(angle: FloatArray, rate_hz: float) -> tuple[float, FloatArray, FloatArray]:
    """Range of a position [rad], and range and mean of every `STANDS` of it."""
    size = max(round(STANDS * rate_hz), 4)
    windows = angle[: len(angle) // size * size].reshape(-1, size)
    extent = float(np.ptp(np.quantile(angle, (0.01, 0.99))))
    return extent, np.ptp(windows, axis=1), windows.mean(axis=1)


def _levels(still: FloatArray, extent: float) -> FloatArray:
    """Levels [rad] at which a position stands more than once, by its means there."""
    means = np.sort(still)
    groups = np.split(means, np.flatnonzero(np.diff(means) > APART * extent) + 1)
    return np.array([float(np.median(group)) for group in groups if len(group) > 1])


def lattice(levels: FloatArray) -> float:
    """Distance of levels, 0 where there are few of them or they lie on no lattice."""
    if len(levels) < LEVELS:
        return 0.0
    step = float(np.min(np.diff(levels)))
    for _ in range(3):  # the least distance is a start; all levels say it better
        count = np.round((levels - levels[0]) / step)
        step = float(np.polyfit(count, levels, 1)[0])
    off = levels - levels[0] - step * np.round((levels - levels[0]) / step)
    return step if np.max(np.abs(off - np.median(off))) < OFF * step else 0.0
