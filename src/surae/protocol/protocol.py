"""A measurement protocol: settings in, the motion and the effort to ask for out."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from surae.errors import InputError
from surae.frozen import as_read_only, read_only
from surae.protocol.adaptation import Adaptation, Motion, fit_device, peaks, refusal
from surae.protocol.device import Device, allowed_range
from surae.protocol.effort import effort, named_task
from surae.protocol.profiles import base_range, chirp, named_profile
from surae.requests import MotionSettings
from surae.setting import documented
from surae.units import FloatArray

#: The motion is shaped on a grid at least this fine [Hz], a multiple of the rate asked for, so that
#: the extremes between two samples are seen and the result hardly depends on that rate.
_FINE_RATE = 2000.0


@documented
@dataclass(frozen=True, slots=True, kw_only=True)
class Protocol(MotionSettings):
    """Settings of a measurement protocol.

    Attributes
    ----------
    profile : str
        A name of `PROFILES`.
    device : Device or None
        Whose limits the motion must keep; None for no limits.
    {settings}

    Raises
    ------
    InputError
        A setting is out of its range.
    """

    profile: str
    device: Device | None = None

    def __post_init__(self) -> None:
        """Check the settings."""
        task = named_task(self.task)
        low, high = allowed_range(self.device, self.range_of_motion)
        _require(
            0.0 <= self.chirp_amplitude < 0.5 * (high - low),
            f"chirp amplitude {self.chirp_amplitude:g} rad: use 0 or more, and less than half the "
            f"range of motion ({0.5 * (high - low):g} rad)",
        )
        _require(0.0 < self.seconds < math.inf, f"duration {self.seconds:g} s: use more than 0 s")
        _require(
            0.0 < self.rate_hz < math.inf and self.seconds * self.rate_hz >= 2.0,
            f"rate {self.rate_hz:g} Hz: use one that gives three samples or more",
        )
        _require(
            math.isinf(task.passive_until) or task.passive_until < self.seconds,
            f"task {task.name!r} is passive to {task.passive_until:g} s, the whole of "
            f"{self.seconds:g} s; use a longer duration or task 'passive'",
        )
        if self.chirp_amplitude > 0.0:
            _require(
                0.0 < self.chirp_rate < math.inf,
                f"chirp rate {self.chirp_rate:g} Hz/s: use more than 0, or a chirp amplitude of 0",
            )
            _require(
                self.chirp_rate * self.seconds < 0.5 * self.rate_hz,
                f"the chirp ends at {self.chirp_rate * self.seconds:g} Hz, too fast for samples at "
                f"{self.rate_hz:g} Hz; use a rate above {2 * self.chirp_rate * self.seconds:g} Hz",
            )

    @property
    def seconds(self) -> float:
        """The duration, the profile's own unless it was given [s]."""
        own = named_profile(self.profile).duration
        return own if self.duration is None else self.duration


def _require(holds: bool, otherwise: str) -> None:
    if not holds:
        raise InputError(otherwise)


@dataclass(frozen=True, slots=True, kw_only=True)
class Given:
    """Settings of a movement that no profile made: it was designed, or read from a file."""

    #: `profile`, `task`: what movement and effort are called.
    profile: str
    task: str
    #: The subject's angles of full plantarflexion and full dorsiflexion [rad].
    range_of_motion: tuple[float, float]
    rate_hz: float  #: Sampling rate [Hz].
    device: Device | None = None  #: Whose limits it keeps; None where nothing is known of them.


@dataclass(frozen=True, slots=True)
class Trajectory:
    """What a protocol asks of the device and of the subject; arrays read-only."""

    settings: Protocol | Given  #: What it was generated from.
    time: FloatArray  #: Uniform time axis from 0 [s], shape (n,).
    #: `angle`, `velocity`, `acceleration`: ankle angle, dorsiflexion positive, and its derivatives
    #: [rad, rad/s, rad/s²], shape (n,).
    angle: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    effort: FloatArray  #: Target effort 0…1 of TA, GL, SOL, GM, shape (n, 4).
    #: What was changed for the device and what that cost; None without a device.
    adaptation: Adaptation | None = None

    def __post_init__(self) -> None:
        """Have no array written to."""
        for name in ("time", "angle", "velocity", "acceleration", "effort"):
            object.__setattr__(self, name, as_read_only(getattr(self, name)))

    @property
    def motion(self) -> Motion:
        """Angle, velocity and acceleration [rad, rad/s, rad/s²]."""
        return self.angle, self.velocity, self.acceleration


def generate(settings: Protocol) -> Trajectory:
    """The trajectory of a protocol; the same settings always give the same one.

    Raises
    ------
    InputError
        The device cannot follow the motion and `settings.adapt` is False; the message says by how
        much and what to do.
    """
    oversampling = math.ceil(_FINE_RATE / settings.rate_hz)
    fine_rate = settings.rate_hz * oversampling
    n = math.floor(settings.seconds * settings.rate_hz + 1e-9) + 1
    time, fine = _Grid(n, settings.rate_hz), _Grid((n - 1) * oversampling + 1, fine_rate)
    adaptation = None
    if settings.device is None:
        motion = _motion(settings, time, _base_range(settings, fine))
    else:
        adapted, adaptation = _adapted(settings, settings.device, fine)
        angle, velocity, acceleration = (signal[::oversampling] for signal in adapted)
        motion = angle, velocity, acceleration
    target = effort(time.time, named_task(settings.task))
    return Trajectory(settings, time.time, *motion, target, adaptation)


class _Grid(NamedTuple):
    """Equidistant times from 0."""

    n: int  #: Number of samples.
    rate_hz: float

    @property
    def time(self) -> FloatArray:
        """The times [s]."""
        return np.arange(self.n) / self.rate_hz


def _base_range(settings: Protocol, fine: _Grid) -> tuple[float, float]:
    """Angles on which the profile is mapped so that it spans the range together with the chirp."""
    if settings.chirp_amplitude == 0.0:
        return settings.range_of_motion
    added, _, _ = chirp(fine.time, amplitude=settings.chirp_amplitude, rate=settings.chirp_rate)
    fraction = _position(settings.profile, settings.seconds, fine)
    return base_range(fraction, added, settings.range_of_motion)


def _motion(settings: Protocol, grid: _Grid, base: tuple[float, float]) -> Motion:
    """Profile, mapped on the angles `base`, and chirp, with derivatives."""
    position, speed, speeding = _profile(settings.profile, settings.seconds, grid)
    added, added_velocity, added_acceleration = chirp(
        grid.time, amplitude=settings.chirp_amplitude, rate=settings.chirp_rate
    )
    low, gain = base[0], base[1] - base[0]
    return (
        low + gain * position + added,
        gain * speed + added_velocity,
        gain * speeding + added_acceleration,
    )


# What follows is asked for again and again as range, chirp and effort are adapted.


@lru_cache(maxsize=4)
def _position(name: str, seconds: float, grid: _Grid) -> FloatArray:
    """The profile over `seconds`, as a fraction."""
    profile = named_profile(name)
    return read_only(profile.position(grid.time * (profile.duration / seconds)))


@lru_cache(maxsize=4)
def _profile(name: str, seconds: float, grid: _Grid) -> Motion:
    """The profile over `seconds`, as a fraction, with derivatives by differences of the function.

    A profile is a smooth function known at every t, so fourth-order central differences over a
    millisecond serve: their error is below 1e-7 1/s and 1e-3 1/s².
    """
    profile = named_profile(name)
    stretch = profile.duration / seconds
    own, h = grid.time * stretch, 2e-4
    here = _position(name, seconds, grid)
    far_back, back, ahead, far_ahead = (profile.position(own + k * h) for k in (-2, -1, 1, 2))
    speed = (far_back - 8 * back + 8 * ahead - far_ahead) / (12 * h)
    speeding = (-far_back + 16 * back - 30 * here + 16 * ahead - far_ahead) / (12 * h**2)
    return here, read_only(stretch * speed), read_only(stretch**2 * speeding)


def _adapted(settings: Protocol, device: Device, fine: _Grid) -> tuple[Motion, Adaptation]:
    """The motion that the device can follow, or InputError if it may not be adapted."""
    wanted = _motion(settings, fine, _base_range(settings, fine))
    amplitude = device.chirp_amplitude(settings.profile, settings.chirp_amplitude)
    end_hz = settings.chirp_rate * settings.seconds if amplitude > 0.0 else 0.0
    if not settings.adapt:
        amplitude = settings.chirp_amplitude
        added = f"a chirp of {amplitude:g} rad" if end_hz > 0.0 else "no chirp"
        reason = refusal(device, wanted, end_hz)
        _require(
            reason is None,
            f"{settings.profile} with {added} {reason}; allow adaptation, or use a smaller or "
            "slower chirp or a longer duration",
        )
    used = replace(settings, chirp_amplitude=amplitude)
    motion = wanted if used == settings else _motion(used, fine, _base_range(used, fine))
    fitted = fit_device(
        device, motion, rate_hz=fine.rate_hz, highest_hz=end_hz,
        range_of_motion=settings.range_of_motion,
    )  # fmt: skip
    before, after = peaks(wanted), peaks(fitted.motion)
    low, high = settings.range_of_motion
    return fitted.motion, Adaptation(
        device=device.name,
        chirp_amplitude=(settings.chirp_amplitude, amplitude),
        chirp_end_amplitude=amplitude * fitted.response(end_hz),
        cutoff_hz=fitted.cutoff_hz,
        peak_velocity=(before[0], after[0]),
        peak_acceleration=(before[1], after[1]),
        span=(float(fitted.motion[0].max()) - float(fitted.motion[0].min())) / (high - low),
    )
