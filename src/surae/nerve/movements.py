"""Movements that tell tissue from nerve: small random perturbations, and series of stretches.

Perturbations go about the middle of the range: a pseudo-random binary sequence, random steps of
random size (PRALDS, Kearney and others 1997), or sines of all frequencies at once. Stretches go
through most of the range, at several speeds, each repeated, after waits that nobody can foresee.
"""

import math
from collections.abc import Callable

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.protocol.adaptation import Adaptation, fit_device, peaks
from surae.protocol.device import Device
from surae.protocol.profiles import smooth_step
from surae.protocol.protocol import Given, Trajectory

#: Length of a perturbation [s], and its size from end to end [rad].
SECONDS = 60.0
SIZE = 0.03
#: Time between changes of a binary sequence [s], and of random steps (Mirbagheri and others 2000).
SWITCH = 0.15
WAITS = (0.2, 0.4)
#: Period [s] of the sines, their frequencies [Hz], and that from which they grow smaller [Hz].
PERIOD = 20.0
TONES = (0.25, 20.0)
KNEE = 2.0
#: Time in which a step, or the speed of a stretch, is reached [s]: torque must not jump.
RISE = 0.04
#: Speeds of stretches [rad/s] (10 to 200 °/s; slower where the device is), and repeats of each.
SPEEDS = tuple(np.deg2rad((10.0, 60.0, 100.0, 150.0, 200.0)))
REPEATS = 4
#: Part of the device's highest speed that a stretch has at most.
OF_FASTEST = 0.9
#: Ends of stretches as parts of the range: at its dorsiflexed end a stiff leg overloads the device.
ENDS = (0.1, 0.8)
#: Hold after a stretch, wait before the next [s], and speed of the way back [rad/s].
HOLDS = (2.0, 3.5)
RESTS = (2.5, 6.0)
BACK = 0.3
#: Rate at which a movement is shaped [Hz].
_FINE = 2000.0


def _steps(draw: np.random.Generator, waits: tuple[float, float], binary: bool) -> FloatArray:
    """Positions between −½ and ½ that change after waits, over `SECONDS`."""
    n = round(SECONDS * _FINE)
    ends = np.cumsum(draw.uniform(*waits, math.ceil(SECONDS / waits[0]) + 1))
    to = draw.choice((-0.5, 0.5), len(ends)) if binary else draw.uniform(-0.5, 0.5, len(ends))
    return to[np.searchsorted(ends, np.arange(n) / _FINE)]


def _prbs(draw: np.random.Generator) -> FloatArray:
    return _steps(draw, (SWITCH, SWITCH), binary=True)


def _pralds(draw: np.random.Generator) -> FloatArray:
    return _steps(draw, WAITS, binary=False)


def _multisine(draw: np.random.Generator) -> FloatArray:
    """Sines over a period whose phases are drawn: the flattest of 50 draws."""
    f = np.fft.rfftfreq(round(PERIOD * _FINE), 1.0 / _FINE)
    used = (f >= TONES[0]) & (f <= TONES[1])
    size = np.where(used, 1.0 / (1.0 + f / KNEE), 0.0)
    drawn = (np.fft.irfft(size * np.exp(2j * np.pi * draw.random(len(f)))) for _ in range(50))
    best = min(drawn, key=lambda x: np.abs(x).max() / x.std())
    return np.resize(best / np.ptp(best), round(SECONDS * _FINE))


PERTURBATIONS: dict[str, Callable[[np.random.Generator], FloatArray]] = {
    "prbs": _prbs,
    "pralds": _pralds,
    "multisine": _multisine,
}


def _stretches(draw: np.random.Generator, width: float, fastest: float) -> FloatArray:
    """Positions from 0 to `width` [rad]: slow stretches first, then all speeds in random order."""
    speeds = np.unique(np.minimum(SPEEDS, OF_FASTEST * fastest))
    if len(speeds) < 2:
        raise InputError("stretches: the device is too slow for two speeds")
    order = [*speeds[:1].repeat(REPEATS), *draw.permutation(speeds[1:].repeat(REPEATS))]
    times = [0.0]
    places = [0.0]
    for speed in order:
        for seconds, place in (
            (draw.uniform(*RESTS), 0.0),
            (width / speed, width),
            (draw.uniform(*HOLDS), width),
            (width / BACK, 0.0),
        ):
            times.append(times[-1] + seconds)
            places.append(place)
    grid = np.arange(round((times[-1] + 1.0) * _FINE)) / _FINE
    return np.interp(grid, times, places)


def telling(
    name: str,
    device: Device | None,
    angle_range: tuple[float, float],
    rate_hz: float,
    seed: int = 1,
) -> Trajectory:
    """A perturbation or a series of stretches, within a device's limits.

    Parameters
    ----------
    name : {"prbs", "pralds", "multisine", "stretches"}
        What it is.
    device : Device or None
        Whose limits it keeps.
    angle_range : (float, float)
        Perturbations go about its middle, stretches from near its one end to the other [rad].
    rate_hz : float
        Sampling rate [Hz].
    seed : int
        Of what is random: the same seed gives the same movement.

    Raises
    ------
    InputError
        The device is too slow for stretches at two speeds.
    """
    low, high = angle_range
    draw = np.random.default_rng(seed)
    if name in PERTURBATIONS:
        half = min(0.5 * SIZE, 0.5 * (high - low))
        low, high = 0.5 * (low + high) - half, 0.5 * (low + high) + half
        asked = PERTURBATIONS[name](draw)
        asked = low + (high - low) * (asked - asked.min()) / np.ptp(asked)
    else:
        low, high = (low + part * (high - low) for part in ENDS)
        asked = low + _stretches(draw, high - low, device.max_velocity if device else math.inf)
    edge = smooth_step(np.arange(round(RISE * _FINE) + 1) / (RISE * _FINE))
    asked = np.concatenate([np.full(len(edge), asked[0]), asked, np.full(len(edge), asked[-1])])
    angle = np.convolve(asked, np.diff(edge), "valid")
    velocity = np.gradient(angle, 1.0 / _FINE)
    motion = (angle, velocity, np.gradient(velocity, 1.0 / _FINE))
    adaptation = None
    if device is not None:
        fitted = fit_device(device, motion, rate_hz=_FINE, highest_hz=0.0, angle_range=(low, high))
        before = peaks(motion)
        after = peaks(fitted.motion)
        adaptation = Adaptation(
            device.name,
            (0.0, 0.0),
            0.0,
            fitted.cutoff_hz,
            (before[0], after[0]),
            (before[1], after[1]),
            float(np.ptp(fitted.motion[0])) / (high - low),
        )
        motion = fitted.motion
    time = np.arange(int((len(angle) - 1) / _FINE * rate_hz) + 1) / rate_hz
    at = np.arange(len(angle)) / _FINE
    angle, velocity, acceleration = (np.interp(time, at, each) for each in motion)
    given = Given(
        profile=name,
        task="passive",
        angle_range=angle_range,
        rate_hz=rate_hz,
        device=device,
    )
    effort = np.zeros((len(time), 4))
    return Trajectory(given, time, angle, velocity, acceleration, effort, adaptation)


def telling_words(trajectory: Trajectory) -> list[str]:
    """What a movement is for, in lines; `expects` says what it will tell."""
    name = trajectory.settings.profile
    seconds = trajectory.time[-1]
    more = "surae expect says what it will tell."
    if name not in PERTURBATIONS:
        speeds = f"up to {math.degrees(abs(trajectory.velocity).max()):.0f} °/s"
        return [f"{name}: {seconds:.0f} s, {speeds}, relaxed; then surae stretches; {more}"]
    return [f"{name}: {seconds:.0f} s about the middle of the range; then surae impedance; {more}"]
