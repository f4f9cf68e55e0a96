"""Stretch reflexes: EMG of the triceps that follows stretch by 25 to 120 ms."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.quality.finding import Finding, Unjudged, make_finding
from surae.quality.numeric import BoolArray, correlation, quantile, runs, shifted, smooth, span_of
from surae.quality.trial import CheckedTrial
from surae.recording import MUSCLES

#: Delay of a reflex behind the stretch [s]: short and medium latency responses of the soleus.
EARLIEST = 0.025
LATEST = 0.12
#: Correlation of EMG and stretch velocity at such a delay, at rest, that chance does not reach.
ALIKE = 0.4
#: Slowest stretch that counts [rad/s]: about 15°/s, the threshold of spastic muscles.
STRETCH = 0.26
#: Stretches that must be seen, and the share of them that a burst follows.
EVENTS = 2
FOLLOWED = 0.6
#: A burst as a multiple of the level before it.
BURST = 2.5


@dataclass(frozen=True, slots=True)
class Reflex:
    """Bursts that follow stretches."""

    delay: float  #: Of the bursts behind the stretch [s].
    events: int  #: Stretches that were looked at.
    #: Times at which the triceps is active because it is stretched, shape (n,).
    explained: BoolArray


def reflex(trial: CheckedTrial) -> Reflex | None:
    """The reflex of a trial; None where there is none or nothing to tell it by."""
    emg = trial.group("triceps", fast=True)
    if emg is None or trial.rate_hz < 60.0:
        return None
    emg = smooth(emg, 3) if trial.emg_kind == "raw" else emg
    stretch = np.maximum(smooth(trial.velocity, 3), 0.0)
    if float(stretch.max()) < STRETCH:
        return None
    resting = _resting(trial)
    return _proportional(trial, emg, stretch, resting) or _bursts(trial, emg, stretch)


def suspected(trial: CheckedTrial) -> Iterator[Finding]:
    """EMG of the triceps locked to its stretch."""
    if not trial.triceps:
        raise Unjudged("There is no EMG of the triceps.")
    if trial.rate_hz < 60.0:
        raise Unjudged("The signals are too slow to show 25 ms.")
    if float(trial.velocity.max()) < STRETCH:
        raise Unjudged("No stretch is fast enough.")
    if (reflexes := reflex(trial)) is not None:
        where = np.flatnonzero(reflexes.explained)
        span = span_of(trial.time, where if where.size else None)
        yield make_finding(
            "reflex-suspected",
            f"emg_{trial.triceps[0]}",
            span,
            reflexes.delay,
            joint=trial.joint,
            ms=1e3 * reflexes.delay,
            n=reflexes.events,
        )


def _resting(trial: CheckedTrial) -> BoolArray:
    """Times in which the triceps is not asked for, or, where that is not known, hardly active."""
    slow = trial.group("triceps")
    assert slow is not None
    if trial.effort is not None:
        heads = [MUSCLES.index(m) for m in trial.triceps]
        target = trial.effort[:, heads].max(axis=1)
        near = smooth((target > 0.0).astype(np.float64), round(0.3 * trial.rate_hz))
        resting: BoolArray = near == 0.0
        if float(resting.sum()) > 4.0 * trial.rate_hz:
            return resting
    low: BoolArray = slow < max(0.15 * quantile(slow, 0.98), quantile(slow, 0.5))
    return low


def _proportional(
    trial: CheckedTrial, emg: FloatArray, stretch: FloatArray, resting: BoolArray
) -> Reflex | None:
    """A reflex whose activity follows the velocity of the stretch."""
    if float(resting.sum()) < 3.0 * trial.rate_hz:
        return None
    mine = emg[resting]
    crossing = trial.group("ta", fast=True)
    if crossing is not None:
        # What the electrodes pick up of the tibialis is no reflex.
        tibialis = crossing[resting] - float(crossing[resting].mean())
        power = float(tibialis @ tibialis)
        if power > 0.0:
            mine = mine - max(float(tibialis @ mine) / power, 0.0) * tibialis
    fast = np.maximum(stretch - 0.1, 0.0)
    lags = np.arange(-round(0.2 * trial.rate_hz), round(0.4 * trial.rate_hz) + 1)
    alike = [correlation(shifted(fast, lag)[resting], mine) for lag in lags.tolist()]
    best = int(np.argmax(alike))
    delay = float(lags[best]) / trial.rate_hz
    if alike[best] < ALIKE or not EARLIEST - 0.006 <= delay <= LATEST + 0.006:
        return None
    late = shifted(fast, int(lags[best]))
    during = resting & (late > STRETCH)
    quiet = resting & (late == 0.0)
    if not during.any() or not quiet.any():
        return None
    if float(np.mean(emg[during])) < 1.5 * float(np.mean(emg[quiet])):
        return None
    # Times in which a stretch, late by the delay, shows in a level of `SLOW` seconds.
    shows = smooth((late > 0.0).astype(np.float64), round(0.3 * trial.rate_hz)) > 0.0
    return Reflex(delay, len(_onsets(trial, stretch)), shows)


def _onsets(trial: CheckedTrial, stretch: FloatArray) -> list[int]:
    """Find where stretches that become fast begin."""
    onsets: list[int] = []
    for start, _ in runs(stretch > STRETCH):
        if start >= (onsets[-1] + round(0.25 * trial.rate_hz) if onsets else 1):
            onsets.append(start)
    return onsets


def _bursts(trial: CheckedTrial, emg: FloatArray, stretch: FloatArray) -> Reflex | None:
    """A reflex of short bursts, after the onset or the peak of most stretches."""
    rate = trial.rate_hz
    before = round(0.1 * rate)
    after = round(0.3 * rate)
    usual = quantile(emg, 0.99)
    total = np.concatenate([[0.0], np.cumsum(emg)])

    def mean(first: int, last: int) -> float:
        return float(total[last] - total[first]) / (last - first)

    onsets = _onsets(trial, stretch)
    width = round(0.5 * rate)
    pieces = [(start, stretch[start : start + width]) for start in onsets]
    # Where stretches reach their speed, which ramps then keep.
    peaks = [start + int(np.argmax(piece >= 0.95 * piece.max())) for start, piece in pieces]
    for events in (onsets, peaks):
        looked = 0
        followed: dict[int, float] = {}  # by how much, by the event
        for event in events:
            if event < before or event + after >= len(emg):
                continue
            rest = mean(event - before, event + round(0.01 * rate))
            if rest > 0.1 * usual:
                continue  # active already
            looked += 1
            window = slice(event + round(0.02 * rate), event + round((LATEST + 0.03) * rate))
            answer = emg[window]
            later = mean(event + round(0.2 * rate), event + after)
            top = float(answer.max())
            if top > BURST * max(rest, later) and top > 0.03 * usual:
                followed[event] = (int(np.argmax(answer)) + window.start - event) / rate
        if looked >= EVENTS and len(followed) >= max(EVENTS, FOLLOWED * looked):
            answered = np.zeros(len(emg), dtype=bool)
            for event in followed:
                answered[event : event + after] = True
            return Reflex(float(np.median([*followed.values()])), looked, answered)
    return None
