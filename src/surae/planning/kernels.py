"""Movement of a plan, sample by sample; the equations are those of `plan.py`."""

import math

import numpy as np

from surae.base.units import FloatArray
from surae.model.jit import jit

#: Longest time in which a perturbation comes and goes [s].
EDGE = 0.5


@jit
def _step(u: float) -> tuple[float, float, float]:
    """Minimum-jerk step from 0 to 1 with its first two derivatives."""
    if u <= 0.0:
        return 0.0, 0.0, 0.0
    if u >= 1.0:
        return 1.0, 0.0, 0.0
    still = u * (1.0 - u)
    return u**3 * (10.0 + u * (6.0 * u - 15.0)), 30.0 * still**2, 60.0 * still * (1.0 - 2.0 * u)


@jit
def _integral(u: float) -> float:
    """Integral of the step from −∞ to u."""
    if u <= 0.0:
        return 0.0
    return u - 0.5 if u >= 1.0 else u**4 * (2.5 + u * (u - 3.0))


@jit
def base_motion(
    t: FloatArray, ramps: FloatArray, origin: float, blend: float, out: FloatArray
) -> None:
    """Position, speed and acceleration of ramps between holds, in ranges of motion, into `out`.

    A row of `ramps` is when it starts [s], where it ends, and its speed [1/s]; the first starts at
    `origin`, and each gains or loses its speed in `blend` [s].
    """
    k = 0
    begin = origin
    for i in range(len(t)):
        while k < len(ramps):
            moving = abs(ramps[k, 1] - begin) / ramps[k, 2]
            if t[i] < ramps[k, 0] + moving + blend:
                break
            begin = ramps[k, 1]
            k += 1
        out[0, i], out[1, i], out[2, i] = begin, 0.0, 0.0
        if k < len(ramps) and t[i] > ramps[k, 0]:
            speed = ramps[k, 2] if ramps[k, 1] > begin else -ramps[k, 2]
            early = (t[i] - ramps[k, 0]) / blend
            late = early - abs(ramps[k, 1] - begin) / ramps[k, 2] / blend
            up = _step(early)
            down = _step(late)
            out[0, i] += speed * blend * (_integral(early) - _integral(late))
            out[1, i] = speed * (up[0] - down[0])
            out[2, i] = speed / blend * (up[1] - down[1])


@jit
def _shape(
    t: FloatArray,
    shake: FloatArray,
    speed: FloatArray,
    span: float,
    shape: FloatArray,
    part: FloatArray,
) -> None:
    """Fill in a perturbation's window and phase with two derivatives each, shape (n, 6).

    To `part`, shape (3, n), is added what it asks for of what the base leaves of the limits.
    """
    onset, length, size, first, last = shake
    edge = min(EDGE, 0.5 * length)
    for i in range(len(t)):
        since = t[i] - onset
        if since <= 0.0 or since >= length:
            continue
        up = _step(since / edge)
        down = _step((length - since) / edge)
        w = size * up[0] * down[0]
        w1 = size * (up[1] * down[0] - up[0] * down[1]) / edge
        w2 = size * (up[2] * down[0] - 2.0 * up[1] * down[1] + up[0] * down[2]) / edge**2
        bend = 2.0 * math.pi * (last - first) / length
        p = 2.0 * math.pi * first * since + 0.5 * bend * since**2
        p1 = 2.0 * math.pi * first + bend * since
        shape[i, 0], shape[i, 1], shape[i, 2] = w, w1, w2
        shape[i, 3], shape[i, 4], shape[i, 5] = p, p1, bend
        part[0, i] += 2.0 * w / span
        part[1, i] += 2.0 * abs(w1) + w * p1
        part[2, i] += (
            2.0 * abs(w2) + 2.0 * abs(w1) * p1 + w * (abs(bend) + p1**2) + 4.0 * abs(w1 * speed[i])
        )


@jit
def _share(
    t: FloatArray,
    shake: FloatArray,
    base: FloatArray,
    part: FloatArray,
    limits: tuple[float, float, float, float],
) -> float:
    """The part of a perturbation that keeps the limits wherever it is."""
    low, high, fastest, sharpest = limits
    span = high - low
    share = 1.0
    for i in range(len(t)):
        if t[i] > shake[0] and t[i] < shake[0] + shake[1]:
            share = min(share, 1.0 / max(part[0, i], 1.0))
            speed = max(fastest - span * abs(base[1, i]), 0.0)
            if part[1, i] > speed:
                share = min(share, speed / part[1, i])
            sharp = max(sharpest - span * abs(base[2, i]), 0.0)
            if part[2, i] > sharp:
                share = min(share, sharp / part[2, i])
    return share


@jit
def _add(
    t: FloatArray,
    shake: FloatArray,
    share: float,
    shape: FloatArray,
    room: FloatArray,
    out: FloatArray,
) -> None:
    """Add a part of a perturbation to `out`, and its window to `room`, both (3, n)."""
    for i in range(len(t)):
        if t[i] > shake[0] and t[i] < shake[0] + shake[1]:
            w = share * shape[i, 0]
            w1 = share * shape[i, 1]
            w2 = share * shape[i, 2]
            p = shape[i, 3]
            p1 = shape[i, 4]
            p2 = shape[i, 5]
            sine = math.sin(p)
            cosine = math.cos(p)
            room[0, i] += w
            room[1, i] += w1
            room[2, i] += w2
            out[0, i] += w * sine
            out[1, i] += w1 * sine + w * p1 * cosine
            out[2, i] += w2 * sine + 2.0 * w1 * p1 * cosine + w * (p2 * cosine - p1**2 * sine)


@jit
def plan_motion(
    t: FloatArray,
    ramps: FloatArray,
    begun: tuple[float, float],
    shakes: FloatArray,
    limits: tuple[float, float, float, float],
) -> FloatArray:
    """Angle, velocity and acceleration of a plan, within its limits at every one of the times.

    `begun` is where it begins and in which time a ramp gains its speed, `origin` and `blend` of
    `base_motion`. A row of `shakes` is onset and length [s], amplitude [rad], first and last
    frequency [Hz]. The limits are least and greatest angle [rad], speed [rad/s] and acceleration
    [rad/s²].
    """
    n = len(t)
    low = limits[0]
    span = limits[1] - low
    base = np.empty((3, n))
    base_motion(t, ramps, begun[0], begun[1], base)
    # how much of what the base leaves of the limits all perturbations ask for, sample by sample
    part = np.zeros((3, n))
    shape = np.empty((len(shakes), n, 6))
    for s in range(len(shakes)):
        _shape(t, shakes[s], base[1], span, shape[s], part)
    out = np.zeros((3, n))
    room = np.zeros((3, n))
    for s in range(len(shakes)):
        share = _share(t, shakes[s], base, part, limits)
        _add(t, shakes[s], share, shape[s], room, out)
    for i in range(n):
        f = base[0, i]
        speed = base[1, i]
        sharp = base[2, i]
        free = span - 2.0 * room[0, i]
        out[0, i] += low + free * f + room[0, i]
        out[1, i] += free * speed + (1.0 - 2.0 * f) * room[1, i]
        out[2, i] += free * sharp - 4.0 * room[1, i] * speed + (1.0 - 2.0 * f) * room[2, i]
    return out
