"""Fewer samples of prepared signals, for a first look at a costly model."""

from dataclasses import replace

import numpy as np

from surae.frozen import read_only
from surae.signals.inputs import ModelInputs
from surae.units import FloatArray


def thinned(inputs: ModelInputs, factor: int) -> ModelInputs:
    """Every `factor`-th sample of the inputs.

    EMG is averaged over the samples it stands for, which a low-pass activation filter cannot tell
    from the whole; motion and torque are taken as they are at the kept instants.

    Parameters
    ----------
    inputs : ModelInputs
        Prepared signals.
    factor : int
        At least 1; samples that do not fill the last group are left out.
    """
    groups = inputs.n // factor
    used = groups * factor

    def kept(signal: FloatArray) -> FloatArray:
        return read_only(signal[factor // 2 : used : factor])

    return replace(
        inputs,
        rate_hz=inputs.rate_hz / factor,
        time=kept(inputs.time),
        angle=kept(inputs.angle),
        velocity=kept(inputs.velocity),
        acceleration=kept(inputs.acceleration),
        emg=read_only(inputs.emg[:used].reshape(groups, factor, -1).mean(axis=1)),
        torque=None if inputs.torque is None else kept(inputs.torque),
        weight=None if inputs.weight is None else kept(inputs.weight),
        steps=(*inputs.steps, f"Thinned to every {factor}th sample."),
    )


def thinning_factor(inputs: ModelInputs, rate_hz: float, samples: int) -> int:
    """The largest factor by which a recording may be thinned.

    Parameters
    ----------
    inputs : ModelInputs
        The recording.
    rate_hz : float
        Rate that must be left [Hz].
    samples : int
        Number of samples that must be left.

    Returns
    -------
    int
        1 where nothing may be left out.
    """
    return max(1, min(int(np.floor(inputs.rate_hz / rate_hz)), inputs.n // samples))
