"""How a motion is adapted to a device, or refused (thesis 4.1.5, Figures 36 and 37).

The thesis low-pass filters a profile until its velocity stays under what the manipulator follows
without overshoot. Its filter is not printed; here it has the gain of a first-order Butterworth
filter, 1/√(1 + (f/fc)²), and no phase shift. A chirp of rising frequency then keeps its velocity
while its amplitude falls, as in those figures, where a steeper filter would remove it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surae.base.units import FloatArray
from surae.base.words import Message
from surae.protocol.device import Device

#: Angle, velocity and acceleration [rad, rad/s, rad/s²].
Motion = tuple[FloatArray, FloatArray, FloatArray]

#: Cut-off frequencies that are tried [Hz].
_LOWEST_CUTOFF = 0.02
_HIGHEST_CUTOFF = 100.0


@dataclass(frozen=True, slots=True)
class Adaptation:
    """What was changed for a device, and what that cost."""

    device: str  #: Name of the device.
    chirp_amplitude: tuple[float, float]  #: Amplitude asked for and used, before filtering [rad].
    #: What is left of it at the highest frequency, after filtering [rad].
    chirp_end_amplitude: float
    cutoff_hz: float | None  #: Cut-off of the low-pass filter; None when none was needed.
    #: `peak_velocity`, `peak_acceleration`: as asked for, and after adaptation [rad/s, rad/s²].
    peak_velocity: tuple[float, float]
    peak_acceleration: tuple[float, float]
    span: float  #: Share of the range of motion that is still reached, 0…1.

    @property
    def steps(self) -> tuple[Message, ...]:
        """One plain sentence per change; empty when nothing had to change."""
        steps = []
        wanted, used = self.chirp_amplitude
        if used < wanted:
            steps.append(Message("plan/chirp", wanted=wanted, used=used, device=self.device))
        if self.cutoff_hz is not None:
            before, after = self.peak_velocity
            steps.append(
                Message(
                    "plan/filtered",
                    hz=self.cutoff_hz,
                    device=self.device,
                    before=before,
                    after=after,
                )
            )
            if used > 0.0:
                steps.append(Message("plan/chirp-left", left=self.chirp_end_amplitude))
        if self.span < 0.999:
            steps.append(Message("plan/reached", percent=100 * self.span))
        return tuple(steps)


@dataclass(frozen=True, slots=True)
class AdaptedMotion:
    """A motion that a device can follow."""

    motion: Motion  #: Three arrays of shape (n,).
    cutoff_hz: float | None = None  #: Cut-off of the filter; None when the motion is as it was.
    gain: float = 1.0  #: Factor by which the filtered motion was then stretched or shrunk.

    def response(self, frequency_hz: float) -> float:
        """Factor by which a sine of that frequency was changed."""
        if self.cutoff_hz is None:
            return 1.0
        return self.gain * float(_filter_gain(np.array([frequency_hz]), self.cutoff_hz)[0])


def peaks(motion: Motion) -> tuple[float, float]:
    """Highest velocity and acceleration of a motion, either way [rad/s, rad/s²]."""
    return float(np.abs(motion[1]).max()), float(np.abs(motion[2]).max())


def fit_device(
    device: Device,
    motion: Motion,
    *,
    rate_hz: float,
    highest_hz: float,
    angle_range: tuple[float, float],
) -> AdaptedMotion:
    """The motion filtered until the device can follow it, still over the whole range if it can.

    The motion spans `angle_range` [rad]; where `highest_hz`, the highest frequency in it, is
    above the device's bandwidth, it is filtered at that. What the device follows stays as it is;
    else it is filtered with the highest cut-off that will do and stretched to the range again, or
    with the lowest and shrunk about mid-range until the limits hold.
    """
    if _excess(device, motion) <= 1.0 and highest_hz <= device.bandwidth:
        return AdaptedMotion(motion)

    spectrum = spectrum_of(motion[0])
    (low, high) = angle_range

    def filtered(cutoff_hz: float) -> AdaptedMotion:
        angle, velocity, acceleration = low_pass(spectrum, cutoff_hz, rate_hz)
        lowest = float(angle.min())
        gain = (high - low) / (float(angle.max()) - lowest)
        stretched = (low + gain * (angle - lowest), gain * velocity, gain * acceleration)
        return AdaptedMotion(stretched, cutoff_hz, gain)

    too_high = min(_HIGHEST_CUTOFF, device.bandwidth)
    best = filtered(too_high)
    if _excess(device, best.motion) > 1.0:
        cutoff = min(_LOWEST_CUTOFF, too_high)
        best = filtered(cutoff)
        while too_high / cutoff > 1.001:
            candidate = filtered(float(np.sqrt(cutoff * too_high)))
            assert candidate.cutoff_hz is not None
            if _excess(device, candidate.motion) <= 1.0:
                best = candidate
                cutoff = candidate.cutoff_hz
            else:
                too_high = candidate.cutoff_hz
    times = max(1.0, _excess(device, best.motion))
    middle = sum(angle_range) / 2
    angle, velocity, acceleration = best.motion
    shrunk = (middle + (angle - middle) / times, velocity / times, acceleration / times)
    return AdaptedMotion(shrunk, best.cutoff_hz, best.gain / times)


def refusal(device: Device, motion: Motion, highest_hz: float) -> str | None:
    """Say by how much a motion is too fast for a device; None if the device can follow it."""
    velocity, acceleration = peaks(motion)
    for value, limit, unit in (
        (velocity, device.max_velocity, "rad/s"),
        (acceleration, device.acceleration_limit, "rad/s2"),
        (highest_hz, device.bandwidth, "Hz"),
    ):
        if value > limit:
            return (
                f"reaches {value:.4g} {unit}, {value / limit:.3g} times the {limit:.4g} {unit} "
                f"that {device.name} follows"
            )
    return None


def spectrum_of(angle: FloatArray) -> NDArray[np.complex128]:
    """Spectrum of a motion continued by its mirror image at both ends, so it rests there."""
    return np.fft.rfft(np.concatenate([angle, angle[-2:0:-1]]))


def low_pass(spectrum: NDArray[np.complex128], cutoff_hz: float, rate_hz: float) -> Motion:
    """Zero-phase first-order low-pass of a motion, ÷√2 at `cutoff_hz`, with exact derivatives."""
    n = len(spectrum)
    frequency = np.arange(n, dtype=np.float64) * (rate_hz / (2 * n - 2))
    filtered = spectrum * _filter_gain(frequency, cutoff_hz)
    omega = 2j * np.pi * frequency
    position, velocity, acceleration = (
        np.fft.irfft(factor * filtered, 2 * n - 2)[:n] for factor in (1.0, omega, omega**2)
    )
    return position, velocity, acceleration


def _filter_gain(frequency: FloatArray, cutoff_hz: float) -> FloatArray:
    """Gain of a first-order Butterworth filter."""
    return 1.0 / np.sqrt(1.0 + (frequency / cutoff_hz) ** 2)


def _excess(device: Device, motion: Motion) -> float:
    """How many times a motion goes beyond the limits; at most 1 if it can be followed."""
    velocity, acceleration = peaks(motion)
    return max(velocity / device.max_velocity, acceleration / device.acceleration_limit)
