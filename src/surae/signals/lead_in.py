"""What was before a piece of a movement that repeats itself: what is at its own end.

A stride is cut from walking in which muscles were active before it, and a model that begins at rest
has no such effort in it: the first half of a stride of a second is then followed by whatever
parameters can. Where a piece ends as it began, its end stands before it too, and does not count.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.signals.inputs import ModelInputs
from surae.signals.normalise import smooth_effort

#: Time [s] in which a critically damped activation of 1.3 Hz forgets all but 2 %; a recording that
#: is shorter than so many times that counts whole.
SETTLING_S = 0.7
LONG = 4.0
#: Most by which angle and torque may differ at begin and end, in parts of their range, and the EMG
#: of an electrode, in parts of its largest: six strides of an adult differ by up to 0.08 and 0.2.
_ANGLE = 0.15
_EMG = 0.4


def led_in(recording: ModelInputs) -> ModelInputs:
    """A short recording with its end before it, where it ends as it began; else as it is.

    The samples before it have weight 0, and times before its first. One that has weights is as its
    user wants it, or led in already.
    """
    long = recording.n >= LONG * SETTLING_S * recording.rate_hz
    if long or recording.weight is not None or not _returns(recording):
        return recording
    count = min(round(SETTLING_S * recording.rate_hz), recording.n - 1)

    def longer(signal: FloatArray) -> FloatArray:
        """With its end before its begin; the last sample is the first of the next cycle."""
        return read_only(np.concatenate([signal[-count - 1 : -1], signal]))

    before = recording.time[0] + np.arange(-count, 0) / recording.rate_hz
    weights = np.concatenate([np.zeros(count), np.ones(recording.n)])
    motion: dict[str, Any] = {
        name: longer(getattr(recording, name)) for name in ("angle", "velocity", "acceleration")
    }
    return replace(
        recording,
        **motion,
        time=read_only(np.concatenate([before, recording.time])),
        emg=longer(recording.emg),
        torque=None if recording.torque is None else longer(recording.torque),
        second=tuple(map(longer, recording.second)),
        weight=read_only(weights),
        lead_in=(lasts := count / recording.rate_hz),
        steps=(*recording.steps, Message("made/led-in", seconds=lasts)),
    )


def _returns(recording: ModelInputs) -> bool:
    """Whether angle, torque and EMG end as they began."""
    signals = [recording.angle] + ([] if recording.torque is None else [recording.torque])
    if any(abs(each[-1] - each[0]) > _ANGLE * np.ptp(each) for each in signals):
        return False
    effort = smooth_effort(recording.emg.T, recording.rate_hz)
    return bool((np.abs(effort[:, -1] - effort[:, 0]) <= _EMG * effort.max(axis=1)).all())
