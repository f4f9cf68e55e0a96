"""Courses for relaxed legs: constant speeds up and down, holds, and efforts with rests between.

Each course draws what it does from the trial's random numbers and fits into the time it is given.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.ndimage import uniform_filter1d

from ankle_legs.movement import _smooth, effort
from ankle_legs.muscle import Array

SLOW = 5.0  # the speed that measures are defined at [deg/s]
Plan = tuple[Array, Array]
Knots = list[tuple[float, float]]  # times [s] and angles [rad]


def _rounded(times: Array, knots: Knots, seconds: float = 0.16) -> Array:
    """Return a course through knots whose corners are rounded over some time."""
    course = np.interp(times, *np.array(knots).T)
    width = max(round(seconds / float(times[1] - times[0])), 1)
    for _ in range(2):
        course = uniform_filter1d(course, width, mode="nearest")
    return np.asarray(course)


def _rest(times: Array) -> Array:
    """Return no effort of any muscle."""
    return np.zeros((4, times.size))


class _Way:
    """A course in the making: where it is, and when."""

    def __init__(self, rng: np.random.Generator, start: float) -> None:
        self.rng, self.knots = rng, [(0.0, start)]
        self.wait(1.0, 2.0)

    @property
    def now(self) -> float:
        return self.knots[-1][0]

    @property
    def here(self) -> float:
        return self.knots[-1][1]

    def wait(self, least: float, most: float) -> None:
        """Stay for a time between two [s]."""
        self.knots.append((self.now + float(self.rng.uniform(least, most)), self.here))

    def go(self, target: float, speed: float) -> None:
        """Go to an angle [rad] at a speed [deg/s]."""
        seconds = abs(target - self.here) / float(np.radians(speed))
        self.knots.append((self.now + max(seconds, 0.02), target))


def ramps(rng: np.random.Generator, times: Array, low: float, high: float) -> Plan:
    """Return ramps up and down: 5 °/s first or last, faster ones beside, short waits between."""
    way, end = _Way(rng, low), float(times[-1])
    slow_first = rng.random() < 0.5
    span = float(np.degrees(high - low))
    slow_takes = 2 * span / SLOW + 3.0
    slow_done = False
    while way.now < end:
        left = end - way.now
        if not slow_done and (slow_first or left < slow_takes + 8.0):
            speed, slow_done = SLOW * float(rng.uniform(0.9, 1.1)), True
        else:
            speed = float(np.exp(rng.uniform(np.log(8), np.log(70))))
        for target in (high, low):
            way.go(target, speed)
            way.wait(0.3, 2.0)
    return _rounded(times, way.knots), _rest(times)


def stretches(rng: np.random.Generator, times: Array, low: float, high: float) -> Plan:
    """Return one slow ramp up and down, then fast ones (60 to 150 °/s) with rests of 1 to 3 s."""
    way, end = _Way(rng, low), float(times[-1])
    for target in (high, low):
        way.go(target, SLOW * float(rng.uniform(0.9, 1.3)))
        way.wait(0.5, 1.5)
    while way.now < end:
        speed = float(rng.uniform(60, 150))
        way.go(high, speed)
        way.wait(1.0, 3.0)
        way.go(low, float(rng.uniform(20, 60)))
        way.wait(1.0, 2.0)
    return _rounded(times, way.knots, 0.06), _rest(times)


def ladder(rng: np.random.Generator, times: Array, low: float, high: float) -> Plan:
    """Return holds at five to seven angles, up and (in two of three) down again."""
    steps, back = int(rng.integers(5, 8)), rng.random() < 2 / 3
    levels = np.linspace(low, high, steps)
    targets = [*levels[1:], *(levels[-2::-1] if back else ())]
    speed = float(rng.uniform(10, 30))
    way, end = _Way(rng, low), float(times[-1]) - 0.5
    moving = float(np.degrees(high - low)) * (2 if back else 1) / speed
    each = max((end - way.now - moving) / len(targets), 0.5)
    for target in targets:
        way.go(float(target), speed)
        way.wait(each, each)
    return _rounded(times, way.knots), _rest(times)


def _rests(rng: np.random.Generator, end: float) -> list[tuple[float, float]]:
    """Return from when to when the person rests: 8 s or more in all, between efforts.

    The share of rest is drawn, and how it is dealt out: one rest may have most of it.
    """
    rest = max(float(rng.uniform(0.2, 0.65)) * end, 8.0)
    count = max(int(rng.integers(1, 4)), round((end - rest) / 12))
    gaps = np.maximum(rng.dirichlet(np.full(count + 1, 3.0)) * rest, 1.0)
    work = max((end - float(gaps.sum())) / count, 2.0)
    starts = np.concatenate([[0.0], np.cumsum(gaps[:-1] + work)])
    return [(float(start), float(start + gap)) for start, gap in zip(starts, gaps, strict=True)]


def bouts(rng: np.random.Generator, times: Array, low: float, high: float) -> Plan:
    """Return efforts with rests between; at rest it goes slowly through the range."""
    rests, end, span = _rests(rng, float(times[-1])), float(times[-1]), high - low
    way = _Way(rng, low)
    while way.now < end:
        if any(start - 0.5 <= way.now < stop - 1.0 for start, stop in rests):
            there = high if way.here < low + 0.5 * span else low
            way.go(there, float(rng.uniform(5, 12)))
            way.wait(0.2, 1.0)
        else:
            way.go(low + float(rng.uniform(0.05, 0.98)) * span, float(rng.uniform(15, 50)))
            way.wait(0.2, 1.5)
    level, resting = effort(rng, times, "active"), np.zeros(times.size)
    for start, stop in rests:
        fade = _smooth((times - start + 0.3) / 0.3) * _smooth((stop + 0.3 - times) / 0.3)
        resting = np.maximum(resting, fade)
    return _rounded(times, way.knots), level * (1 - resting)


#: What a trial of each kind does: the angle [rad], and the effort of the four muscles, 0 to 1.
COURSES: dict[str, Callable[[np.random.Generator, Array, float, float], Plan]] = {
    "ramps": ramps,
    "bouts": bouts,
    "ladder": ladder,
    "stretches": stretches,
}
