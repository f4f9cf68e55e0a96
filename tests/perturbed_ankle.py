"""A simulated ankle, moved at random: relaxing tissue, a delayed reflex, drift and noise."""

from dataclasses import dataclass

import numpy as np
from scipy import signal

from surae.recording import Recording


@dataclass(frozen=True)
class Ankle:
    """Parameters in SI units; torque positive when it resists dorsiflexion."""

    stiffness: float = 60.0
    viscosity: float = 0.8
    inertia: float = 0.015
    branch: float = 0.0
    time: float = 0.02
    gain: float = 6.0
    delay: float = 0.045
    omega: float = 18.0
    zeta: float = 0.8
    direction: int = 1
    noise: float = 0.1
    seconds: float = 40.0
    rate: float = 500.0
    switch: float = 0.2

    def moved(self, seed: int = 1) -> dict[str, np.ndarray]:
        """Time, angle and torque."""
        draw, n = np.random.default_rng(seed), round(self.seconds * self.rate)
        t = np.arange(n) / self.rate
        ends = np.cumsum(draw.uniform(0.5, 1.5, n) * self.switch)
        steps = draw.choice([-1.0, 1.0], n)[np.searchsorted(ends, t)]
        b, a = signal.bilinear([120.0**2], [1.0, 1.6 * 120.0, 120.0**2], self.rate)
        edge = np.clip(np.minimum(t, t[-1] - t) / 0.2, 0.0, 1.0)
        angle = signal.lfilter(b, a, 0.015 * steps) * (0.5 - 0.5 * np.cos(np.pi * edge))
        s = 2j * np.pi * np.fft.rfftfreq(n, 1.0 / self.rate)
        spectrum = np.fft.rfft(angle)
        tissue = self.stiffness + self.viscosity * s + self.inertia * s**2
        tissue = tissue + self.branch * s * self.time / (1.0 + s * self.time)
        velocity = np.fft.irfft(s * spectrum, n)
        stretch = self.direction * np.maximum(self.direction * velocity, 0.0)
        muscle = self.omega**2 / (s**2 + 2.0 * self.zeta * self.omega * s + self.omega**2)
        reflex = self.gain * np.fft.rfft(stretch) * muscle * np.exp(-s * self.delay)
        torque = np.fft.irfft(spectrum * tissue + reflex, n)
        drift = np.cumsum(draw.standard_normal(n))
        torque += 0.5 * self.noise * (drift - drift.mean()) / drift.std() + 3.0
        torque += self.noise * draw.standard_normal(n)
        shown = angle + 0.1 + 1e-6 * np.random.default_rng([seed, 1]).standard_normal(n)
        return {"time": t, "angle": shown, "torque": torque}  # a sensor that has some noise

    def recording(self, seed: int = 1) -> Recording:
        return Recording.from_arrays(**self.moved(seed), name="ankle")


def ramps(
    speeds,
    *,
    neural=0.0,
    emg=True,
    seed=1,
    returning=30.0,
    rate=500.0,
    relaxes=0.0,
    seconds=0.1,
    begins=5.0,
) -> Recording:
    """A calf stretched from −20 to 10° at `speeds` [°/s]; a reflex of `neural` Nm from 60°/s on.

    Its EMG begins 30 ms after the foot passes `begins` − 0.05 s·velocity; tissue has 20 Nm/rad, 0.3
    Nm·s/rad and 0.02 kg·m², and `relaxes` Nm/rad that relax in `seconds`.
    """
    draw, angle, onsets, n = np.random.default_rng(seed), [], [], 0
    low, high = -20.0, 10.0
    for speed in speeds:
        up = np.arange(low, high, speed / rate)
        down = np.arange(high, low, -(returning or 30.0) / rate)
        holds = (np.full(round(1.0 * rate), low), up, np.full(round(2.0 * rate), high), down)
        if neural and speed >= 60.0:
            passed = round((begins - 0.05 * speed - low) / speed * rate)
            onsets.append(n + len(holds[0]) + passed + round(0.03 * rate))
        angle.extend(holds)
        n += sum(map(len, holds))
    b, a = signal.butter(2, 30.0, fs=rate)
    x = np.deg2rad(signal.filtfilt(b, a, np.concatenate([*angle, np.full(round(rate), low)])))
    t = np.arange(len(x)) / rate
    v = np.gradient(x, t)
    torque = 20.0 * x + 0.3 * v + 0.02 * np.gradient(v, t) + 0.05 * draw.standard_normal(len(t))
    slow = np.exp(-1.0 / (rate * seconds))
    torque += relaxes * signal.lfilter([slow, -slow], [1.0, -slow], x - x[0])
    envelope = 1e-7 * np.abs(draw.standard_normal(len(t)))
    keep = np.exp(-25.0 / rate)
    burst, step = np.zeros(len(t)), np.arange(round(0.12 * rate))
    for at in onsets:
        burst[at + step] = np.sin(np.pi * step / len(step))
    force = signal.lfilter([(1.0 - keep) ** 2], [1.0, -2.0 * keep, keep**2], burst)
    if onsets:
        torque += neural * force / force.max()
    channels = {"emg": np.outer(envelope + 1e-4 * burst, [0.0, 1.0, 1.0, 1.0])} if emg else {}
    return Recording.from_arrays(t, x, torque, name="ramps", emg_kind="envelope", **channels)
