"""Made recordings of one leg: tissue and a reflex, as a protocol moves it."""

from collections.abc import Mapping

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import lfilter

from surae.base.units import FloatArray
from surae.nerve.cascade import muscle, relaxing, stretched
from surae.nerve.piece import SLOW
from surae.nerve.ramps import low
from surae.protocol.profiles import smooth_step
from surae.protocol.protocol import Trajectory
from surae.recording import Recording

#: A relaxed to moderately tense ankle whose tissue relaxes (Kearney 1997, Mirbagheri 2000; the
#: branch as of a measured one), and its reflex, torque per Nm·s/rad.
USUAL = {
    "stiffness": 60.0,
    "viscosity": 0.6,
    "inertia": 0.018,
    "branch_1": 40.0,
    "time_1": 0.01,
    "delay": 0.04,
    "omega": 20.0,
    "zeta": 0.8,
}
#: Torque that a person makes beside, below this frequency [Nm, Hz]; noise of the position [rad].
UNSTEADY = 0.15
BELOW = 3.0
POSITION = 2e-5
#: Rate at which perturbations are recorded [Hz].
RECORDED = 1000.0
#: Time in which a made movement returns to where it began, for filters that run around [s].
_RETURN = 1.0
#: A stretched leg: elastic, viscous, inertial, relaxing torque per unit; its time [s].
_STRETCHED = {"elastic": 15.0, "viscous": 0.3, "inertia": 0.02, "relaxing": 10.0, "time": 0.8}
#: Where in the movement's range the reflex's threshold lies at rest, what velocity takes off it
#: [s], how late EMG is [s], by how much answers differ [part].
_THRESHOLD = 0.5
_SOONER = 0.03
_LATE = 0.03
_DIFFER = 0.15
#: Frequency below which an envelope keeps noise [Hz], and its size at rest beside a burst.
_SMOOTHED = 30.0
_QUIET = 0.005


def perturbed_leg(
    trajectory: Trajectory, leg: Mapping[str, float], share: float, noise: float, seed: int
) -> tuple[Recording, float]:
    """A perturbed leg with a reflex that makes `share` % of its torque's variance, and its gain."""
    draw = np.random.default_rng([seed, 7])
    rate = RECORDED
    time = np.arange(int(trajectory.time[-1] * rate) + 1) / rate
    x = own_angle = CubicSpline(trajectory.time, trajectory.angle)(time)
    back = x[-1] + (x[0] - x[-1]) * smooth_step(np.arange(round(_RETURN * rate)) / _RETURN / rate)
    x = np.concatenate([x, back])
    s = np.asarray(2j * np.pi * np.fft.rfftfreq(len(x), 1.0 / rate), np.complex128)
    spectrum = np.fft.rfft(x - x.mean())
    tissue = leg["stiffness"] + leg["viscosity"] * s + leg["inertia"] * s**2
    tissue = tissue + leg["branch_1"] * relaxing(s, leg["time_1"])
    velocity = np.fft.irfft(s * spectrum, len(x))
    answer = muscle(s, leg["omega"], leg["zeta"]) * np.exp(-s * leg["delay"])
    reflex = np.fft.irfft(np.fft.rfft(stretched(velocity, 1, 0.0)) * answer, len(x))[: len(time)]
    torque = np.fft.irfft(tissue * spectrum, len(x))[: len(time)]
    (a, c), (_, b) = np.cov(_faster(torque, rate), _faster(reflex, rate))
    part = 0.01 * share  # g²b = part·(a + 2gc + g²b)
    gain = (part * c + np.sqrt((part * c) ** 2 + (1.0 - part) * b * part * a)) / ((1.0 - part) * b)
    torque = torque + gain * reflex + _noise(draw, time, noise)
    moved = own_angle + POSITION * draw.standard_normal(len(time))
    return Recording.from_arrays(time, moved, torque, name="made"), float(gain)


def stretched_leg(
    trajectory: Trajectory, share: float, noise: float, seed: int
) -> tuple[Recording, Recording, dict[str, float]]:
    """A stretched leg whose reflex makes `share` % of the fastest stretches' peak of torque.

    With EMG and without; and the reflex's largest torque [Nm] and its threshold at rest [deg].
    """
    time = trajectory.time
    x = trajectory.angle
    rate = _rate(trajectory)
    draw = np.random.default_rng([seed, 9])
    of = _STRETCHED
    torque = of["elastic"] * x + of["viscous"] * trajectory.velocity
    torque = torque + of["inertia"] * trajectory.acceleration
    keep = np.exp(-1.0 / (rate * of["time"]))
    torque = torque + of["relaxing"] * lfilter([keep, -keep], [1.0, -keep], x - x[0])
    low_end = float(x.min())
    high_end = float(x.max())
    threshold = low_end + _THRESHOLD * (high_end - low_end)
    stretch = np.maximum(trajectory.velocity, 0.0)
    called = np.where(x > threshold - _SOONER * stretch, stretch, 0.0)
    starts = np.flatnonzero(np.diff((called > 0.0).astype(int)) == 1)
    size = np.exp(_DIFFER * draw.standard_normal(len(starts) + 1))
    called = called * size[np.searchsorted(starts, np.arange(len(x)))]
    n = round(_LATE * rate)
    called = np.concatenate([np.zeros(n), called[:-n]]) / max(float(called.max()), 1e-12)
    drive = np.exp(-USUAL["omega"] / rate)
    force = called
    for _ in range(2):
        force = lfilter([1.0 - drive], [1.0, -drive], force)
    peak = 0.01 * share / (1.0 - 0.01 * share) * float(np.ptp(torque))
    force = force * peak / max(float(force.max()), 1e-12)
    bursts = called + _QUIET
    raw = np.abs(draw.standard_normal((3, len(x)))) * np.sqrt(np.pi / 2.0) * bursts
    calf = np.maximum(np.stack([low(each, rate, _SMOOTHED) for each in raw], axis=1), 0.0)
    emg = 1e-4 * np.column_stack([np.full(len(x), _QUIET), calf])
    moved = x + POSITION * draw.standard_normal(len(x))
    torque = torque + force + _noise(draw, time, noise)
    heard = Recording.from_arrays(time, moved, torque, emg, name="made", emg_kind="envelope")
    silent = Recording.from_arrays(time, moved, torque, name="made")
    return heard, silent, {"neural": peak, "threshold": float(np.rad2deg(threshold))}


def _rate(trajectory: Trajectory) -> float:
    return (len(trajectory.time) - 1) / float(trajectory.time[-1] - trajectory.time[0])


def _noise(draw: np.random.Generator, time: FloatArray, sensor: float) -> FloatArray:
    """Torque that a person makes beside, and the sensor's noise [Nm]."""
    n = len(time)
    f = np.fft.rfftfreq(n, float(time[-1] - time[0]) / (n - 1))
    slow = np.fft.irfft(np.fft.rfft(draw.standard_normal(n)) / np.hypot(1.0, f / BELOW), n)
    return np.asarray(UNSTEADY * slow / slow.std() + sensor * draw.standard_normal(n))


def _faster(values: FloatArray, rate: float) -> FloatArray:
    """A signal without what is below `SLOW`."""
    f = np.fft.rfftfreq(len(values), 1.0 / rate)
    return np.asarray(np.fft.irfft(np.fft.rfft(values) * (f >= SLOW), len(values)))
