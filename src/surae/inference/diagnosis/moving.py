"""Signals of which one stream is moved in time."""

from dataclasses import replace
from typing import Literal

import numpy as np

from surae.quality.trial import Signals

#: What may have a clock of its own: the EMG, the angle, or the torque (both others are moved).
Stream = Literal["emg", "angle", "torque"]


def moved(signals: Signals, lag: float, rate: float, stream: Stream = "emg") -> Signals:
    """The signals with a stream earlier by a lag [s] that grows about the middle [s/s].

    A torque is made earlier by making the angle and the EMG later: what is explained stays on its
    axis, so that what is left of it can be compared.
    """
    if lag == 0.0 and rate == 0.0:
        return signals
    time = signals.time
    by = lag + rate * (time - (time[0] + time[-1]) / 2.0)
    at = time - by if stream == "torque" else time + by
    angle = signals.angle
    fast = signals.fast
    if stream != "angle":
        fast = {muscle: np.interp(at, time, envelope) for muscle, envelope in fast.items()}
    if stream != "emg":
        angle = np.interp(at, time, angle)
    return replace(signals, angle=angle, fast=fast)
