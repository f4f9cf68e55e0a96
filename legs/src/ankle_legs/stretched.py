"""Legs that a robot stretches slowly and fast, with hidden truth of tissue and reflex.

The reflex follows Levin and Feldman (1994): a muscle answers while it is longer than a threshold
that falls with velocity. Speeds, ranges and torques are those of de Vlugt et al. (2010) and
de Gooijer-van de Groep et al. (2013). SI units inside, degrees in the truth; dorsiflexion is
positive, and so is the torque when the calf pulls.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numba import njit
from scipy.signal import butter, lfilter, sosfilt

from ankle_legs.leg import generator
from ankle_legs.muscle import Array
from ankle_legs.perturbed import around
from ankle_legs.subject import ELECTRODES

FINE, RATE = 4000, 1000  # steps and samples a second
CALF = ("gl", "sol", "gm")
SHARES = np.array([0.25, 0.5, 0.25])  # of the calf's reflex torque


@dataclass(frozen=True)
class Tissue:
    """What resists without a nerve."""

    at_zero: float  # elastic torque at the neutral angle [Nm]
    steepness: float  # of its exponential [1/rad]
    relaxes: float  # share of the elastic torque that a stretch adds for a while
    seconds: float  # and how long
    viscosity: float  # [Nm s/rad]
    inertia: float  # of foot and plate [kg m2]
    weight: float  # of foot and plate [Nm]
    tilt: float  # angle at which they are horizontal [rad]
    power: float = 1.0  # of the velocity that is damped
    grip: float = 0.0  # what still tissue holds until it yields [Nm]
    softening: float = 0.0  # share of the elastic torque that the session takes away

    def elastic(self, angle: Array) -> Array:
        """Return the relaxed elastic torque [Nm]."""
        return np.asarray(self.at_zero * np.exp(self.steepness * angle))


@dataclass(frozen=True)
class Answer:
    """The calf's stretch reflex."""

    peak: float = 0.0  # torque that the fastest stretch calls up [Nm]; 0: no reflex
    threshold: float = 0.2  # at rest, of the calf's middle [rad]
    falls: float = 0.06  # of the threshold over velocity [s]
    latency: float = 0.03  # of the EMG behind the stretch [s]
    lag: float = 0.012  # of the force behind the EMG [s]
    frequency: float = 16.0  # of the force's filter, critically damped [rad/s]
    spread: float = 0.017  # of the threshold, between stretches [rad]
    vary: float = 0.15  # of the gain
    root: float = 1.0  # power of the velocity by which the threshold falls
    clonus: float = 0.0  # beats that follow, as share of the first
    habit: float = 0.0  # share of the gain lost over the session
    late: float = 0.0  # voluntary answer after 0.15 to 0.3 s, in most stretches [Nm]


@dataclass(frozen=True)
class Stretches:
    """One leg, its robot and its electrodes."""

    tissue: Tissue
    answer: Answer
    ends: tuple[float, float]  # of the stretches [rad]
    speeds: tuple[float, ...]  # rad/s, each repeated
    repeats: int
    servo: float = 15.0  # bandwidth [Hz]
    emg: str = "envelope"  # raw, envelope or none
    volts: float = 2e-6  # of an EMG at rest
    background: float = 0.0  # EMG and torque of who does not relax [Nm]
    crosstalk: float = 0.0  # of the calf in the tibialis's electrode
    clip: float = 0.0  # volts at which the EMG is clipped; 0: never
    zero: float = 0.0  # of the torque [Nm]
    drift: float = 0.05  # [Nm]
    noise: float = 0.03  # of the torque [Nm]
    cutoff: float = 100.0  # of the torque's filter [Hz]
    files: int = 1  # 2: slow and fast apart


Family = Callable[[np.random.Generator, Stretches], Stretches]


@dataclass(frozen=True)
class Recording:
    """What is recorded in one file."""

    name: str
    emg: str
    columns: dict[str, Array]


def draw(rng: np.random.Generator) -> Stretches:
    """Draw a spastic leg whose threshold at rest lies near the end of its range."""
    low, high = np.radians(rng.uniform(-32, -18)), np.radians(rng.uniform(2, 18))
    steepness = float(rng.uniform(2.5, 6))
    at_end = around(rng, 5, 0.4)
    tissue = Tissue(
        at_zero=at_end / float(np.exp(steepness * high)),
        steepness=steepness,
        relaxes=float(rng.uniform(0.1, 0.4)),
        seconds=float(rng.uniform(0.4, 1.5)),
        viscosity=float(rng.uniform(0.1, 0.5)),
        inertia=float(rng.uniform(0.015, 0.06)),
        weight=float(rng.uniform(1, 5)),
        tilt=float(rng.uniform(-0.2, 0.4)),
    )
    falls = float(rng.uniform(0.04, 0.09))
    fastest = float(np.radians(rng.uniform(160, 250)))
    answer = Answer(
        peak=float(rng.uniform(3, 12)),
        threshold=float(high + np.radians(rng.uniform(-4, 4))),
        falls=falls,
        latency=float(rng.uniform(0.025, 0.04)),
        frequency=float(rng.uniform(13, 22)),
    )
    speeds = (
        np.radians(rng.uniform(8, 20)),
        *np.linspace(np.radians(rng.uniform(50, 80)), fastest, 4),
    )
    return Stretches(
        tissue,
        answer,
        (float(low), float(high)),
        tuple(float(s) for s in speeds),
        int(rng.integers(3, 5)),
        servo=float(rng.uniform(10, 25)),
        emg=str(rng.choice(["raw", "envelope"])),
        zero=float(rng.normal(0, 1)),
        files=int(rng.integers(1, 3)),
    )


def quiet(_: np.random.Generator, s: Stretches) -> Stretches:
    """Return the leg without a reflex."""
    return replace(s, answer=replace(s.answer, peak=0.0))


def unheard(_: np.random.Generator, s: Stretches) -> Stretches:
    """Return the leg without EMG."""
    return replace(s, emg="none")


def tonic(rng: np.random.Generator, s: Stretches) -> Stretches:
    """Return the leg with its threshold well within the range: also slow stretches are answered."""
    threshold = s.ends[1] - float(rng.uniform(0.3, 0.55)) * (s.ends[1] - s.ends[0])
    return replace(s, answer=replace(s.answer, threshold=threshold))


def stiff(rng: np.random.Generator, s: Stretches) -> Stretches:
    """Return the leg with stiff, viscous tissue and a weak reflex."""
    t, a = s.tissue, s.answer
    tissue = replace(t, at_zero=2 * t.at_zero, viscosity=float(rng.uniform(0.5, 1.0)))
    return replace(s, tissue=tissue, answer=replace(a, peak=0.4 * a.peak))


def heavy(rng: np.random.Generator, s: Stretches) -> Stretches:
    """Return the leg on a heavy plate, with a torque that drifts."""
    t = replace(s.tissue, inertia=float(rng.uniform(0.06, 0.15)), weight=float(rng.uniform(5, 12)))
    return replace(s, tissue=t, drift=0.3, servo=float(rng.uniform(8, 14)))


def tense(rng: np.random.Generator, s: Stretches) -> Stretches:
    """Return the leg of a person who does not quite relax."""
    return replace(s, background=float(rng.uniform(0.3, 1.0)), drift=0.2)


def any_of_these(rng: np.random.Generator, s: Stretches) -> Stretches:
    """Return the leg with two of the departures."""
    kinds = (unheard, tonic, stiff, heavy, tense)
    for i in rng.permutation(len(kinds))[:2]:
        s = kinds[i](rng, s)
    return s


FAMILIES: dict[str, Family] = {
    "sa": lambda _, s: s,
    "sb": quiet,
    "sc": unheard,
    "sd": tonic,
    "se": stiff,
    "sf": heavy,
    "sg": tense,
    "sh": any_of_these,
}


@njit(cache=True)
def _held(angle: Array, reach: float, rebuild: float) -> Array:
    """Return what still tissue holds, 0 to 1: it yields at a reach, and heals at rest [steps]."""
    out, bonds, s = np.zeros(angle.size), 1.0, 0.0
    for i in range(1, angle.size):
        d = angle[i] - angle[i - 1]
        s = (s + d) / (1 + abs(d) / reach)
        bonds = (bonds + 1 / rebuild) / (1 + 1 / rebuild + abs(d) / (4 * reach))
        out[i] = bonds * s / reach
    return out


def _smooth(u: Array) -> Array:
    u = np.clip(u, 0, 1)
    return np.asarray(u * u * (3 - 2 * u))


def _plan(
    rng: np.random.Generator, s: Stretches, speeds: tuple[float, ...]
) -> tuple[Array, list[tuple[float, float, float]]]:
    """Return the command [rad] and each stretch's start, stop and speed."""
    low, high = s.ends
    order = [v for v in speeds for _ in range(s.repeats)]
    if rng.random() < 0.6:
        order = list(rng.permutation(order))
    pieces: list[Array] = []
    stretches: list[tuple[float, float, float]] = []
    now = 0.0

    def hold(angle: float, seconds: float) -> None:
        nonlocal now
        pieces.append(np.full(round(seconds * FINE), angle))
        now += pieces[-1].size / FINE

    def ramp(start: float, end: float, speed: float, rise: float) -> None:
        """Move at a speed, which begins and ends within the rise [s]."""
        nonlocal now
        seconds = abs(end - start) / speed + rise
        u = np.arange(round(seconds * FINE)) / FINE
        rate = _smooth(u / rise) * _smooth((seconds - u) / rise)
        course = np.cumsum(rate)
        pieces.append(start + (end - start) * course / course[-1])
        now += pieces[-1].size / FINE

    hold(low, float(rng.uniform(2, 4)))
    for speed in order:
        end = high - float(rng.uniform(0, np.radians(0.5)))
        start = now
        ramp(low, end, float(speed), 0.15 if speed < 0.5 else float(rng.uniform(0.03, 0.05)))
        stretches.append((start, now, float(speed)))
        hold(end, float(rng.uniform(2, 3.5)))
        ramp(end, low, float(rng.uniform(0.2, 0.35)), 0.3)
        hold(low, float(rng.uniform(2.5, 6)))
    return np.concatenate(pieces), stretches


def _late(signal: Array, seconds: float) -> Array:
    lag = round(seconds * FINE)
    return np.asarray(np.concatenate([np.full(lag, signal[0]), signal[: signal.size - lag]]))


def _first_order(signal: Array, seconds: float) -> Array:
    keep = np.exp(-1 / (FINE * seconds))
    return np.asarray(lfilter([1 - keep], [1, -keep], signal, zi=[keep * signal[0]])[0])


def _second_order(signal: Array, omega: float, damping: float) -> Array:
    """Return a signal after a filter of the second order, at rest before (bilinear)."""
    k = 2 * FINE / omega
    a = np.array([k * k + 2 * damping * k + 1, 2 - 2 * k * k, k * k - 2 * damping * k + 1])
    first = signal[0]
    return np.asarray(lfilter([1, 2, 1], a, signal - first) + first)


def leg(family: str, seed: int) -> Stretches:
    """Return the stretched leg of a family and a seed."""
    rng = generator(family, seed, 0)
    return families()[family](rng, draw(rng))


def families() -> dict[str, Family]:
    """Return all families of stretched legs."""
    from ankle_legs.last_nerve import STRETCHED

    return {**FAMILIES, **STRETCHED}


def record(family: str, seed: int) -> tuple[list[Recording], dict[str, Any]]:
    """Return the recordings of a family's leg, and its truth."""
    return simulate(leg(family, seed), generator(family, seed, 1))


def simulate(s: Stretches, rng: np.random.Generator) -> tuple[list[Recording], dict[str, Any]]:
    """Return the recordings that a leg gives, and what is true of them."""
    offsets = rng.normal(0, np.radians(1.2), 3)  # of each muscle's threshold
    groups = [s.speeds] if s.files == 1 else [s.speeds[:1], s.speeds[1:]]
    names = ["stretches"] if s.files == 1 else ["slow", "fast"]
    recordings, stretches = [], []
    for i, (name, speeds) in enumerate(zip(names, groups, strict=True)):
        made, true = _one(s, rng, name, speeds, offsets, i)
        recordings.append(made)
        stretches += true
    thresholds = dict.fromkeys(CALF)
    if s.answer.peak and s.emg != "none":
        values = np.degrees(s.answer.threshold + offsets)
        thresholds = dict(zip(CALF, values.tolist(), strict=True))
    return recordings, {"stretches": stretches, "threshold": thresholds, "emg": s.emg}


def _gain(s: Stretches) -> float:
    """Return the torque per angle beyond the threshold that gives the asked peak [Nm/rad]."""
    a, (low, high), fastest = s.answer, s.ends, s.speeds[-1]
    angle = low + (high - low) * _smooth(np.arange(FINE) / FINE * fastest / (high - low) / 1.5)
    speed = np.gradient(angle, 1 / FINE)
    over = np.maximum(angle - a.threshold + a.falls * speed**a.root, 0)
    return a.peak / max(float(_second_order(over, a.frequency, 1.0).max()), 1e-3)


def _one(
    s: Stretches,
    rng: np.random.Generator,
    name: str,
    speeds: tuple[float, ...],
    offsets: Array,
    part: int,
) -> tuple[Recording, list[dict[str, Any]]]:
    t, a = s.tissue, s.answer
    command, plan = _plan(rng, s, speeds)
    angle = _second_order(command, 2 * np.pi * s.servo, 0.85)
    speed = np.gradient(angle, 1 / FINE)
    n, times = angle.size, np.arange(angle.size) / FINE
    elastic, viscous, inertial, gravity = _passive(s, angle, speed, part)
    beyond = np.zeros((3, n))  # angle beyond each muscle's threshold, after the latency
    then, fast = _late(angle, a.latency), _late(speed, a.latency)
    falls = a.falls * np.sign(fast) * np.abs(fast) ** a.root
    onsets = []
    voluntary = np.zeros(n)
    for k, (start, stop, _) in enumerate(plan):
        first = round(start * FINE)
        last = round((plan[k + 1][0] if k + 1 < len(plan) else times[-1]) * FINE)
        span = slice(first, last)
        thresholds = a.threshold + offsets + a.spread * rng.normal()
        habit = 1 - a.habit * (k + 1) / len(plan)
        vary = float(np.exp(a.vary * rng.normal())) * habit
        if a.peak:
            over = then[span] - thresholds[:, None] + falls[span]
            if a.clonus:
                after = times[span] - stop
                beats = np.exp(-after / 0.5) * np.maximum(np.sin(2 * np.pi * 5.5 * after), 0)
                size = a.clonus * np.maximum(over.max(axis=1, keepdims=True), 0)
                over = np.maximum(over, np.where(after > 0.12, size * beats, over))
            beyond[:, span] = vary * np.maximum(over, 0)
        if a.late and rng.random() < 0.7:
            at = start + rng.uniform(0.15, 0.3)
            burst = _smooth((times[span] - at) / 0.1) * _smooth((at + 0.6 - times[span]) / 0.2)
            voluntary[span] = a.late * rng.uniform(0.5, 1) * burst
        ahead = beyond[:, first : round((stop + 0.15) * FINE)]
        crossed = [int(np.argmax(row > 0)) if (row > 0).any() else None for row in ahead]
        onsets.append([None if c is None else first + c for c in crossed])
    drive = _gain(s) * beyond
    pulled = _second_order(_late(SHARES @ drive, a.lag), a.frequency, 1.0)
    effort = s.background * np.maximum(0.5 + _wander(rng, n, 1.5), 0)
    effort = _second_order(effort + voluntary, 16.0, 1.0)
    torque = elastic + viscous + inertial + gravity + pulled + effort
    shown = sosfilt(butter(2, s.cutoff, fs=FINE, output="sos"), torque - torque[0]) + torque[0]
    shown = shown + s.zero + s.drift * _wander(rng, n, 8.0)
    every = FINE // RATE
    columns = {
        "time_s": times[::every],
        "angle_rad": angle[::every] + 5e-6 * rng.normal(size=times[::every].size),
        "torque_Nm": shown[::every] + s.noise * rng.normal(size=times[::every].size),
    }
    if s.emg != "none":
        seen = _electrodes(s, rng, drive, effort + voluntary)
        columns |= {f"emg_{e}_V": row for e, row in zip(ELECTRODES, seen, strict=True)}
    torques = {
        "whole": torque - effort,
        "viscous": viscous,
        "inertial": inertial,
        "neural": pulled,
    }
    stretches = [
        {
            "recording": name + ".csv",
            **_stretch(t, each, angle, speed, torques),
            "emg_onset_deg": {
                m: None if o is None or s.emg == "none" else float(np.degrees(angle[o]))
                for m, o in zip(CALF, crossed, strict=True)
            },
        }
        for each, crossed in zip(plan, onsets, strict=True)
    ]
    return Recording(name, s.emg, columns), stretches


def _passive(s: Stretches, angle: Array, speed: Array, part: int) -> tuple[Array, ...]:
    """Return what is no muscle's: elastic, viscous, inertial torque and weight [Nm]."""
    t = s.tissue
    times = np.arange(angle.size) / FINE
    soft = 1 - t.softening * (part + (1 if s.files == 1 else 0.5) * np.minimum(times / 40, 1)) / 2
    relaxed = t.elastic(angle) * soft
    elastic = relaxed + t.relaxes * (relaxed - _first_order(relaxed, t.seconds))
    if t.grip:
        elastic = elastic + t.grip * _held(angle, np.radians(1.5), 3.0 * FINE)
    viscous = t.viscosity * np.sign(speed) * np.abs(speed) ** t.power
    inertial = t.inertia * np.gradient(speed, 1 / FINE)
    gravity = t.weight * np.cos(angle - t.tilt)
    return elastic, viscous, inertial, gravity


def _stretch(
    t: Tissue,
    planned: tuple[float, float, float],
    angle: Array,
    speed: Array,
    torques: dict[str, Array],
) -> dict[str, Any]:
    """Return what is true of a stretch, of which start, stop and speed were planned."""
    start, stop, asked = planned
    span = slice(round(start * FINE), round((stop + 0.5) * FINE))
    moving = slice(round(start * FINE), round((stop + 0.05) * FINE))
    top = int(np.argmax(torques["whole"][span]))
    rise = t.elastic(angle[round((stop + 0.2) * FINE)]) - t.elastic(angle[span][0])
    pulled = torques["neural"][span]
    return {
        "start_s": start,
        "stop_s": stop,
        "direction": "dorsiflexion",
        "speed_deg_s": float(np.degrees(speed[moving].max())),
        "asked_deg_s": float(np.degrees(asked)),
        "from_deg": float(np.degrees(angle[span][0])),
        "to_deg": float(np.degrees(angle[span][-1])),
        "elastic_Nm": float(np.asarray(rise)),
        "viscous_Nm": float(torques["viscous"][moving].max()),
        "inertial_Nm": float(torques["inertial"][moving].max()),
        "neural_Nm": float(pulled.max() - pulled[0]),
        "neural_at_peak_Nm": float(pulled[top] - pulled[0]),
    }


def _wander(rng: np.random.Generator, n: int, seconds: float) -> Array:
    knots = np.arange(int(n / FINE / seconds) + 3) * seconds * FINE
    return np.asarray(np.interp(np.arange(n), knots, rng.normal(size=knots.size)))


def _electrodes(s: Stretches, rng: np.random.Generator, drive: Array, effort: Array) -> Array:
    """Return four electrodes' EMG [V] at the sampled rate: raw, or its envelope."""
    n = effort.size
    level = np.zeros((4, n))
    gains = 6e-6 * np.exp(rng.normal(0, 0.4, 4))  # volts per Nm of the whole calf
    level[1:] = gains[1:, None] * (drive + effort)
    level[0] = s.crosstalk * level[1:].mean(axis=0)
    level += s.volts * np.exp(rng.normal(0, 0.3, 4))[:, None]
    band = butter(2, [20, 400], "bandpass", fs=FINE, output="sos")
    source = sosfilt(band, rng.normal(size=level.shape))
    source *= np.sqrt(np.pi / 2) / source.std(axis=1, keepdims=True)
    raw = level * source
    if s.clip:
        raw = np.clip(raw, -s.clip, s.clip)
    every = FINE // RATE
    if s.emg == "raw":
        return np.asarray(raw[:, ::every] + 3e-7 * rng.normal(size=raw[:, ::every].shape))
    smoother = butter(2, float(rng.uniform(15, 40)), fs=FINE, output="sos")
    return np.asarray(np.abs(sosfilt(smoother, np.abs(raw))[:, ::every]))
