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


def angles(rng: np.random.Generator, times: Array, low: float, high: float, kind: str) -> Array:
    """Return the angle [rad]: ramps, holds and a chirp, in an order and at speeds of their own.

    ``kind`` is "active" or "passive" (both move alike), "curve" (a ladder of long holds),
    "isometric" (eight angles held, in an order of their own), or "alone" and "maximal" (one held).
    """
    angle = np.full(times.size, low)
    here, now = low, float(rng.uniform(1.0, 2.0))

    def go(target: float, seconds: float) -> None:
        nonlocal here, now, angle
        angle = angle + (target - here) * _smooth((times - now) / seconds)
        here, now = target, now + seconds

    span, end = high - low, float(times[-1])
    if kind == "curve":
        steps = 8
        for target in np.linspace(low, high, steps)[1:]:
            now += (end - 8) / steps - 1.0
            go(float(target), 1.0)
        return angle

    if kind in ("alone", "maximal"):
        return np.asarray(angle + 0.5 * span)
    if kind in ("slow", "fast"):  # through the whole range, at 8 to 12 or 70 to 110 °/s at most
        while now < end:
            least, most = (8, 12) if kind == "slow" else (70, 110)
            speed = np.radians(rng.uniform(least, most))
            for target in (high, low):
                go(target, 1.9 * span / float(speed))
                now += float(rng.uniform(0.5, 1.5))
        return angle
    if kind == "isometric":
        levels = rng.permutation(8) / 7
        each = (end - now) / 8
        for i, level in enumerate(levels):
            now = 1.0 + i * each
            go(low + (0.03 + 0.94 * float(level)) * span, 1.0)
        return angle

    def now_wait(least: float, most: float) -> None:
        nonlocal now
        now += float(rng.uniform(least, most))

    def ramps() -> None:
        slow = int(rng.integers(2))
        for i in range(2):
            speed = float(rng.uniform(0.2, 0.35) if i == slow else rng.uniform(0.5, 1.0))
            go(high - float(rng.uniform(0, 0.1)) * span, span / speed)
            now_wait(0.2, 0.6)
            go(low + float(rng.uniform(0, 0.1)) * span, span / float(rng.uniform(0.4, 1.0)))

    def holds() -> None:
        levels = rng.permutation(np.array([0.2, 0.45, 0.7, 0.92])) + rng.uniform(-0.08, 0.08, 4)
        for level in levels:
            target = low + float(level) * span
            go(target, max(0.5, 1.9 * abs(target - here) / float(rng.uniform(0.7, 1.4))))
            now_wait(1.0, 1.8)

    def chirp() -> None:
        nonlocal angle, now
        reach = float(rng.uniform(0.15, 0.28)) * span
        go(low + float(rng.uniform(0.4, 0.65)) * span, 1.2)
        seconds, first, last = 8.0, float(rng.uniform(0.1, 0.3)), float(rng.uniform(1.0, 1.7))
        u = np.clip(times - now, 0, seconds)
        phase = 2 * np.pi * (first * u + (last - first) * u**2 / (2 * seconds))
        fade = _smooth(u / 0.8) * _smooth((seconds - u) / 0.8)
        angle = angle + reach * fade * np.sin(phase)
        now += seconds

    blocks = [ramps, holds, chirp]
    while now < end:
        for block in rng.permutation(np.arange(3)):
            blocks[block]()
    return angle


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
        shape = _smooth((times - now) / rise) * _smooth((now + seconds - times) / fall)
        wobble = 1 + rng.uniform(0, 0.25) * np.sin(
            2 * np.pi * rng.uniform(0.4, 1.5) * times + rng.uniform(0, 6)
        )
        shares = np.array([0.2, 0.55, 0.25]) * np.exp(0.4 * rng.normal(size=3))
        shares /= shares.sum()
        both = rng.random() < 0.2
        if group == 1 or both:
            level[0] += size * (0.4 if both and group == 0 else 1) * shape * wobble
        if group == 0 or both:
            burst = size * (0.4 if both and group == 1 else 1) * shape * wobble
            level[1:] += shares[:, None] * burst
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
        own = 1 + 0.2 * np.array(
            [np.interp(times, knots, rng.normal(size=knots.size)) for _ in shares]
        )
        level[rows] = share * course * works * shares[:, None] * own
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
