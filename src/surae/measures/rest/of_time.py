"""What relaxes in the leg at rest, and what a stretch to and fro takes."""

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference.relaxed.basis import Basis
from surae.inference.relaxed.curve import (
    BEYOND,
    LEFT_OUT,
    SLOW_FROM,
    SLOW_SPEED,
    PossibleLegs,
    RelaxedCurve,
)
from surae.inference.relaxed.regressors import TAUS, lags
from surae.measures.rest.at_angles import ON_ITS_WAY
from surae.measures.rest.draft import Draft
from surae.measures.rest.of_range import REACHES

#: Degrees between two samples of a stretch and its return.
_LOOP_STEP = 0.25
#: Seconds after which the part that has relaxed is given.
_RELAXED = 10.0
#: What three times of relaxation leave out of that part, and of the work that a loop takes (a
#: friction, a velocity), one standard deviation: set on 42 virtual legs of another author.
_SHARE_LEFT_OUT = 0.2
_LOOP_LEFT_OUT = 0.3


def over_time(
    curve: RelaxedCurve, legs: PossibleLegs, moved: tuple[float, float]
) -> Iterator[Draft]:
    """What relaxes, and what a stretch to and fro takes."""
    gone = 1.0 - np.exp(-_RELAXED / np.array(TAUS))
    share = 100.0 * (legs.gamma @ gone) / (1.0 + legs.gamma.sum(axis=1))
    power = _SHARE_LEFT_OUT / LEFT_OUT
    share = share * legs.scale**power
    relaxes = Draft(
        f"relaxed_share@{_RELAXED:g}s",
        "%",
        "Part of a sudden stretch's torque that has relaxed after some seconds.",
        device=share,
        ankle=share,
        power=power,
    )
    loop = Draft(
        "hysteresis",
        "%",
        "Energy that the relaxed ankle takes from a slow stretch from −30° to the end of the "
        "dorsiflexion that was moved and back, at 5°/s, as a part of the work of the way there.",
        span=(SLOW_FROM, moved[1]),
    )
    if curve.is_still:
        why = Message("none/rest-still")
        yield replace(relaxes, device=None, ankle=None, missing=why)
        yield replace(loop, missing=why)
        return
    yield relaxes
    low, high = moved
    if curve.high < high - REACHES or high < SLOW_FROM + ON_ITS_WAY:
        why = Message("none/rest-short", low=curve.low, high=curve.high, first=low, last=high)
        yield replace(loop, missing=why)
        return
    power = _LOOP_LEFT_OUT / LEFT_OUT
    lost = _hysteresis(curve, legs, high) * legs.scale**power
    yield replace(loop, device=lost, ankle=lost, power=power)


def _hysteresis(curve: RelaxedCurve, legs: PossibleLegs, end: float) -> FloatArray:
    """100·∮T dθ/∫(T − T₀) dθ of the way to `end` [deg], T₀ the torque at its start."""
    elastic, lagging, angle = _loop_features(curve.low, curve.high, end)
    steps = np.diff(angle)
    # both are sums over the torque: of the features first, then of each leg
    both = np.stack([_above_start(steps), _above_start(np.maximum(steps, 0.0))], axis=1)
    work = legs.weights @ (elastic.T @ both)
    for k, each in enumerate(lagging):
        work += legs.gamma[:, [k]] * (legs.weights @ (each.T @ both))
    lost, there = work.T
    return np.asarray(100.0 * lost / np.where(there > 0.0, there, np.nan))


def _above_start(steps: FloatArray) -> FloatArray:
    """What each torque adds to Σ step·(mean of the torques at its ends − the first torque)."""
    weights: FloatArray = 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))
    weights[0] -= steps.sum()
    return weights


@lru_cache(maxsize=16)
def _loop_features(
    low: float, high: float, end: float
) -> tuple[FloatArray, list[FloatArray], FloatArray]:
    there = np.arange(SLOW_FROM, end + 0.5 * _LOOP_STEP, _LOOP_STEP)
    angle = np.concatenate([there, there[-2::-1]])
    elastic = Basis(low, high).features(np.clip(angle, low - BEYOND, high + BEYOND))
    return elastic, lags(elastic, SLOW_SPEED / _LOOP_STEP), angle
