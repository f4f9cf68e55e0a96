"""Films of fascicles: lost and repeated frames, jumps, drift, another unit or clock."""

from collections.abc import Iterator

import numpy as np

from surae.base.units import FloatArray
from surae.quality.finding import Finding, make_finding
from surae.quality.numeric import span_of
from surae.quality.trial import CheckedTrial
from surae.recording import Channel

#: Fascicles of the ankle's muscles are within these lengths [m].
_LENGTHS = (0.01, 0.2)
#: Frames that may be lost, as a part of all, and the longest pause that is none [frames].
_LOST = 0.02
_PAUSE = 1.5
#: Part of the frames that may repeat the one before where the fascicle moves by so much [m] within
#: nine frames.
_REPEATED = 0.1
_MOVES = 5e-4
#: A jump is larger than this [m], and so many times the steps around it.
_JUMP = 3e-3
_ALONE = 4.0
#: A film that is this much [s] early or late is found where angle and torque leave more than this
#: [m] of it, and the shift takes away this part of its square.
_LATE = 0.04
_LATEST = 0.5
_LEFT = 5e-4
_LESS = 0.3
#: Drift over the trial [m] that a fit's own drift of 1 to 2 mm no longer covers.
_DRIFT = 4e-3
_FEWEST = 32


def _fascicles(trial: CheckedTrial) -> Iterator[Channel]:
    for role, channel in trial.recording.films.items():
        if role.startswith("fascicle_") and len(channel.time) >= _FEWEST:
            yield channel


def unit(trial: CheckedTrial) -> Iterator[Finding]:
    """Lengths that no muscle of the ankle has."""
    for channel in _fascicles(trial):
        middle = float(np.median(channel.values))
        if not _LENGTHS[0] <= middle <= _LENGTHS[1]:
            span = span_of(channel.time)
            yield make_finding("film-unit", channel.role, span, middle, mm=1e3 * middle)


def lost(trial: CheckedTrial) -> Iterator[Finding]:
    """Frames without a length."""
    for channel in _fascicles(trial):
        steps = np.diff(channel.time)
        step = float(np.median(steps))
        pauses = np.flatnonzero(steps > _PAUSE * step)
        frames = float(np.sum(np.round(steps[pauses] / step) - 1))
        part = frames / (len(channel.time) + frames)
        if part > _LOST:
            span = float(channel.time[pauses[0]]), float(channel.time[pauses[-1] + 1])
            yield make_finding("film-lost", channel.role, span, part, n=frames, percent=100 * part)


def repeated(trial: CheckedTrial) -> Iterator[Finding]:
    """Frames that are those before, as when a film was exported faster than it was taken."""
    for channel in _fascicles(trial):
        around = np.lib.stride_tricks.sliding_window_view(channel.values, 9)
        moving = np.zeros(len(channel.values) - 1, dtype=bool)
        moving[4:-3] = np.ptp(around, axis=1) > _MOVES
        part = float(np.mean(np.diff(channel.values)[moving] == 0.0)) if moving.any() else 0.0
        if part > _REPEATED:
            span = span_of(channel.time)
            yield make_finding("film-repeated", channel.role, span, part, percent=100 * part)


def jumps(trial: CheckedTrial) -> Iterator[Finding]:
    """Steps from one frame to the next that stand alone."""
    for channel in _fascicles(trial):
        size = np.abs(np.diff(channel.values))
        beside = np.lib.stride_tricks.sliding_window_view(np.pad(size, 4, mode="edge"), 9)
        others = np.delete(beside, (3, 4, 5), axis=1).max(axis=1)
        at = np.flatnonzero((size > _JUMP) & (size > _ALONE * others))
        at = at[np.diff(channel.time)[at] < _PAUSE * float(np.median(np.diff(channel.time)))]
        if at.size:
            worst = float(size[at].max())
            span = float(channel.time[at[0]]), float(channel.time[at[-1] + 1])
            yield make_finding("film-jump", channel.role, span, worst, n=at.size, mm=1e3 * worst)


def against_the_robot(trial: CheckedTrial) -> Iterator[Finding]:
    """A film that is early, late or drifts, by what angle and torque say of the length."""
    for channel in _fascicles(trial):
        first = trial.span[0] + _LATEST
        last = trial.span[1] - _LATEST
        inside = (channel.time > first) & (channel.time < last)
        likely = _LENGTHS[0] <= float(np.median(channel.values)) <= _LENGTHS[1]
        if trial.torque is None or not likely or inside.sum() < _FEWEST:
            continue
        time = channel.time[inside]
        length = channel.values[inside]
        late = np.arange(-_LATEST, _LATEST + 1e-9, 0.01)
        left = np.array([np.sum(_unexplained(trial, time - by, length) ** 2) for by in late])
        here = float(left[np.argmin(np.abs(late))])
        best = int(np.argmin(left))
        by = float(late[best])
        if abs(by) > _LATE and here > len(time) * _LEFT**2 and left[best] < (1.0 - _LESS) * here:
            which = "film-clock/late" if by > 0.0 else "film-clock/early"
            span = span_of(channel.time)
            yield make_finding(which, channel.role, span, by, ms=1e3 * abs(by))
            continue
        since = (time - time[0]) / (time[-1] - time[0])
        drift = float(np.polyfit(since, _unexplained(trial, time, length), 1)[0])
        if abs(drift) > _DRIFT:
            span = span_of(channel.time)
            yield make_finding("film-drift", channel.role, span, drift, mm=1e3 * drift)


def _unexplained(trial: CheckedTrial, time: FloatArray, length: FloatArray) -> FloatArray:
    """What angle and torque leave of a length [m]: the path is bent, the tendon stretches."""
    assert trial.torque is not None
    angle = np.interp(time, trial.time, trial.angle)
    torque = np.interp(time, trial.time, trial.torque)
    known = np.column_stack([np.ones(len(time)), angle, angle**2, torque])
    return np.asarray(length - known @ np.linalg.lstsq(known, length, rcond=None)[0])
