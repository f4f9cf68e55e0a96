"""How stiff a leg is while its muscles work: torque over angle as each step loads it.

The slope of torque over angle while the ankle gives way under load is called quasi-stiffness, or
dynamic joint stiffness (Davis & DeLuca 1996, Gait & Posture 4, 224–231). It is measured without any
model, and muscles have the largest part in it: it is no stiffness of the relaxed ankle.
"""

from dataclasses import dataclass

import numpy as np

from surae.base.frozen import Comparable, read_only
from surae.base.units import FloatArray
from surae.signals import ModelInputs
from surae.signals.cycles import find_cycles

#: From this part of its largest torque on a step loads the ankle [1].
_LOADED = 0.1
#: The torque's peak lies between these parts of a cycle; 1 is the largest dorsiflexion.
_PEAK = (0.5, 1.15)
#: Least movement under load [deg], and least part of a step's variance that a line describes [1].
_MOVES = 4.0
_STRAIGHT = 0.5
#: Calf muscles among the channels of the EMG, and by how much of its range their activity must be
#: higher under load than in the rest of the cycle [1]; the range has these quantiles as its ends.
_CALF = slice(1, 4)
_WORKS = 0.2
_ENDS = (0.05, 0.95)
#: Least part of the cycles that must be such steps, and the least number of them.
_MOST = 0.8
_FEWEST = 10
#: Between these parts of the steps lie 95 % of them.
_SPAN = (0.025, 0.975)


@dataclass(frozen=True, slots=True, eq=False)
class WorkingStiffness(Comparable):
    """Torque by angle of an ankle that gives way under load while its calf works, over steps."""

    steps: int  #: Those it is of.
    value: float  #: Median of the steps [Nm/deg].
    span: tuple[float, float]  #: Where 95 % of the steps lie [Nm/deg].
    from_deg: float  #: `from_deg`, `to_deg`: medians of where the load begins and ends [deg].
    to_deg: float
    peak: float  #: Median of the steps' largest torques [Nm].
    middle: tuple[float, float]  #: Medians of the mean angle [deg] and torque [Nm] under load.
    #: Mean angle [deg] and torque [Nm] over the cycle, each of shape (101,).
    angle: FloatArray
    torque: FloatArray


@dataclass(frozen=True, slots=True)
class _Step:
    slope: float
    low: float
    high: float
    peak: float
    middle: tuple[float, float]


def working_stiffness(inputs: ModelInputs) -> WorkingStiffness | None:
    """What steps of one recording tell; None where it has none, or the calf is not seen to work.

    `inputs` are its prepared signals: angle [rad], torque [Nm], EMG of the calf.
    """
    if inputs.torque is None or not np.ptp(inputs.emg[:, _CALF]):
        return None
    counted = None if inputs.weight is None else inputs.weight > 0.0
    cycles = find_cycles(inputs.angle, inputs.rate_hz, counted)
    if cycles is None:
        return None
    calf = _activity(inputs.emg[:, _CALF])
    angle = np.degrees(inputs.angle)
    each = [_step(angle, inputs.torque, calf, *span) for span in cycles.spans]
    steps = [step for step in each if step is not None]
    if len(steps) < max(_FEWEST, _MOST * len(each)):
        return None
    slopes, lows, highs, peaks = np.transpose([(s.slope, s.low, s.high, s.peak) for s in steps])
    low, high = np.quantile(slopes, _SPAN)
    middle = np.median([s.middle for s in steps], axis=0)
    return WorkingStiffness(
        len(steps),
        float(np.median(slopes)),
        (float(low), float(high)),
        float(np.median(lows)),
        float(np.median(highs)),
        float(np.median(peaks)),
        (float(middle[0]), float(middle[1])),
        read_only(cycles.over(angle)[1]),
        read_only(cycles.over(inputs.torque)[1]),
    )


def _activity(emg: FloatArray) -> FloatArray:
    """Activity of the calf: its envelopes, each from its own rest to its own largest, added."""
    low, high = np.quantile(emg, _ENDS, axis=0)
    there = high > low
    scaled = (emg[:, there] - low[there]) / (high - low)[there]
    total: FloatArray = scaled.mean(axis=1)
    return total


def _step(
    angle: FloatArray, torque: FloatArray, calf: FloatArray, first: int, past: int
) -> _Step | None:
    """The loading [deg, Nm] that ends at the cycle's end; None where it is none."""
    length = past - first
    begin, end = (first + round(part * length) for part in _PEAK)
    peak = begin + int(np.argmax(torque[begin:end]))
    stop = begin + int(np.argmax(angle[begin : peak + 1])) + 1
    below = np.flatnonzero(torque[begin:stop] < _LOADED * torque[peak])
    start = begin + (int(below[-1]) + 1 if below.size else 0)
    x, y = angle[start:stop], torque[start:stop]
    if len(x) < 3 or x[-1] - x[0] < _MOVES:
        return None
    rest = np.r_[calf[first:start], calf[stop:past]]
    if not rest.size or calf[start:stop].mean() - rest.mean() < _WORKS:
        return None
    away = x - x.mean()
    slope = float(away @ y / (away @ away))
    missed = y - y.mean() - slope * away
    straight = 1.0 - float(missed @ missed) / float(np.sum((y - y.mean()) ** 2))
    if slope <= 0.0 or straight < _STRAIGHT:
        return None
    middle = float(x.mean()), float(y.mean())
    return _Step(slope, float(x[0]), float(x[-1]), float(torque[peak]), middle)
