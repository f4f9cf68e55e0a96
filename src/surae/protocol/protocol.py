"""A measurement protocol: settings in, the motion and the effort to ask for out."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import as_read_only, read_only
from surae.base.requests import MotionSettings
from surae.base.setting import documented, renamed
from surae.base.units import FloatArray
from surae.protocol.adaptation import Adaptation, Motion, fit_device, peaks, refusal
from surae.protocol.device import Device, allowed_range
from surae.protocol.effort import Task, effort, named_task
from surae.protocol.profiles import base_range, chirp, named_profile

#: The motion is shaped on a grid at least this fine [Hz], a multiple of the rate asked for, so that
#: the extremes between two samples are seen and the result hardly depends on that rate.
_FINE_RATE = 2000.0
#: More samples than this, ten minutes at 2 kHz, are a slip of the keyboard.
_MOST_SAMPLES = 1_200_000


@renamed(range_of_motion="angle_range")
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
    legs : str
        Model of the virtual legs by which its torque is judged; a designed movement may have
        others.
    {settings}

    Raises
    ------
    InputError
        A setting is out of its range.
    """

    profile: str
    device: Device | None = None
    legs: ClassVar[str] = "muscle"

    def __post_init__(self) -> None:
        """Check the settings."""
        object.__setattr__(self, "turns", tuple(self.turns))  # a list serves too
        task = self.effort_task
        seconds = self.seconds
        rate = self.rate_hz
        amplitude = self.chirp_amplitude
        rise = self.chirp_rate
        low, high = allowed_range(self.device, self.angle_range)
        chirps = amplitude > 0.0
        for wrong, what in (
            (
                not 0.0 <= amplitude < 0.5 * (high - low),
                f"chirp amplitude {amplitude:g} rad: use 0 or more, and less than "
                f"half the range of "
                f"motion ({0.5 * (high - low):g} rad)",
            ),
            (not 0.0 < seconds < math.inf, f"duration {seconds:g} s: use more than 0 s"),
            (
                not (0.0 < rate < math.inf and seconds * rate >= 2.0),
                f"rate {rate:g} Hz: use one that gives three samples or more",
            ),
            (
                seconds <= task.passive_until < math.inf,
                f"task {task.name!r} is passive to {task.passive_until:g} s, the "
                f"whole of {seconds:g} "
                "s; use a longer duration or task 'passive'",
            ),
            (
                chirps and not 0.0 < rise < math.inf,
                f"chirp rate {rise:g} Hz/s: use more than 0, or a chirp amplitude of 0",
            ),
            (
                chirps and rise * seconds >= 0.5 * rate,
                f"the chirp ends at {rise * seconds:g} Hz, too fast for samples "
                f"at {rate:g} Hz; use a "
                f"rate above {2 * rise * seconds:g} Hz",
            ),
        ):
            if wrong:
                raise InputError(what)

    @property
    def effort_task(self) -> Task:
        """The effort task, with the passive part and the turns that were given."""
        return named_task(self.task).with_own(self.passive_seconds, self.turns)

    @property
    def seconds(self) -> float:
        """The duration, the profile's own unless it was given [s]."""
        usual = named_profile(self.profile).duration
        return usual if self.duration is None else self.duration


@dataclass(frozen=True, slots=True, kw_only=True)
class Given:
    """Settings of a movement that no profile made: it was designed, or read from a file."""

    #: `profile`, `task`: what movement and effort are called.
    profile: str
    task: str
    #: The subject's angles of full plantarflexion and full dorsiflexion [rad].
    angle_range: tuple[float, float]
    rate_hz: float  #: Sampling rate [Hz].
    device: Device | None = None  #: Whose limits it keeps; None where nothing is known of them.
    legs: str = "muscle"  #: Model of the virtual legs by which its torque is judged.


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

    Parameters
    ----------
    settings : Protocol
        Motion, effort and device.

    Returns
    -------
    Trajectory
        Angle and effort over time.

    Raises
    ------
    InputError
        It has too many samples, or the device cannot follow the motion and `settings.adapt` is
        False; the message says by how much and what to do.

    Examples
    --------
    >>> protocol = surae.Protocol(profile="multi-sine", duration=20.0)
    >>> surae.generate(protocol).angle.max()
    """
    longest = _MOST_SAMPLES / max(settings.rate_hz, _FINE_RATE)
    if settings.seconds > longest:
        raise InputError(
            f"{settings.seconds:g} s at {settings.rate_hz:g} Hz are too many samples; use at most "
            f"{longest:g} s at that rate"
        )
    oversampling = math.ceil(_FINE_RATE / settings.rate_hz)
    fine_rate = settings.rate_hz * oversampling
    n = math.floor(settings.seconds * settings.rate_hz + 1e-9) + 1
    grid = (n, settings.rate_hz)
    fine = ((n - 1) * oversampling + 1, fine_rate)
    time = _times(grid)
    adaptation = None
    if settings.device is None:
        motion = _motion(settings, grid, fine)
    else:
        adapted, adaptation = _adapted(settings, settings.device, fine)
        angle, velocity, acceleration = (signal[::oversampling] for signal in adapted)
        motion = angle, velocity, acceleration
    target = effort(time, settings.effort_task)
    return Trajectory(settings, time, *motion, target, adaptation)


#: Number and rate [Hz] of equidistant times from 0.
_Grid = tuple[int, float]


def _times(grid: _Grid) -> FloatArray:
    return np.arange(grid[0]) / grid[1]


def _motion(settings: Protocol, grid: _Grid, fine: _Grid) -> Motion:
    """Profile and chirp, with derivatives; on the fine grid both together span the range."""
    low, high = settings.angle_range
    how = {"amplitude": settings.chirp_amplitude, "rate": settings.chirp_rate}
    if settings.chirp_amplitude > 0.0:
        fraction = _position(settings.profile, settings.seconds, fine)
        low, high = base_range(fraction, chirp(_times(fine), **how)[0], settings.angle_range)
    position, speed, speeding = _profile(settings.profile, settings.seconds, grid)
    added, added_speed, added_speeding = chirp(_times(grid), **how)
    gain = high - low
    angle = low + gain * position + added
    return angle, gain * speed + added_speed, gain * speeding + added_speeding


# What follows is asked for again and again as range, chirp and effort are adapted.


@lru_cache(maxsize=4)
def _position(name: str, seconds: float, grid: _Grid) -> FloatArray:
    """The profile over `seconds`, as a fraction."""
    profile = named_profile(name)
    return read_only(profile.position(_times(grid) * (profile.duration / seconds)))


@lru_cache(maxsize=4)
def _profile(name: str, seconds: float, grid: _Grid) -> Motion:
    """The profile over `seconds`, as a fraction, with derivatives by differences of the function.

    A profile is a smooth function known at every t, so fourth-order central differences over a
    millisecond serve: their error is below 1e-7 1/s and 1e-3 1/s².
    """
    profile = named_profile(name)
    stretch = profile.duration / seconds
    times = _times(grid) * stretch
    h = 2e-4
    here = _position(name, seconds, grid)
    far_back, back, ahead, far_ahead = (profile.position(times + k * h) for k in (-2, -1, 1, 2))
    speed = (far_back - 8 * back + 8 * ahead - far_ahead) / (12 * h)
    speeding = (-far_back + 16 * back - 30 * here + 16 * ahead - far_ahead) / (12 * h**2)
    return here, read_only(stretch * speed), read_only(stretch**2 * speeding)


def _adapted(settings: Protocol, device: Device, fine: _Grid) -> tuple[Motion, Adaptation]:
    """The motion that the device can follow, or InputError if it may not be adapted."""
    wanted = _motion(settings, fine, fine)
    amplitude = device.chirp_amplitude(settings.profile, settings.chirp_amplitude)
    end_hz = settings.chirp_rate * settings.seconds if amplitude > 0.0 else 0.0
    if not settings.adapt:
        amplitude = settings.chirp_amplitude
        added = f"a chirp of {amplitude:g} rad" if end_hz > 0.0 else "no chirp"
        if reason := refusal(device, wanted, end_hz):
            raise InputError(
                f"{settings.profile} with {added} {reason}; allow adaptation, or use a smaller or "
                "slower chirp or a longer duration"
            )
    used = replace(settings, chirp_amplitude=amplitude)
    motion = wanted if used == settings else _motion(used, fine, fine)
    fitted = fit_device(
        device,
        motion,
        rate_hz=fine[1],
        highest_hz=end_hz,
        angle_range=settings.angle_range,
    )
    before = peaks(wanted)
    after = peaks(fitted.motion)
    low, high = settings.angle_range
    span = (float(fitted.motion[0].max()) - float(fitted.motion[0].min())) / (high - low)
    return fitted.motion, Adaptation(
        device.name,
        (settings.chirp_amplitude, amplitude),
        amplitude * fitted.response(end_hz),
        fitted.cutoff_hz,
        (before[0], after[0]),
        (before[1], after[1]),
        span,
    )
