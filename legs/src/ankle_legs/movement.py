"""What the robot does and what the person does: angles and effort on a fine grid."""

from __future__ import annotations

import numpy as np

from ankle_legs.muscle import Array

RATE = 128  # samples a second
FINE = 16  # steps of the integration a sample
KINDS = ("active", "passive", "curve", "slow", "fast", "isometric", "alone", "maximal")


def fine_times(seconds: float) -> Array:
    """Return the fine grid's times [s]."""
    return np.arange(round(seconds * RATE) * FINE) / (RATE * FINE)


def _smooth(u: Array) -> Array:
    """Return a step from 0 to 1 without a jerk's jump."""
    u = np.clip(u, 0, 1)
    return np.asarray(u**3 * (10 - 15 * u + 6 * u**2))


def _between(times: Array, begin: float, end: float) -> tuple[slice, slice]:
    """Return the samples from a time to another, with one more at either end, and those behind.

    A step of all samples, of which there are hundreds in an hour, would take its square.
    """
    first, last = np.searchsorted(times, (begin, end))
    last = min(int(last) + 2, times.size)
    return slice(max(int(first) - 1, 0), last), slice(last, None)


class _Course:
    """An angle that is being made up, from one target to the next."""

    def __init__(self, rng: np.random.Generator, times: Array, low: float, high: float) -> None:
        self.rng = rng
        self.times = times
        self.low, self.high, self.span = low, high, high - low
        self.angle = np.full(times.size, low)
        self.here, self.now, self.end = low, float(rng.uniform(1.0, 2.0)), float(times[-1])

    def go(self, target: float, seconds: float) -> None:
        """Go to a target, without a jerk's jump."""
        moving, later = self._while(seconds)
        away = target - self.here
        self.angle[moving] += away * _smooth((self.times[moving] - self.now) / seconds)
        self.angle[later] += away
        self.here, self.now = target, self.now + seconds

    def _while(self, seconds: float) -> tuple[slice, slice]:
        """Return the samples of so long from now on, and those that follow."""
        return _between(self.times, self.now, self.now + seconds)

    def wait(self, least: float, most: float) -> None:
        """Stay for a while."""
        self.now += float(self.rng.uniform(least, most))

    def ladder(self, steps: int = 8) -> None:
        """Go up in steps of equal height, each held long."""
        for target in np.linspace(self.low, self.high, steps)[1:]:
            self.now += (self.end - 8) / steps - 1.0
            self.go(float(target), 1.0)

    def sweeps(self, least: float, most: float) -> None:
        """Go through the whole range to and fro, at speeds of at most so many °/s."""
        while self.now < self.end:
            speed = np.radians(self.rng.uniform(least, most))
            for target in (self.high, self.low):
                self.go(target, 1.9 * self.span / float(speed))
                self.wait(0.5, 1.5)

    def eight_holds(self) -> None:
        """Hold eight angles, in an order of their own."""
        levels = self.rng.permutation(8) / 7
        each = (self.end - self.now) / 8
        for i, level in enumerate(levels):
            self.now = 1.0 + i * each
            self.go(self.low + (0.03 + 0.94 * float(level)) * self.span, 1.0)

    def ramps(self) -> None:
        """Go up and down twice, once slowly."""
        slow = int(self.rng.integers(2))
        for i in range(2):
            speed = float(self.rng.uniform(0.2, 0.35) if i == slow else self.rng.uniform(0.5, 1.0))
            target = self.high - float(self.rng.uniform(0, 0.1)) * self.span
            self.go(target, self.span / speed)
            self.wait(0.2, 0.6)
            target = self.low + float(self.rng.uniform(0, 0.1)) * self.span
            self.go(target, self.span / float(self.rng.uniform(0.4, 1.0)))

    def holds(self) -> None:
        """Hold four angles."""
        levels = self.rng.permutation(np.array([0.2, 0.45, 0.7, 0.92]))
        for level in levels + self.rng.uniform(-0.08, 0.08, 4):
            target = self.low + float(level) * self.span
            fast = float(self.rng.uniform(0.7, 1.4))
            self.go(target, max(0.5, 1.9 * abs(target - self.here) / fast))
            self.wait(1.0, 1.8)

    def chirp(self) -> None:
        """Go to and fro ever faster."""
        reach = float(self.rng.uniform(0.15, 0.28)) * self.span
        self.go(self.low + float(self.rng.uniform(0.4, 0.65)) * self.span, 1.2)
        seconds = 8.0
        first, last = float(self.rng.uniform(0.1, 0.3)), float(self.rng.uniform(1.0, 1.7))
        moving, _ = self._while(seconds)
        u = np.clip(self.times[moving] - self.now, 0, seconds)
        phase = 2 * np.pi * (first * u + (last - first) * u**2 / (2 * seconds))
        fade = _smooth(u / 0.8) * _smooth((seconds - u) / 0.8)
        self.angle[moving] += reach * fade * np.sin(phase)
        self.now += seconds

    def mixed(self) -> None:
        """Ramps, holds and a chirp, in an order of their own, to the end."""
        blocks = [self.ramps, self.holds, self.chirp]
        while self.now < self.end:
            for block in self.rng.permutation(np.arange(3)):
                blocks[block]()


def angles(rng: np.random.Generator, times: Array, low: float, high: float, kind: str) -> Array:
    """Return the angle [rad]: ramps, holds and a chirp, in an order and at speeds of their own.

    ``kind`` is "active" or "passive" (both move alike), "curve" (a ladder of long holds),
    "isometric" (eight angles held, in an order of their own), "slow" or "fast" (through the whole
    range, at 8 to 12 or 70 to 110 °/s at most), or "alone" and "maximal" (one held).
    """
    course = _Course(rng, times, low, high)
    if kind == "curve":
        course.ladder()
    elif kind in ("alone", "maximal"):
        return np.asarray(course.angle + 0.5 * course.span)
    elif kind == "slow":
        course.sweeps(8, 12)
    elif kind == "fast":
        course.sweeps(70, 110)
    elif kind == "isometric":
        course.eight_holds()
    else:
        course.mixed()
    return course.angle


def effort(rng: np.random.Generator, times: Array, kind: str) -> Array:
    """Return the effort of the four muscles (ta, gl, sol, gm), 0 to 1 of the leg's own peak.

    Active: bursts alternate between the groups; now and then both pull. The triceps's three muscles
    share each burst differently. Isometric: it fluctuates. Alone: one muscle after another pulls,
    the others help a little. Maximal: the groups pull as strongly as they can.
    """
    level = np.zeros((4, times.size))
    if kind in ("passive", "curve", "slow", "fast"):
        return level
    if kind == "isometric":
        return _fluctuating(rng, times)
    if kind in ("alone", "maximal"):
        return _one_at_a_time(rng, times, 1.0 if kind == "maximal" else 0.6)
    now, end = float(rng.uniform(4.0, 7.0)), float(times[-1])
    group = int(rng.integers(2))
    while now < end - 1:
        seconds, size = float(rng.uniform(0.7, 2.4)), float(rng.uniform(0.25, 1.0))
        rise, fall = rng.uniform(0.12, 0.4, 2)
        at, _ = _between(times, now, now + seconds)
        fluctuation = times[at]
        shape = _smooth((fluctuation - now) / rise) * _smooth((now + seconds - fluctuation) / fall)
        wobble = 1 + rng.uniform(0, 0.25) * np.sin(
            2 * np.pi * rng.uniform(0.4, 1.5) * fluctuation + rng.uniform(0, 6)
        )
        shares = np.array([0.2, 0.55, 0.25]) * np.exp(0.4 * rng.normal(size=3))
        shares /= shares.sum()
        both = rng.random() < 0.2
        if group == 1 or both:
            level[0, at] += size * (0.4 if both and group == 0 else 1) * shape * wobble
        if group == 0 or both:
            burst = size * (0.4 if both and group == 1 else 1) * shape * wobble
            level[1:, at] += shares[:, None] * burst
        if rng.random() < 0.85:
            group = 1 - group
        now += seconds + float(rng.uniform(0.2, 1.2))
    return np.clip(level, 0, 1.2)


def _fluctuating(rng: np.random.Generator, times: Array) -> Array:
    """Return efforts that wander and rest by turns, now of the calf and now of the tibialis."""
    level = np.zeros((4, times.size))
    knots = np.arange(0, times[-1] + 3, 0.5)
    for rows, share in ((slice(0, 1), 0.7), (slice(1, 4), 0.9)):
        course = np.interp(times, knots, rng.uniform(0, 1, knots.size))
        works = _smooth(
            np.interp(times, knots, np.repeat(rng.integers(0, 2, knots.size), 4)[: knots.size])
        )
        shares = np.ones(1) if rows.stop == 1 else np.array([0.2, 0.55, 0.25])
        fluctuation = 1 + 0.2 * np.array(
            [np.interp(times, knots, rng.normal(size=knots.size)) for _ in shares]
        )
        level[rows] = share * course * works * shares[:, None] * fluctuation
    return np.clip(level, 0, 1.2)


def _one_at_a_time(rng: np.random.Generator, times: Array, size: float) -> Array:
    """Return three contractions of each muscle, or of each group where they are maximal."""
    level, groups = (
        np.zeros((4, times.size)),
        [[0], [1], [2], [3]] if size < 1 else [[0], [1, 2, 3]],
    )
    shares = np.array([1.0, 0.2, 0.55, 0.25])
    each = (times[-1] - 1) / (3 * len(groups))
    for i in range(3 * len(groups)):
        rows = groups[i // 3]
        now, seconds = 1 + i * each, min(0.75 * each, 3.0)
        burst = _smooth((times - now) / 0.4) * _smooth((now + seconds - times) / 0.4)
        burst = burst * size * rng.uniform(0.85, 1.0)
        helps = rng.uniform(
            0.0, 0.12, 4
        )  # who contracts one muscle does not quite leave the others
        if rows == [0]:
            helps[1:] *= 0.4
        for row in range(4):
            level[row] += shares[row] * burst * (1.0 if row in rows else helps[row])
    return level
