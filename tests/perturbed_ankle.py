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
        return {"time": t, "angle": angle + 0.1, "torque": torque}

    def recording(self, seed: int = 1) -> Recording:
        return Recording.from_arrays(**self.moved(seed), name="ankle")
