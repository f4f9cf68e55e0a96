"""Ankles under small random perturbations, with hidden truth of tissue and reflex."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.signal import butter, lfilter, sosfilt

from ankle_legs.joint import FINE, Intrinsic, Reflex, Servo, move
from ankle_legs.leg import generator
from ankle_legs.muscle import Array

RATE = 1000  # samples a second
WARM_UP = 1.0  # before a record begins [s]
LEAST = 0.5  # below this frequency the torque's variance does not count [Hz]


@dataclass(frozen=True)
class Channels:
    """What sensors make of angle and torque."""

    late: float = 0.0  # of the torque [s]
    cutoff: float = 0.0  # of the torque's filter; 0: none [Hz]
    angle_noise: float = 8e-6  # [rad]
    angle_step: float = 0.0  # quantisation; 0: none [rad]
    torque_noise: float = 0.02  # [Nm]
    torque_step: float = 0.001
    zero: float = 0.0  # of the torque [Nm]
    angle: float = 0.0  # about which it moves [rad]


@dataclass(frozen=True)
class Ankle:
    """One perturbed ankle; families change it."""

    servo: Servo
    own: Intrinsic
    foot: float  # the foot's part of the inertia [kg m2]
    channels: Channels
    command: str = "prbs"
    amplitude: float = 0.03  # peak to peak [rad]
    reflexes: tuple[Reflex, ...] = ()
    share: float = 0.0  # that the reflexes shall make of the torque's variance
    drift: float = 0.3  # of the tonic torque, slow [Nm]
    noise: float = 0.15  # of the tonic torque, sd [Nm]
    noise_cutoff: float = 3.0  # [Hz]
    tremor: float = 0.0  # about 9 Hz [Nm]
    bursts: int = 0  # efforts of half a second
    change: float = 0.0  # relative change of stiffness within the record
    fading: float = 0.0  # share of the reflex that is lost within the record
    unscored: dict[str, str] = field(default_factory=dict)


Family = Callable[[np.random.Generator, Ankle], Ankle]


@dataclass(frozen=True)
class Record:
    """A record, and what is true of it."""

    columns: dict[str, Array]
    empty: dict[str, Array]  # the device moved alike without a foot
    truth: dict[str, Any]


def perturbation(rng: np.random.Generator, kind: str, n: int, span: float) -> Array:
    """Return a command of n fine steps, peak to peak ``span`` [rad].

    It is "prbs", "pralds" (Kearney et al. 1997; Mirbagheri et al. 2000), "multisine", or "steps" of
    0.3 to 1 s.
    """
    if kind == "multisine":
        period = 20 * FINE
        tones = np.fft.rfftfreq(period, 1 / FINE)
        tones[(tones < 0.25) | (tones > 20)] = np.inf
        sizes = 1 / (1 + (tones / rng.uniform(1.5, 3)) ** 1.2)
        turned = sizes * np.exp(2j * np.pi * rng.uniform(size=tones.size))
        course = np.resize(np.fft.irfft(turned, period), n)
        return np.asarray(0.25 * span * course / course.std())
    least, most = {"prbs": (0.0, 0.0), "pralds": (0.2, 0.4), "steps": (0.3, 1.0)}[kind]
    every = float(rng.uniform(0.12, 0.2))
    course, at, last = np.zeros(n), 0, 0.0
    while at < n:
        wait = every if kind == "prbs" else float(rng.uniform(least, most))
        to = min(n, at + round(wait * FINE))
        if kind == "prbs":
            last = float(rng.choice([-0.5, 0.5]))
        elif kind == "pralds":
            last = float(rng.uniform(-0.5, 0.5))
        else:
            last = 0.0 if last else float(rng.choice([-0.5, 0.5]))
        course[at:to] = last
        at = to
    return span * course


def around(rng: np.random.Generator, middle: float, spread: float) -> float:
    """Return a positive number about a middle, its logarithm's sd given."""
    return float(middle * np.exp(spread * np.clip(rng.normal(), -2, 2)))


def draw(rng: np.random.Generator, strength: int) -> Ankle:
    """Draw an ankle that the plain model describes.

    It has inertia, viscosity and stiffness, and no reflex (strength 0), a weak one (1) or a strong
    one (2).

    Ranges cover what Kearney et al. (1997) and Mirbagheri et al. (2000) found of healthy and
    spastic ankles from rest to strong effort.
    """
    stiffness = around(rng, 70, 0.5)
    foot, sensor = around(rng, 0.014, 0.25), around(rng, 0.004, 0.6)
    damping = float(rng.uniform(0.2, 0.5))
    kind = str(rng.choice(["prbs", "prbs", "pralds", "multisine", "steps"]))
    share = (0.0, float(rng.uniform(0.005, 0.04)), float(rng.uniform(0.05, 0.4)))[strength % 3]
    sign = 1.0 if rng.random() < 0.65 else -1.0
    reflex = Reflex(
        gain=0.0,
        delay=float(rng.uniform(0.032, 0.055)),
        frequency=float(rng.uniform(11, 32)),
        damping=float(rng.uniform(0.6, 1.1)),
        threshold=float(rng.choice([0.0, rng.uniform(0, 0.25)])),
        sign=sign,
    )
    return Ankle(
        servo=Servo(float(rng.uniform(18, 35)), float(rng.uniform(0.7, 1.0)), 8.0),
        own=Intrinsic(foot + sensor, 2 * damping * np.sqrt(stiffness * (foot + sensor)), stiffness),
        foot=foot,
        channels=Channels(
            late=float(rng.choice([0.0, rng.uniform(0, 0.001)])),
            zero=float(rng.normal(0, 4)),
            angle=float(rng.uniform(-0.2, 0.2)),
        ),
        command=kind,
        amplitude=float(rng.uniform(0.025, 0.05)),
        reflexes=(reflex,) if share else (),
        share=share,
        drift=around(rng, 0.3, 0.5),
        noise=around(rng, 0.12, 0.5),
        noise_cutoff=float(rng.uniform(1, 6)),
    )


def relaxing(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Return the ankle with intrinsic stiffness that relaxes within 6 to 16 ms."""
    k = a.own.stiffness
    relaxed = replace(
        a.own,
        branch=k * float(rng.uniform(0.3, 1.0)),
        seconds=float(rng.uniform(0.006, 0.016)),
        viscosity=a.own.viscosity * float(rng.uniform(0.3, 0.7)),
    )
    return replace(a, own=relaxed)


def bent(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Return the ankle with stiffness that rises (or falls) over the angle."""
    bend = float(rng.choice([1, 1, -1]) * rng.uniform(6, 16))
    return replace(a, own=replace(a.own, bend=bend))


def changing(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Return the ankle with stiffness that changes as the effort does."""
    return replace(a, change=float(rng.choice([-1, 1]) * rng.uniform(0.15, 0.4)), drift=2 * a.drift)


def late(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Return the ankle with a torque channel that is late, by a wait and a filter."""
    seconds, cutoff = float(rng.uniform(0.001, 0.004)), float(rng.choice([0.0, 80.0, 150.0]))
    return replace(a, channels=replace(a.channels, late=seconds, cutoff=cutoff))


def yielding(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Return the ankle in a small motor that yields, with a heavy sensor."""
    sensor = float(rng.uniform(0.005, 0.03))
    servo = Servo(float(rng.uniform(10, 25)), float(rng.uniform(0.6, 0.9)), rng.uniform(0.15, 0.6))
    return replace(a, servo=servo, own=replace(a.own, inertia=a.foot + sensor))


def coarse(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Return the ankle with an angle that is noisy and quantised."""
    how = {"angle_noise": float(rng.uniform(1e-5, 6e-5)), "angle_step": rng.uniform(2e-5, 2e-4)}
    return replace(a, channels=replace(a.channels, torque_noise=0.08, **how))


def reluctant(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Return the ankle with a reflex that answers fast stretches alone."""
    level = float(rng.uniform(0.2, 0.5))
    return replace(a, reflexes=tuple(replace(r, threshold=level) for r in a.reflexes))


def mixed(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Return the ankle with three of the departures."""
    kinds = (relaxing, bent, changing, late, yielding, coarse, reluctant)
    for i in rng.permutation(len(kinds))[:3]:
        a = kinds[i](rng, a)
    return a


def noisy(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Return the ankle of an unsteady person: strong drift, tremor, and relaxing stiffness."""
    a = replace(a, drift=3 * a.drift, noise=2 * a.noise, tremor=float(rng.uniform(0.02, 0.15)))
    return relaxing(rng, a)


FAMILIES: dict[str, Family] = {
    "qa": lambda _, a: a,
    "qb": relaxing,
    "qc": bent,
    "qd": changing,
    "qe": late,
    "qf": yielding,
    "qg": coarse,
    "qh": reluctant,
    "qi": mixed,
    "qj": noisy,
}


def _coloured(rng: np.random.Generator, n: int, cutoff: float) -> Array:
    """Return noise of the sd 1 at the fine steps, of the first order below a cutoff [Hz]."""
    coarse, keep = 20, np.exp(-2 * np.pi * cutoff * 20 / FINE)
    kicks = np.sqrt(1 - keep**2) * rng.normal(size=n // coarse + 2)
    settled = lfilter([1], [1, -keep], kicks, zi=[keep * rng.normal()])[0]
    return np.asarray(np.interp(np.arange(n) / coarse, np.arange(settled.size), settled))


def _slow(rng: np.random.Generator, n: int, knots: int) -> Array:
    """Return a slow course between -1 and 1 over the record."""
    values = np.cumsum(rng.normal(size=knots))
    grid = np.interp(np.linspace(0, 1, 400), np.linspace(0, 1, knots), values)
    smooth = np.convolve(np.pad(grid, 30, "edge"), np.hanning(61) / np.hanning(61).sum(), "valid")
    course = np.interp(np.linspace(0, 1, n), np.linspace(0, 1, 400), smooth)
    return np.asarray(2 * (course - course.min()) / max(np.ptp(course), 1e-9) - 1)


def variance(signal: Array, rate: float = RATE) -> float:
    """Return a signal's variance without what is below 0.5 Hz."""
    spectrum = np.abs(np.fft.rfft(signal - signal.mean())) ** 2
    return float(2 * spectrum[np.fft.rfftfreq(signal.size, 1 / rate) >= LEAST].sum()) / (
        signal.size**2
    )


def ankle(family: str, seed: int) -> Ankle:
    """Return the perturbed ankle of a family and a seed; of three seeds one has no reflex."""
    rng = generator(family, seed, 0)
    return families()[family](rng, draw(rng, seed + zlib.crc32(family.encode())))


def families() -> dict[str, Family]:
    """Return all families of perturbed legs."""
    from ankle_legs.last_nerve import PERTURBED

    return {**FAMILIES, **PERTURBED}


def record(family: str, seed: int, seconds: float = 60.0) -> Record:
    """Return the record of a family's ankle, with its truth."""
    return simulate(ankle(family, seed), generator(family, seed, 1), seconds)


def simulate(a: Ankle, rng: np.random.Generator, seconds: float = 60.0) -> Record:
    """Return the record that an ankle gives."""
    n, skip, every = round((seconds + WARM_UP) * FINE), round(WARM_UP * FINE), FINE // RATE
    command = perturbation(rng, a.command, n, a.amplitude)
    course = _slow(rng, n, int(rng.integers(3, 7)))
    load = a.noise * _coloured(rng, n, a.noise_cutoff) + a.drift * course
    times = np.arange(n) / FINE
    if a.tremor:
        phase = 2 * np.pi * np.cumsum(9 + _coloured(rng, n, 0.5)) / FINE
        load += a.tremor * (1 + 0.5 * _coloured(rng, n, 0.3)) * np.sin(phase)
    for at in rng.uniform(3, seconds - 3, a.bursts):
        load += rng.uniform(1, 4) * np.exp(-(((times - at) / rng.uniform(0.15, 0.6)) ** 2))
    level, fade = 1 + a.change * course, 1 - a.fading * times / times[-1]

    def run(reflexes: tuple[Reflex, ...]) -> tuple[Array, ...]:
        loads = {"load": load, "level": level, "habit": fade}
        return tuple(s[..., skip::every] for s in move(command, a.servo, a.own, reflexes, **loads))

    reflexes = a.reflexes
    if a.share:  # the gain that makes the share asked for; the servo's yield is met by repetition
        gain = 1.0
        for _ in range(3):
            reflexes = tuple(replace(r, gain=gain * (r.gain or 1.0)) for r in a.reflexes)
            _, _, torque, _, neural = run(reflexes)
            made, whole = neural.sum(axis=0), variance(torque)
            without = variance(torque - made)
            wanted = a.share * (whole if gain != 1.0 else without / (1 - a.share))
            gain *= float(np.sqrt(wanted / variance(made)))
        reflexes = tuple(replace(r, gain=gain * (r.gain or 1.0)) for r in a.reflexes)
    angle, _, torque, elastic, neural = run(reflexes)
    shown = _sensed(torque, a.channels, rng)
    columns = _columns(angle, shown, a.channels, rng)
    sensor = Intrinsic(a.own.inertia - a.foot, 0.01, 0.5)
    held = [s[skip::every] for s in move(command, a.servo, sensor)[:3]]
    empty = _columns(held[0], _sensed(held[2], a.channels, rng), a.channels, rng)
    return Record(columns, empty, _truth(a, reflexes, angle, shown, elastic, neural, level))


def _sensed(torque: Array, c: Channels, rng: np.random.Generator) -> Array:
    """Return the torque as its channel shows it."""
    if c.cutoff:
        torque = sosfilt(butter(2, c.cutoff, fs=RATE, output="sos"), torque)
    if c.late:
        n = torque.size
        slope = np.linspace(torque[0], torque[-1], n)  # so that the ends meet
        turn = np.exp(-2j * np.pi * np.fft.rfftfreq(n, 1 / RATE) * c.late)
        torque = np.fft.irfft(np.fft.rfft(torque - slope) * turn, n) + slope
    torque = torque + c.zero + c.torque_noise * rng.normal(size=torque.size)
    return np.asarray(np.round(torque / c.torque_step) * c.torque_step)


def _columns(
    angle: Array, torque: Array, c: Channels, rng: np.random.Generator
) -> dict[str, Array]:
    shown = c.angle + angle + c.angle_noise * rng.normal(size=angle.size)
    if c.angle_step:
        shown = np.round(shown / c.angle_step) * c.angle_step
    return {"time_s": np.arange(angle.size) / RATE, "angle_rad": shown, "torque_Nm": torque}


def _truth(
    a: Ankle,
    reflexes: tuple[Reflex, ...],
    angle: Array,
    torque: Array,
    elastic: Array,
    neural: Array,
    level: Array,
) -> dict[str, Any]:
    moved = angle - angle.mean()
    share = 100 * variance(neural.sum(axis=0)) / variance(torque) if reflexes else 0.0
    measures: dict[str, float | None] = {
        # of the elastic torque over the angles that the record has
        "intrinsic_stiffness": float(moved @ elastic / (moved @ moved)),
        "intrinsic_viscosity": float(
            a.own.slow_viscosity() + a.own.viscosity * (np.mean(np.sqrt(level)) - 1)
        ),
        "inertia": a.own.inertia,
        "foot_inertia": a.foot,
        "reflex_gain": reflexes[0].gain if len(reflexes) == 1 else None,
        "reflex_delay": 1000 * reflexes[0].delay if len(reflexes) == 1 else None,
        "reflex_share": share,
    }
    if reflexes and a.fading:
        measures["reflex_gain"] = reflexes[0].gain * (1 - a.fading / 2)
    measures |= dict.fromkeys(a.unscored)
    signs = {r.sign for r in reflexes}
    directions = {1.0: "dorsiflexion", -1.0: "plantarflexion"}
    return {
        "reflex": bool(reflexes),
        "direction": directions[signs.pop()] if len(signs) == 1 else None,
        "measures": measures,
        "unscored": a.unscored,
        "command": a.command,
    }
