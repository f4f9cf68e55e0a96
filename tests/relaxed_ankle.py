"""A relaxed ankle of known curve, simulated without a line of what estimates it."""

from dataclasses import dataclass, replace

import numpy as np

from surae.recording import MUSCLES, Channel, Recording

RATE = 128.0
#: Share that relaxes with each time [s].
RELAXES = ((0.5, 0.1), (3.0, 0.2))


@dataclass(frozen=True)
class Ankle:
    """What the leg, its plate and its sensor are."""

    toe: float = -15.0  #: Where a linear–quadratic tissue begins [deg].
    stiff: float = 0.25  #: Its slope in the end [Nm/deg].
    weight: float = 2.8  #: Nm.
    inertia: float = 0.043  #: kg·m².
    zero: float = 4.0  #: Nm.
    tilt: float = 0.0  #: deg.
    reflex: float = 0.0  #: Torque per velocity [Nm·s/rad], late.
    noise: float = 0.1  #: Nm.

    def torque(self, degrees):
        """Relaxed torque [Nm], a toe of 20° and then a line; a weak opponent."""
        beyond = np.maximum(degrees - self.toe, 0.0)
        toe = 0.5 * np.minimum(beyond, 20.0) ** 2 / 20.0 + np.maximum(beyond - 20.0, 0.0)
        return self.stiff * toe - 0.3 * np.exp(-(degrees + 40.0) / 15.0)

    def stiffness(self, degrees):
        """Relaxed stiffness [Nm/deg]."""
        return (self.torque(degrees + 0.01) - self.torque(degrees - 0.01)) / 0.02


def movement(seconds=60.0, low=-40.0, high=20.0, rate=RATE):
    """Slow ramps with holds, then two quick ones: time [s], angle [deg]."""
    time = np.arange(round(seconds * rate)) / rate
    at = np.array([0.0, 2.0, 16.0, 22.0, 36.0, 40.0, 41.0, 45.0, 46.0, 50.0, 56.0, 60.0]) / 60.0
    to = np.array([0.0, 0.0, 1.0, 1.0, 0.1, 0.1, 0.9, 0.9, 0.2, 0.2, 0.8, 0.8])
    share = np.interp(time / seconds, at, to)
    width = round(0.15 * rate)
    kernel = np.hanning(2 * width + 1)
    padded = np.pad(share, width, mode="edge")
    return time, low + (high - low) * np.convolve(padded, kernel / kernel.sum(), mode="valid")


def slow_lags(elastic, rate):
    """What has not relaxed, by Euler steps ten times finer than the samples."""
    left = np.zeros_like(elastic)
    for tau, share in RELAXES:
        inner = elastic[0]
        for i in range(1, len(elastic)):
            inner += (elastic[i] - inner) * -np.expm1(-1.0 / (rate * tau))
            left[i] += share * (elastic[i] - inner)
    return left


def measured(ankle=Ankle(), seed=0, *, emg=None, moved=None, name="relaxed", beside=0.0):
    """A recording of it; `emg` (n, 4) in volts, `beside` a torque that is no tissue's [Nm]."""
    random = np.random.default_rng(seed)
    time, degrees = movement() if moved is None else moved
    rate = 1.0 / (time[1] - time[0])
    angle = np.radians(degrees)
    velocity = np.gradient(angle, time)
    elastic = ankle.torque(degrees)
    late = np.roll(np.maximum(velocity, 0.0), round(0.1 * rate))
    torque = (
        elastic
        + slow_lags(elastic, rate)
        + ankle.weight * np.cos(angle + np.radians(ankle.tilt))
        + ankle.inertia * np.gradient(velocity, time)
        + ankle.reflex * late
        + ankle.zero
        + beside
        + ankle.noise * random.standard_normal(len(time))
    )
    if emg is None:
        emg = np.zeros((len(time), 4))
    envelopes = emg + 2e-6 * (1.0 + 0.1 * random.standard_normal(emg.shape))
    signals = {"angle": (angle, "rad"), "torque": (torque, "Nm")}
    signals |= {f"emg_{m}": (envelopes[:, k], "V") for k, m in enumerate(MUSCLES)}
    channels = {
        role: Channel(role, time, values, unit, "simulated")
        for role, (values, unit) in signals.items()
    }
    return Recording(name, channels, emg="envelope")


def with_emg(recording, factor):
    """The same with all EMG times a factor."""
    return replace(
        recording,
        channels={
            role: replace(c, values=factor * c.values) if role.startswith("emg") else c
            for role, c in recording.channels.items()
        },
    )


def efforts(time, starts, seconds=2.0, top=2e-4):
    """Envelopes of the calf with efforts that begin at these times, shape (n, 4)."""
    emg = np.zeros((len(time), 4))
    for start in starts:
        inside = (time >= start) & (time < start + seconds)
        emg[inside, 1:] = top * np.sin(np.pi * (time[inside, None] - start) / seconds)
    return emg
