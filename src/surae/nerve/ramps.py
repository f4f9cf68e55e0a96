"""Slow and fast stretches in a recording: where they are, and when muscles answer them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfiltfilt

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.nerve.samples import (
    LIMITED,
    MISSING,
    filled,
    in_gaps,
    limited,
    measured,
    on_one_clock,
    runs,
)
from surae.recording import MUSCLES, Recording

#: A movement [rad/s], the range [rad] that makes it a stretch, and its hold afterwards [s].
MOVING = np.deg2rad(2.0)
RANGE = np.deg2rad(5.0)
HOLD = 0.2
#: Rate at which torque is taken apart [Hz], and what is smoothed away before [Hz].
RATE = 100.0
SMOOTH = 25.0
#: Rest before a stretch by which a burst is judged [s]; standard deviations over it, for as long as
#: a burst lasts at least [s] (Hodges and Bui 1996), and the least part of the trial's largest.
REST = 0.3
DEVIATIONS = 3.0
LASTS = 0.025
LEAST = 0.03
#: Time after a stretch ends in which a burst still counts [s].
AFTER = 0.1


@dataclass(frozen=True, slots=True)
class RampSpan:
    """One stretch by its samples."""

    begin: int  #: First sample of the movement.
    stop: int  #: Last.
    direction: int  #: 1 dorsiflexion, −1 plantarflexion.


@dataclass(frozen=True, slots=True)
class Stretched:
    """A recording at `rate`: signals, envelopes of its EMG, and its stretches."""

    name: str  #: Of its file.
    rate: float  #: [Hz]
    time: FloatArray  #: [s], shape (n,).
    angle: FloatArray  #: [rad], smoothed, shape (n,).
    torque: FloatArray  #: [Nm], shape (n,).
    emg: Mapping[str, FloatArray]  #: Envelopes by muscle, of 1 at the trial's largest, (n,).
    ramps: tuple[RampSpan, ...]  #: In order of time.
    unusable: FloatArray | None = None  #: Without numbers, or of limited torque.
    notes: tuple[str, ...] = ()  #: What was left out, a sentence each.

    @property
    def velocity(self) -> FloatArray:
        """[rad/s], shape (n,)."""
        return np.gradient(self.angle, 1.0 / self.rate)


def low(values: FloatArray, rate: float, cutoff: float) -> FloatArray:
    """Low-passed without delay."""
    sections = butter(2, min(cutoff, 0.45 * rate), fs=rate, output="sos")
    return np.asarray(sosfiltfilt(sections, values))


def at_rate(of: Stretched, values: FloatArray) -> FloatArray:
    """A signal at `RATE`, smoothed before."""
    at = np.arange(of.time[0], of.time[-1], 1.0 / RATE)
    return np.interp(at, of.time, low(values, of.rate, 0.4 * RATE))


def stretched(recording: Recording) -> Stretched:
    """Find the stretches of a recording.

    Raises
    ------
    InputError
        It has no torque or no stretch.
    """
    time, angle, torque, rate = on_one_clock(recording.where, *measured(recording))
    muscles = [m for m in MUSCLES if f"emg_{m}" in recording.channels]
    missing = ~np.isfinite(angle)
    for channel in (recording.channels[f"emg_{m}"] for m in muscles):
        missing |= in_gaps(channel.time[np.isfinite(channel.values)], time, 1.0 / rate)
    angle = filled(angle)
    torque = filled(torque)
    at_end = limited(angle, torque)
    left = missing | at_end
    hidden = 0
    smooth = low(angle, rate, SMOOTH)
    velocity = np.gradient(smooth, 1.0 / rate)
    ramps = []
    for direction in (1, -1):
        for run in runs(direction * velocity > MOVING):
            moved = direction * (smooth[run.stop - 1] - smooth[run.start])
            held = slice(run.stop, run.stop + round(HOLD * rate))
            still = np.abs(smooth[held] - smooth[run.stop - 1])
            if moved > RANGE and len(still) and float(still.max()) < 0.15 * moved:
                fast = direction * velocity[run] > 0.3 * float(np.max(direction * velocity[run]))
                moving = run.start + np.flatnonzero(fast)
                if left[moving[0] : moving[-1] + round(HOLD * rate)].any():
                    hidden += 1
                else:
                    ramps.append(RampSpan(int(moving[0]), int(moving[-1]), direction))
    kinds = ((missing, MISSING), (at_end, LIMITED))
    notes = [f"{of.sum() / rate:.2g} s {what}" for of, what in kinds if of.any()]
    if notes:
        notes = [f"Left out: {', '.join(notes)}; stretches left out with it: {hidden}"]
    if not ramps and hidden:
        raise InputError(
            f"{recording.where}: of no stretch is all there ({notes[0].lower()}); look why samples "
            "are missing, or raise the range of the torque’s channel"
        )
    if not ramps:
        raise InputError(
            f"{recording.where}: no stretch is in it: no movement of {np.rad2deg(RANGE):.0f}° or "
            "more ends in a hold; move the relaxed foot by ramps at several speeds, or use "
            "`surae impedance` for small random movements"
        )
    emg = {m: envelope(recording, m, time) for m in muscles}
    ramps.sort(key=lambda ramp: ramp.begin)
    name = recording.files[0].name if recording.files else recording.name
    return Stretched(
        name,
        rate,
        time,
        smooth,
        torque,
        emg,
        tuple(ramps),
        left if left.any() else None,
        tuple(notes),
    )


def envelope(recording: Recording, muscle: str, time: FloatArray) -> FloatArray:
    """Envelope of a muscle's EMG at times [s], raw EMG rectified and smoothed at 30 Hz."""
    channel = recording.channels[f"emg_{muscle}"]
    values = filled(channel.values)
    rate = channel.rate_hz
    if recording.emg == "raw":
        high = butter(2, 20.0, "high", fs=rate, output="sos")
        values = low(np.abs(sosfiltfilt(high, values)), rate, 30.0)
    return np.interp(time, channel.time, values)


def onset(of: Stretched, ramp: RampSpan, muscle: str, largest: float) -> int | None:
    """Sample at which a muscle's EMG begins to answer; None where it does not."""
    envelope = of.emg[muscle]
    rate = of.rate
    rest = envelope[max(ramp.begin - round(REST * rate), 0) : ramp.begin]
    if len(rest) < 3:
        return None
    level = float(rest.mean()) + max(DEVIATIONS * float(rest.std()), LEAST * largest)
    above = envelope[ramp.begin : ramp.stop + round(AFTER * rate)] > level
    first = next((r for r in runs(above) if r.stop - r.start >= LASTS * rate), None)
    return None if first is None else ramp.begin + int(first.start)
