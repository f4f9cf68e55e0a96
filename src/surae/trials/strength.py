"""How strongly a leg pulled in trials of maximal effort: torque above rest, the ankle held."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from surae.base.units import FloatArray
from surae.inference.relaxed.rest import rest_of
from surae.signals import ModelInputs

#: Torque of an effort is its mean over so many seconds, where that is largest.
_HELD = 0.5
#: What turns less than this is held still: a strapped foot gives a few degrees [deg].
_STILL = 6.0
#: An effort is torque above this part of the trial's largest, for so many seconds; what comes to
#: less than so many Nm, or to less than this part of the group's largest EMG, is none.
_PART = 0.5
_LASTS = 0.3
_LEAST = 2.0
_PULLS = 0.3
#: Rest of a trial without any by its EMG: this part of it, in which EMG is least.
_QUIET = 0.05
#: Channels of EMG of each group, and the sign of its torque.
_GROUPS = {"tri": (slice(1, 4), 1.0), "tib": (slice(0, 1), -1.0)}


@dataclass(frozen=True, slots=True)
class Effort:
    """One effort of a group of muscles against a device that holds still."""

    trial: str  #: Name of its trial.
    group: str  #: ``"tri"`` or ``"tib"``.
    torque: float  #: Largest mean over half a second, less the torque at rest [Nm].
    angle: float  #: Where the ankle was held, by the device [deg].
    time: float  #: When it was largest [s].


def efforts_of(trials: Iterable[ModelInputs]) -> tuple[Effort, ...]:
    """Every effort in trials that hold still.

    Parameters
    ----------
    trials : iterable of ModelInputs
        Of maximal effort, as said or named; one that moves, or without a torque, has none.

    Returns
    -------
    tuple of Effort
        In the order of trials and time. No model is in them: torque of muscles that pull against
        each other is their difference.
    """
    return tuple(effort for trial in trials for effort in _efforts(trial))


def _efforts(trial: ModelInputs) -> list[Effort]:
    degrees = np.degrees(trial.angle)
    low, high = np.quantile(degrees, [0.01, 0.99])
    if trial.torque is None or high - low > _STILL:
        return []
    width = max(round(_HELD * trial.rate_hz), 1)
    torque = uniform_filter1d(np.asarray(trial.torque, dtype=float), width, mode="nearest")
    envelopes = uniform_filter1d(trial.emg, width, axis=0, mode="nearest")
    above = torque - _at_rest(trial, torque, envelopes)
    made = []
    for group, (channels, sign) in _GROUPS.items():
        pulled = sign * above
        activity = envelopes[:, channels].mean(axis=1)
        if pulled.max() < _LEAST:
            continue
        for first, last in _segments(pulled > _PART * pulled.max()):
            at = first + int(np.argmax(pulled[first:last]))
            works = not activity.max() > 0.0 or activity[at] > _PULLS * activity.max()
            if works and last - first >= _LASTS * trial.rate_hz:
                made.append(
                    Effort(
                        trial.name,
                        group,
                        float(pulled[at]),
                        float(degrees[at]),
                        float(trial.time[at]),
                    )
                )
    return made


def _at_rest(trial: ModelInputs, torque: FloatArray, envelopes: FloatArray) -> float:
    """Torque of the trial where its muscles rest, or rest most [Nm]."""
    rest = rest_of([trial])
    mask = rest.masks[0]
    if rest.by != "emg" or mask.sum() < _HELD * trial.rate_hz:
        level = (envelopes / np.maximum(envelopes.max(axis=0), 1e-300)).sum(axis=1)
        mask = level <= np.quantile(level, _QUIET)
    return float(np.median(torque[mask]))


def _segments(mask: np.ndarray) -> list[tuple[int, int]]:
    """Begins and ends of what is true without a break."""
    edges = np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))
    return list(
        zip(np.flatnonzero(edges > 0).tolist(), np.flatnonzero(edges < 0).tolist(), strict=True)
    )
