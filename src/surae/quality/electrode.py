"""An electrode that comes off during the trial: from there it hears the mains and no muscle."""

import numpy as np

from surae.quality.finding import Finding, Skipped
from surae.quality.mains import MAINS
from surae.quality.trial import Trial
from surae.quality.wording import muscle_name, quantity
from surae.recording import MUSCLES, Channel
from surae.units import FloatArray

#: Length of the pieces that are compared [s]: whole periods of both mains.
_PIECE = 0.5
#: Shortest time without contact [s].
_SHORTEST = 2.0
#: Part of a piece's power that the mains has where there is no muscle.
_SHARE = 0.5
#: The mains is so many times what it is in the rest of the trial: hum alone does not change.
_TIMES = 3.0


def off(trial: Trial) -> tuple[Finding, ...] | Skipped:
    """Channels that hear nothing but the mains from some instant to the end, and did not before."""
    emg = [trial.recording.channels.get(f"emg_{muscle}") for muscle in MUSCLES]
    fast = [c for c in emg if c is not None and c.rate_hz > 2.2 * MAINS[-1]]
    if trial.emg_kind != "raw" or not fast:
        return Skipped("electrode-off", "Only raw EMG shows it.")
    return tuple(finding for channel in fast if (finding := _off(channel)) is not None)


def _off(channel: Channel) -> Finding | None:
    size = round(_PIECE * channel.rate_hz)
    count = len(channel.values) // size
    if count * _PIECE < 2.0 * _SHORTEST:
        return None
    pieces = channel.values[: count * size].reshape(count, size)
    pieces = pieces - pieces.mean(axis=1, keepdims=True)
    power = np.mean(pieces**2, axis=1)
    hum, mains = max(
        ((_amplitude(pieces, f / channel.rate_hz), f) for f in MAINS),
        key=lambda amplitude_and_mains: float(amplitude_and_mains[0].sum()),
    )
    alone = 0.5 * hum**2 > _SHARE * np.maximum(power, np.finfo(float).tiny)
    first, last = _longest(alone)
    inside = np.zeros(count, dtype=bool)
    inside[first:last] = True
    if (last - first) * _PIECE < _SHORTEST or inside.all():
        return None
    before, now = float(np.median(hum[~inside])), float(np.median(hum[inside]))
    if now < _TIMES * before or first == 0 or (count - last) * _PIECE >= _SHORTEST:
        return None  # one that hears its muscle again has not come off
    start = float(channel.time[first * size])
    muscle = muscle_name(channel.role.removeprefix("emg_"))
    return Finding(
        "electrode-off",
        "error",
        channel.role,
        start,
        float(channel.time[min(last * size, len(channel.time) - 1)]),
        now,
        channel.unit,
        f"The electrode of the {muscle} seems to have come off at {start:.0f} s: from there it "
        f"hears little but the mains, {quantity(now, channel)} at {mains:.0f} Hz.",
        "Fix the electrode, look at its signal while the muscle works, and record again.",
    )


def _amplitude(pieces: FloatArray, cycles: float) -> FloatArray:
    """Amplitude of a line in each piece; `cycles` per sample."""
    wave = np.exp(-2j * np.pi * cycles * np.arange(pieces.shape[1]))
    amplitude: FloatArray = 2.0 * np.abs(pieces @ wave) / pieces.shape[1]
    return amplitude


def _longest(marked: np.ndarray) -> tuple[int, int]:
    """The longest run of marked pieces, from and to."""
    edges = np.flatnonzero(np.diff(np.r_[False, marked, False].astype(int)))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return 0, 0
    first, last = runs[int(np.argmax(runs[:, 1] - runs[:, 0]))]
    return int(first), int(last)
