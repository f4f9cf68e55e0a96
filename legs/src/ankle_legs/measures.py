"""What a clinician reads of a leg, computed from what the leg is.

Names and definitions are those of surae's catalogue of measures; the joint is muscles and joint
tissue together, fully relaxed unless a name says otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq
from scipy.signal import lfilter

from ankle_legs.muscle import Array, Muscle, integrate, static_force, tendon_force
from ankle_legs.subject import GROUPS, Subject

MEASURED_AT = (-10, 0, 10)  # [deg]
LAST = 10.0  # degrees before the end of range over which its stiffness is taken
FINE = 2000  # steps a second of the slow stretch

#: Measures that a parameter makes: without its truth they have none.
DERIVED = {
    "f0": ("bandwidth", "activation_half_time"),
    "beta": ("bandwidth", "activation_half_time"),
    "k_rel": ("relaxed_share", "quick_stiffness", "dissipated_energy"),
    "tau_rel": ("relaxed_share", "dissipated_energy"),
    "g1": ("torque_per_emg_tib",),
    **dict.fromkeys(("g2", "g3", "g4"), ("torque_per_emg_tri",)),
    **{f"l0_{g}": (f"optimal_angle_{g}", f"optimum_before_end_{g}") for g in GROUPS},
    **{f"x0_{g}": (f"slack_angle_{g}", f"slack_before_end_{g}") for g in GROUPS},
}

Resist = Callable[[Array, float], Array]


def active_state(muscle: Muscle, drive: Array, step: float) -> Array:
    """Return the activation [N] that follows a drive, by the trapezoidal rule."""
    k = 2 / (step * 2 * math.pi * muscle.f0)
    damped = 2 * muscle.beta * k
    return np.asarray(
        lfilter([1, 2, 1], [k * k + damped + 1, 2 - 2 * k * k, k * k - damped + 1], drive)
    )


def measures(
    subject: Subject,
    weights: tuple[float, float],
    rest: Callable[[Array], Array],
    resist: Resist,
    moved: tuple[float, float],
    active: tuple[float, float],
) -> dict[str, float | None]:
    """Return the leg's measures.

    ``weights`` are the force per volt of triceps and tibialis [N/V] that electrodes show, ``rest``
    the joint tissue's torque at an angle, ``resist`` that over a movement, ``moved`` the range that
    the ankle was moved in [rad], and ``active`` the largest active state of both groups [N].
    """
    muscles, values = subject.muscles(), subject.values

    def joint(degrees: float) -> float:
        angle = np.radians([degrees])
        return float(subject.passive_torque(angle)[0] + rest(angle)[0])

    def slope(degrees: float) -> float:
        return (joint(degrees + 0.05) - joint(degrees - 0.05)) / 0.1

    def held(i: int, degrees: float, alpha: float = 0.0) -> float:
        """Return the pull of a group that is held still [Nm]."""
        angle = np.radians([degrees])
        path, arm = subject.geometry.path(angle)[i, 0], subject.geometry.arm(angle)[i, 0]
        return float(arm * static_force(muscles[i], path, alpha)[0])

    low, high = np.degrees(moved)
    from_ = max(low, high - LAST)
    made: dict[str, float | None] = {
        "end_stiffness": float((joint(high) - joint(from_)) / (high - from_)),
        "end_torque": joint(high),
        "torque_rise": joint(high) - joint(low),
        "neutral_angle": _root(joint, -70, 50),
        "dissipated_energy": _energy(subject, resist),
        "bandwidth": _bandwidth(values["f0"], values["beta"]),
        "activation_half_time": _half_time(values["f0"], values["beta"]),
        "relaxed_share@10s": 100
        * values["k_rel"]
        / (1 + values["k_rel"])
        * -math.expm1(-(1 + values["k_rel"]) * 10 / values["tau_rel"]),
    }
    for at in MEASURED_AT:
        made |= {f"passive_torque@{at}deg": joint(at), f"passive_stiffness@{at}deg": slope(at)}
        made[f"quick_stiffness@{at}deg"] = _quick(subject, at, rest)
        for i, group in enumerate(GROUPS):
            sign = (1, -1)[i]
            made[f"passive_torque_{group}@{at}deg"] = held(i, at)
            rise = held(i, at + 0.05) - held(i, at - 0.05)
            made[f"passive_stiffness_{group}@{at}deg"] = sign * rise / 0.1
            added = held(i, at, active[i]) - held(i, at)
            made[f"active_torque_max_{group}@{at}deg"] = added if active[i] > 50 else None
    for i, group in enumerate(GROUPS):
        slack, best = _angles(subject, i)
        for name, before, angle in (
            ("slack_angle", "slack_before_end", slack),
            ("optimal_angle", "optimum_before_end", best),
        ):
            made[f"{name}_{group}"] = angle
            reach = None if angle is None else (high - angle if i == 0 else angle - low)
            made[f"{before}_{group}"] = reach
        made[f"torque_per_emg_{group}"] = 1e-3 * weights[i] * _unit(subject, i)
    return made


def _unit(subject: Subject, i: int) -> float:
    """Return the torque for each newton of active state at the length at rest, at 0° [m]."""
    muscle, neutral = subject.muscles()[i], np.zeros(1)
    length = static_force(muscle, subject.geometry.path(neutral)[i, 0], 0.0)[1]
    fibre = math.hypot(length, muscle.width)
    width = muscle.short_width if fibre < muscle.l0 else muscle.long_width
    lift = math.exp(-((fibre / muscle.l0 - 1) ** 2) / width) * length / fibre
    return float(subject.geometry.arm(neutral)[i, 0] * lift)


def _root(of: Callable[[float], float], low: float, high: float) -> float | None:
    """Return where a function is 0; None where it does not change its sign."""
    return float(brentq(of, low, high)) if of(low) * of(high) < 0 else None


def _quick(subject: Subject, degrees: float, rest: Callable[[Array], Array]) -> float:
    """Return the joint's stiffness to a stretch in which nothing relaxes [Nm/deg]."""
    angles = np.radians(np.array([degrees - 0.05, degrees, degrees + 0.05]))
    paths, arms = subject.geometry.path(angles), subject.geometry.arm(angles)
    total = float(rest(angles)[2] - rest(angles)[0]) / 0.1
    for i, muscle in enumerate(subject.muscles()):
        force, length = static_force(muscle, paths[i, 1], 0.0)
        fibre = math.hypot(length, muscle.width)
        cosine = length / fibre
        stiffness = muscle.k * (1 + muscle.k_rel) * force / cosine  # of the fibre
        stiff = stiffness * cosine**2 + force / cosine * muscle.width**2 / fibre**3
        if muscle.dlt:
            tendon = tendon_force(paths[i, 1] - length, muscle.constants())[1]
            stiff = stiff * tendon / (stiff + tendon)
        pull = arms[i, 1] * stiff * (paths[i, 2] - paths[i, 0]) + force * (arms[i, 2] - arms[i, 0])
        total += (1, -1)[i] * float(pull) / 0.1
    return total


def _angles(subject: Subject, i: int) -> tuple[float | None, float | None]:
    """Return where a relaxed group is slack, and where it has its optimal length [deg]."""
    muscle = subject.muscles()[i]

    def line(length: float) -> float:
        return math.sqrt(max(length**2 - muscle.width**2, 0.0))

    def path(degrees: float) -> float:
        return float(subject.geometry.path(np.radians([degrees]))[i, 0])

    best = line(muscle.l0)
    force = math.exp(muscle.k * (muscle.l0 - muscle.x0)) / (1 + muscle.k_rel) * best / muscle.l0
    if muscle.dlt:
        c = muscle.constants()
        best += float(brentq(lambda e: tendon_force(e, c)[0] - force, 0.0, 0.2))
    return tuple(_root(lambda d, x=x: path(d) - x, -180, 180) for x in (line(muscle.x0), best))  # type: ignore[misc, return-value]


def _energy(subject: Subject, resist: Resist) -> float:
    """Return what a slow stretch from −20° to 10° and back takes, at 10°/s [mJ]."""
    there = np.linspace(-20, 10, 3 * FINE + 1)
    angle = np.radians(np.concatenate([there, there[-2::-1]]))
    zero, one = np.zeros(angle.size), np.ones(angle.size)
    paths, arms = subject.geometry.path(angle), subject.geometry.arm(angle)
    torque = resist(angle, 1 / FINE)
    for i, muscle in enumerate(subject.muscles()):
        force = integrate(1 / FINE, paths[i], zero, one, zero, muscle.constants())[1]
        torque = torque + (1, -1)[i] * arms[i] * force
    return 1e3 * float(np.sum(0.5 * (torque[1:] + torque[:-1]) * np.diff(angle)))


def _bandwidth(f0: float, beta: float) -> float:
    b = 1 - 2 * beta**2
    return f0 * math.sqrt(b + math.sqrt(b * b + 1))


def _half_time(f0: float, beta: float) -> float:
    """Return when a step's response comes to half of its end [ms]."""
    muscle = Muscle(1, 1, 1, 0, 1, f0, beta)
    step = 1e-5
    response = active_state(muscle, np.ones(round(3 / (f0 * step))), step)
    return 1e3 * step * float(np.argmax(response > 0.5))
