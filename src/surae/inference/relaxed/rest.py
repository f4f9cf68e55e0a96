"""Where a leg rests: its EMG near its electrodes' noise, by what the leg itself can do."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import uniform_filter1d

from surae.base.units import FloatArray
from surae.recording import MUSCLES
from surae.signals import ModelInputs

Mask = npt.NDArray[np.bool_]

#: Part of an electrode's range, from its noise to the leg's largest, below which a muscle rests:
#: torque of it is then below a tenth of what the relaxed ankle itself has; measured legs and
#: virtual ones of two generators.
REST_SHARE = 0.05
#: EMG is averaged over this [s]; its noise is this part of all samples of the quietest trial, its
#: largest that of any.
_AVERAGED = 0.1
_NOISE = 0.05
_LARGEST = 0.995
#: Largest over noise from which an electrode shows effort at all: rectified noise has 1.6 (as
#: `quality/activity.py`).
_VARIES = 3.0
#: Seconds before an effort is seen, and after it, that are no rest: force precedes no EMG by more
#: than a filter's width, and lets go within 1.5 s (Cavanagh and Komi 1979; activation at 2 Hz).
_BEFORE = 0.3
_AFTER = 1.5
#: Part of a trial in which EMG is above rest from which on the muscle never rests there.
_TONIC = 0.9


@dataclass(frozen=True, slots=True)
class Rest:
    """Where each trial rests."""

    masks: tuple[Mask, ...]  #: By sample of each trial.
    by: str  #: ``"emg"``, or ``"declared"`` where no electrode shows any effort.
    tonic: tuple[str, ...]  #: Names of trials in which a muscle never comes to rest.
    #: What electrodes show as parts of the leg's largest: of calf and tibialis, shapes (n, 2); 0
    #: where none shows any effort.
    shares: tuple[FloatArray, ...]
    #: What each electrode shows of rest in the loudest trial, its median, by muscle: of trials
    #: without any effort nothing else says whether another visit rested as much.
    levels: tuple[tuple[str, float], ...] = ()


def rest_of(trials: Sequence[ModelInputs]) -> Rest:
    """Where the trials of one leg rest.

    Each envelope less its electrode's noise is compared with the leg's largest of that muscle over
    all trials, so that no scale of EMG matters. Where no muscle shows effort in any trial, rest is
    as it was declared: all of it.
    """
    envelopes = [_smoothed(trial) for trial in trials]
    usable = [
        index
        for index, muscle in enumerate(MUSCLES)
        if any(muscle not in trial.missing_emg for trial in trials)
    ]
    groups = [np.zeros((trial.n, 2)) for trial in trials]
    by = "declared"
    for index in usable:
        having = [k for k, trial in enumerate(trials) if MUSCLES[index] not in trial.missing_emg]
        noise = min(float(np.quantile(envelopes[k][:, index], _NOISE)) for k in having)
        top = max(float(np.quantile(envelopes[k][:, index], _LARGEST)) for k in having)
        if not top > max(_VARIES * noise, 0.0):
            continue
        by = "emg"
        for k in having:
            share = (envelopes[k][:, index] - noise) / (top - noise)
            side = int(MUSCLES[index] == "ta")
            groups[k][:, side] = np.maximum(groups[k][:, side], share)
    above = [each.max(axis=1) for each in groups]
    masks = tuple(
        _guarded(share > REST_SHARE, trial.rate_hz)
        for share, trial in zip(above, trials, strict=True)
    )
    tonic = tuple(
        trial.name
        for share, trial in zip(above, trials, strict=True)
        if (share > REST_SHARE).mean() > _TONIC
    )
    resting = tuple(~mask for mask in masks)
    return Rest(resting, by, tonic, tuple(groups), _levels(trials, envelopes, resting))


def _levels(
    trials: Sequence[ModelInputs], envelopes: Sequence[FloatArray], resting: Sequence[Mask]
) -> tuple[tuple[str, float], ...]:
    """Median of each electrode while the leg rests, in the loudest trial that has it."""
    made = []
    for index, muscle in enumerate(MUSCLES):
        shown = [
            float(np.median(envelope[mask, index]))
            for trial, envelope, mask in zip(trials, envelopes, resting, strict=True)
            if muscle not in trial.missing_emg and mask.any()
        ]
        if shown:
            made.append((muscle, max(shown)))
    return tuple(made)


def _smoothed(trial: ModelInputs) -> FloatArray:
    width = max(round(_AVERAGED * trial.rate_hz), 1)
    return np.asarray(uniform_filter1d(trial.emg, width, axis=0, mode="nearest"))


def _guarded(active: Mask, rate_hz: float) -> Mask:
    """An effort, and what is before and after it."""
    edges = np.diff(np.concatenate([[0], active.astype(np.int8), [0]]))
    wide = active.copy()
    before = round(_BEFORE * rate_hz)
    after = round(_AFTER * rate_hz)
    for first, last in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
        wide[max(first - before, 0) : last + after] = True
    return wide
