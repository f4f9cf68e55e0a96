"""EMG after stretches of a perturbed recording, averaged: a check of the reflex by its own sign."""

import numpy as np

from surae.base.units import FloatArray
from surae.base.words import N_, Message
from surae.nerve.ramps import envelope
from surae.nerve.samples import Samples, runs
from surae.recording import MUSCLE_NAMES, MUSCLES, Recording

#: Speed as a part of the fastest at which a stretch begins, and what is slow before [s].
BEGINS = 0.3
SLOW_BEFORE = 0.03
#: Fewest stretches of an average; time before it that is rest, and after it when a reflex of the
#: ankle is seen [s] (short latency from 30 ms: Sinkjaer 1996).
FEWEST = 20
REST = 0.05
SEEN = (0.02, 0.12)
#: Standard errors above rest for at least this time [s].
ERRORS = 4.0
LASTS = 0.008


def answering(recording: Recording, samples: Samples, direction: int) -> str:
    """What EMG does after stretches to a direction, a sentence; empty without EMG or stretches."""
    muscles = [m for m in MUSCLES if f"emg_{m}" in recording.channels]
    starts = _starts(samples, direction)
    if not muscles or len(starts) < FEWEST:
        return ""
    latencies = {
        m: _latency(envelope(recording, m, samples.time), starts, samples.rate_hz) for m in muscles
    }
    heard = [f"{MUSCLE_NAMES[m]} {1e3 * s:.0f} ms" for m, s in latencies.items() if s is not None]
    way = "dorsiflexion" if direction > 0 else "plantarflexion"
    if heard:
        return Message(
            N_("EMG answers stretch to {way}, mean of {n}: {muscles}."),
            way=Message(way),
            n=str(len(starts)),
            muscles=", ".join(heard),
        )
    return Message(
        N_("No EMG that was recorded answers {n} stretches to {way} in their mean."),
        way=Message(way),
        n=str(len(starts)),
    )


def _starts(samples: Samples, direction: int) -> list[int]:
    """Samples at which a fast stretch begins after rest."""
    rate = samples.rate_hz
    starts = []
    short = max(round(0.005 * rate), 1)
    for span in samples.spans:
        angle = np.convolve(samples.angle[span], np.ones(short) / short, "same")
        speed = direction * np.gradient(angle, 1.0 / rate)
        fast = speed > BEGINS * float(np.quantile(speed, 0.995))
        before = round(max(REST, SLOW_BEFORE) * rate)
        after = round(SEEN[1] * rate)
        for run in runs(fast):
            slow = speed[max(run.start - round(SLOW_BEFORE * rate), 0) : run.start]
            inside = before < run.start < len(angle) - after
            if inside and np.mean(np.abs(slow)) < 0.5 * speed[run].max():
                starts.append(span.start + run.start)
    return starts


def _latency(emg: FloatArray, starts: list[int], rate: float) -> float | None:
    """Time after which the mean of stretches exceeds rest [s]; None where it does not."""
    rest = round(REST * rate)
    last = round(SEEN[1] * rate)
    each = np.stack([emg[at - rest : at + last] for at in starts])
    each = each - each[:, :rest].mean(axis=1, keepdims=True)
    z = each.mean(axis=0) / (each.std(axis=0, ddof=1) / np.sqrt(len(each)) + 1e-300)
    first = rest + round(SEEN[0] * rate)
    least = max(round(LASTS * rate), 2)
    late = next((r for r in runs(z[first:] > ERRORS) if r.stop - r.start >= least), None)
    return None if late is None else (first + late.start - rest) / rate
