"""Signals whose EMG is moved in time."""

from dataclasses import replace

import numpy as np

from surae.quality.trial import Signals


def moved(signals: Signals, lag: float, rate: float) -> Signals:
    """The signals with the EMG earlier by a lag [s] that grows about the middle [s/s]."""
    if lag == 0.0 and rate == 0.0:
        return signals
    time = signals.time
    at = time + lag + rate * (time - (time[0] + time[-1]) / 2.0)
    return replace(signals, fast={m: np.interp(at, time, own) for m, own in signals.fast.items()})
