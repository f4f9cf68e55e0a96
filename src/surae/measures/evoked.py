"""How much of a leg's active contraction its electrodes show to be answers to stretch."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.measures.leg import Leg, NotDefinedError
from surae.quality.reflex import ALIKE, EARLIEST, LATEST, STRETCH
from surae.signals import ModelInputs

#: Delays that are looked at [s]: where another than a reflex's fits best, there is none.
_LOOKED = (-0.2, 0.4)
#: A muscle rests while its median over so long [s], which no answer lifts, is below this part of
#: its 99th percentile.
_REST = 0.15
_SLOW = 1.5
#: Time at rest, and in fast stretches at rest, without which nothing is told [s].
_QUIET = 3.0
_STRETCHED = 0.15


def evoked_share(leg: Leg, _: float) -> float:
    """Part of EMG that answers stretches of the calf in the active contraction of the recordings.

    Mean |torque by EMG in proportion to the rectified velocity of stretch 25 to 120 ms before, its
    size and delay from what is relaxed| over mean |torque of active contraction|.
    """
    if not leg.inputs:
        raise NotDefinedError("no recording says what EMG answers")
    vector = np.array([leg.values[name] for name in leg.spec.names])
    answered = 0.0
    whole = 0.0
    every = [evoked_emg(inputs) for inputs in leg.inputs]
    some = any(evoked.any() for evoked in every)  # which fewer samples might not show
    recordings = leg.inputs if some else leg.summed
    split = leg.split_whole if some else leg.split
    for evoked, inputs, (parts, _force, states) in zip(every, recordings, split, strict=True):
        whole += float(np.abs(parts.neural).sum()) / inputs.rate_hz
        if not evoked.any():
            continue
        without = replace(inputs, emg=read_only(inputs.emg - evoked))
        activity = states[0]
        other = leg.spec.simulator(without, leg.options).activity(vector)[0]
        share = np.divide(activity - other, activity, out=np.zeros(inputs.n), where=activity > 0.0)
        answered += float(np.abs(share * parts.neural_tri).sum()) / inputs.rate_hz
    return 100.0 * answered / whole


@lru_cache(maxsize=32)  # a measure asks again for each of its derivatives
def evoked_emg(inputs: ModelInputs) -> FloatArray:
    """What of each envelope answers stretch of the calf, shape (n, 4).

    It is in proportion to the rectified velocity, later by one delay; both from samples at which
    the calf rests but for such answers.
    """
    from scipy.ndimage import median_filter

    emg = inputs.emg
    rate = inputs.rate_hz
    heads = [k for k in (1, 2, 3) if emg[:, k].any()]
    stretch = np.maximum(inputs.velocity, 0.0)
    if not heads:
        raise NotDefinedError("the recording has no EMG of the calf")
    if stretch.max() < STRETCH:
        raise NotDefinedError("the recording has no stretch of the calf of over 15°/s")
    lags = range(round(_LOOKED[0] * rate), round(_LOOKED[1] * rate) + 1)
    mean = emg[:, heads].mean(axis=1)
    slow = median_filter(mean, max(round(_SLOW * rate), 1), mode="nearest")
    rest = slow <= max(_REST * float(np.percentile(mean, 99.0)), float(np.percentile(slow, 50)))
    asked = rest & (stretch > STRETCH)
    if rest.sum() < _QUIET * rate or asked.sum() < _STRETCHED * rate:
        raise NotDefinedError("no stretch of a calf that rests says what EMG answers")
    alike = [float(np.corrcoef(_late(stretch, lag)[rest], mean[rest])[0, 1]) for lag in lags]
    best = int(np.nanargmax(alike))
    evoked = np.zeros_like(emg)
    delay = lags[best] / rate
    if alike[best] < ALIKE or not EARLIEST - 0.006 <= delay <= LATEST + 0.006:
        return read_only(evoked)
    late = _late(stretch, lags[best])
    for k in heads:
        trend = np.polynomial.Polynomial.fit(late[rest], emg[rest, k], 1).convert().coef
        evoked[:, k] = np.clip(trend[-1] * late if len(trend) > 1 else 0.0, 0.0, emg[:, k])
    return read_only(evoked)


def _late(x: FloatArray, lag: int) -> FloatArray:
    """A signal so many samples later, its ends held."""
    return np.asarray(x[np.clip(np.arange(len(x)) - lag, 0, len(x) - 1)])
